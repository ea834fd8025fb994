# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a measured BRDF, where it is known; and the package alone."""

import doctest
import importlib
import pkgutil
import subprocess
import sys

import numpy as np
import pytest

from vgroove.addon import measured
from vgroove.addon.measured import Merl, summarize, tabulate
from vgroove.addon.measured.summary import ANGLES
from vgroove.addon.measured.table import Contents, Table
from vgroove.addon.reference import CookTorrance, Lambert, OrenNayar, Schlick, albedo, spherical


class Formula(Table):
    """A BRDF that is not from a file."""

    def __init__(self, f, *, isotropic=True):
        self.contents, self.look_up = Contents("formula", "", "", isotropic, 1, 0, 0, ""), f

    def look_up(self, wi, wo):
        raise NotImplementedError


@pytest.mark.parametrize(
    "model", [Lambert([0.8, 0.4, 0.2]), OrenNayar(0.7, 0.5), *(CookTorrance(m, Schlick(0.9)) for m in (0.02, 0.1, 0.4))]
)
def test_the_albedo_is_that_of_the_model(model):
    """To 0.5 %: the horizon cuts the grid of half vectors, of which a ring has 96."""
    expected = albedo(model, spherical(np.radians(ANGLES)))
    np.testing.assert_allclose(summarize(Formula(model.evaluate)).albedo, expected, rtol=5e-3)


def test_reciprocity_range_and_gain_are_seen():
    """f = c cos_i: for pairs by the cosine, cos has mean 2/3 and |difference| 4/15, so 2 (4/15) / (4/3) = 2/5."""
    summary = summarize(Formula(lambda wi, wo: np.repeat(3.0 * wi[:, 2:], 3, axis=1)))
    assert summary.reciprocity == pytest.approx(0.4, abs=0.4 * 3 / np.sqrt(4096))
    assert summary.above_one == pytest.approx(1 - 1 / 9, abs=0.02)  # P(cos > 1/3); 3 sigma of 4096 pairs
    assert summary.gains == (0, 15, 30, 45, 60, 75)  # 3 pi cos is above 1 but at 85 degrees, where it is 0.82
    assert summary.greatest == pytest.approx(3.0)
    model = summarize(Formula(OrenNayar(0.7, 0.5).evaluate))
    assert model.reciprocity < 1e-12
    assert model.gains == ()


def test_anisotropic_albedos_are_means_over_the_azimuth():
    """f = 1/pi where the light comes along x, 0 along y: half of four azimuths, 45 and 135 degrees count half."""
    f = Formula(lambda wi, wo: np.repeat(wi[:, :1] ** 2 / np.pi + 0 * wo[:, :1], 3, axis=1), isotropic=False)
    assert summarize(f).albedo[ANGLES.index(45)][0] == pytest.approx(0.25, rel=5e-3)


def test_a_table_is_described_like_its_source():
    summary = summarize(Merl(tabulate(Lambert([0.8, 0.4, 0.2]).evaluate)))
    np.testing.assert_allclose(summary.albedo, np.tile([0.8, 0.4, 0.2], (len(ANGLES), 1)), rtol=5e-3)
    assert summary.reciprocity < 1e-12
    assert (summary.least, summary.greatest) == pytest.approx((0.2 / np.pi, 0.8 / np.pi))


MODULES = ["", *sorted(module.name for module in pkgutil.iter_modules(measured.__path__))]


@pytest.mark.parametrize("name", MODULES)
def test_examples_hold(name):
    module = importlib.import_module(f"{measured.__name__}.{name}".rstrip("."))
    assert doctest.testmod(module).failed == 0


def test_it_needs_numpy_alone():
    """And of vgroove the models, errors and files."""
    program = (
        "import sys; before = set(sys.modules)\n"
        "from vgroove.addon.measured import read\n"
        "new = sorted(set(sys.modules) - before)\n"
        "print(*sorted({one.split('.')[0] for one in new} - set(sys.stdlib_module_names)))\n"
        "print(*sorted({'.'.join(one.split('.')[:3]) for one in new if one.startswith('vgroove')}))\n"
        "print(*(one for one in new if one.startswith('vgroove.addon.library.')))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60)
    tops, rooms, library = done.stdout.splitlines()
    assert [one for one in tops.split() if not one.lstrip("_").startswith("cython_")] == ["numpy", "vgroove"]
    assert rooms.split() == [
        "vgroove",
        "vgroove.addon",
        *(f"vgroove.addon.{one}" for one in ("library", "measured", "models", "reference")),
    ]
    assert library.split() == ["vgroove.addon.library.errors", "vgroove.addon.library.files"]
