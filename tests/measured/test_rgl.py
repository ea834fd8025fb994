# SPDX-License-Identifier: GPL-3.0-or-later
"""RGL's .bsdf, against Mitsuba's reader of it."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from vgroove.addon.measured import read
from vgroove.addon.measured.spectrum import rgb_weights

from .makers import AZIMUTHS, directions, rgl_arrays, tensor_file

VALUES = Path(__file__).with_name("mitsuba_values.py")


def by_mitsuba(path, wi, wo):
    """f cos of pairs (n, 3), as Mitsuba gives it."""
    pairs, values = path.with_suffix(".pairs.npy"), path.with_suffix(".values.npy")
    np.save(pairs, np.stack([wi, wo], axis=1))
    subprocess.run([sys.executable, VALUES, path, pairs, values], check=True, capture_output=True, timeout=300)
    return np.load(values)


@pytest.fixture
def made(tmp_path):
    def make(arrays):
        path = tmp_path / "made.bsdf"
        path.write_bytes(tensor_file(arrays))
        return path

    return make


STEADY = [(one, jacobian) for one in AZIMUTHS for jacobian in (0, 1) if (one, jacobian) != ("isotropic", 1)]


@pytest.mark.parametrize(("azimuths", "jacobian"), STEADY)
def test_mitsuba_gives_the_same(made, azimuths, jacobian):
    """At 10,000 pairs, to 1e-4 of the peak: Mitsuba's float32 half vector is uncertain by 6e-8 / theta_h.

    Mitsuba's wi is the viewer's, ours the light's: both are the direction that the file names by theta_i. With an
    isotropic file and a jacobian Mitsuba 3.9.1 gives one of two answers, by chance: ours, and one that is 7 % off.
    """
    path = made(rgl_arrays(3, AZIMUTHS[azimuths], jacobian=jacobian))
    wi, wo = directions(1250 if azimuths != "isotropic" else 5000, 5)
    expected, found = by_mitsuba(path, wi, wo), read(path)
    assert found.contents.isotropic == (azimuths == "isotropic")
    np.testing.assert_allclose(found.evaluate(wi, wo) * wo[:, 2:], expected, rtol=0, atol=1e-4 * expected.max())


def test_a_spectrum_is_seen_under_d65(made):
    """As RGB by the weights of the presets: the spectral file equals one with the RGB that they give."""
    spectral = rgl_arrays(4, spectral=True)
    weights = rgb_weights(spectral["wavelengths"])
    np.testing.assert_allclose(weights.sum(axis=0), 1.0, atol=1e-9)  # a white surface is white; the table has 9 digits
    rgb = {name: array for name, array in spectral.items() if name not in {"wavelengths", "spectra"}}
    rgb["rgb"] = np.einsum("ptwyx,wc->ptcyx", spectral["spectra"], weights).astype(np.float32)
    assert (rgb["rgb"] > 0).all()
    wi, wo = directions(500, 6)
    f = read(made(spectral)).evaluate(wi, wo)
    np.testing.assert_allclose(f, read(made(rgb)).evaluate(wi, wo), rtol=3e-6)  # float32 sums of 9 values


def test_texels_without_a_reflectance_are_counted_and_black(made):
    """Those that the file marks as extrapolated are holes too, but keep their values."""
    arrays = rgl_arrays(5)
    arrays["rgb"][0, 1, 0, 2, 3] = -1.0
    arrays["rgb"][0, 1, 2, 4, 4] = np.nan
    valid = np.ones(5 * 64, np.uint8)
    valid[:64] = 0
    arrays["valid"] = np.packbits(valid)
    found = read(made(arrays))
    assert found.contents.holes == 2 + 64
    assert found.contents.text == "made for a test"
    assert found.values[0, 1, 0, 2, 3] == 0
    assert found.values[0, 1, 2, 4, 4] == 0
    assert (found.values[0, 0] > 0).all()
    f = found.evaluate(*directions(500, 7))
    assert np.isfinite(f).all()
    assert (f >= 0).all()


def test_the_field_jacobian_may_be_missing(made):
    """Files had none at first; ndf and sigma count then."""
    arrays = rgl_arrays(6)
    wi, wo = directions(100, 8)
    expected = read(made(arrays)).evaluate(wi, wo)
    del arrays["jacobian"]
    np.testing.assert_array_equal(read(made(arrays)).evaluate(wi, wo), expected)
