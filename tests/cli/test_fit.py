# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove fit``: a measured BRDF as a preset."""

import re

import numpy as np
import pytest

from vgroove.addon.library.presets import load
from vgroove.addon.measured import tabulate, write_merl
from vgroove.addon.reference import CookTorrance, Lambert, Schlick, Sum
from vgroove.lab import plots

from ..commands import patient
from ..measured.makers import utia_bytes


@pytest.fixture
def file(line):
    of = Sum(Lambert([0.6, 0.4, 0.2]), CookTorrance(0.2, Schlick([0.6, 0.4, 0.2])), 0.5, 0.4)
    write_merl(line.folder / "Rot 1.binary", tabulate(of.evaluate))
    return line


def test_it_writes_a_preset_that_says_where_it_comes_from(file):
    """Its numbers are those that the file was made of, its text names file, metric and residual."""
    done = patient("fit", "Rot 1.binary", "--lobes", 1, "--metric", "log", "-o", "red.toml")
    assert done.code == 0, done.err
    assert "75 degrees" in done.out
    assert "metric log: " in done.err
    assert done.lines[-1] == "wrote red.toml"
    preset = load(file.folder / "red.toml")
    assert preset.name == "Rot 1 (fit)"
    assert preset.m == pytest.approx(0.2, rel=0.01)
    assert preset.source["data"].startswith("Rot 1.binary, MERL .binary, sha256 ")
    for word in ("metric log", "up to 80 degrees", "% of the reflected light differ"):
        assert word in preset.source["trust"]


def test_the_table_itself_is_a_preset(file):
    """It names the file beside it, and finds it there."""
    done = patient("fit", "Rot 1.binary", "--model", "measured", "-o", "red.toml")
    assert done.code == 0, done.err
    assert 'file = "Rot 1.binary"' in (file.folder / "red.toml").read_text(encoding="utf-8")
    of = load(file.folder / "red.toml")
    assert of.table.file == str(file.folder / "Rot 1.binary")
    assert of.reference().albedo.shape == (3,)


@pytest.mark.parametrize(("ending", "begins"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_the_residual_is_plotted(file, monkeypatch, ending, begins):
    """One line for each number of lobes, in a figure of the same numbers as the table."""
    shown = []
    draw = plots.residuals
    monkeypatch.setattr(plots, "residuals", lambda *of: shown.append(of) or draw(*of))
    arguments = ("--model", "ward", "-o", "red.toml", "--plot", f"red.{ending}")
    done = patient("fit", "Rot 1.binary", *arguments)
    assert done.code == 0, done.err
    assert (file.folder / f"red.{ending}").read_bytes().startswith(begins)
    ((angles, shares, title),) = shown
    assert title == "Rot 1: ward, metric l1"
    assert list(shares) == ["1 lobe"]
    for angle, share in zip(angles, shares["1 lobe"], strict=True):
        assert re.search(rf"{angle} degrees\W+{100.0 * share:.2f}", done.out)
    lines = draw((0, 45), {"1 lobe": (0.1, 0.2), "2 lobes": (0.05, 0.06)}, "x").axes[0].lines
    np.testing.assert_allclose([line.get_ydata() for line in lines], [[10.0, 20.0], [5.0, 6.0]])


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["Rot 1.binary", "-o", "red.txt"], "TOML"),
        (["Rot 1.binary", "-o", "none/red.toml"], "does not exist"),
        (["Rot 1.binary", "-o", "red.toml", "--lobes", 5], "from 1 to 4"),
        (["Rot 1.binary", "-o", "red.toml", "--lobes", 4, "--model", "generator"], "at most 3"),
        (["Rot 1.binary", "-o", "red.toml", "--lobes", 2, "--model", "ward"], "at most 1"),
        (["Rot 1.binary", "-o", "red.toml", "--plot", "red.pdf"], "use .png or .svg"),
        (["Rot 1.binary", "-o", "red.toml", "--plot", "red.png", "--model", "measured"], "leaves nothing"),
        (["none.binary", "-o", "red.toml"], "none.binary"),
        (["a.bin", "-o", "red.toml"], "a.bin: is anisotropic"),
        (["a.bin", "-o", "red.toml", "--model", "measured"], "a.bin: is anisotropic"),
    ],
)
def test_wrong_input_ends_with_one_line(file, arguments, says):
    if arguments[0] == "a.bin":
        (file.folder / "a.bin").write_bytes(utia_bytes(Lambert(0.5).evaluate))
    assert says in file.refuses("fit", *arguments)
