# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove plot``: BRDFs as figures and as CSV."""

import subprocess
import sys

import numpy as np
import pytest

from vgroove.addon.library import presets
from vgroove.addon.measured import curves
from vgroove.addon.reference import Lambert, lobe, spherical
from vgroove.cli import environment, plot
from vgroove.lab import plots

from ..commands import vgroove
from ..measured.makers import utia_bytes


def test_the_csv_holds_the_preset_s_values(line):
    done = vgroove("plot", "copper", "copper:m=0.1", "-o", "a.csv", "--theta-i", "30", "--times", "cos_io")
    assert (done.code, done.out, done.err) == (0, "", "wrote a.csv\n")
    values = np.loadtxt(line.folder / "a.csv", delimiter=",", skiprows=2)
    head = (line.folder / "a.csv").read_text().splitlines()[1]
    assert head.startswith("theta_o (deg),lecture/copper f cos(theta_i) cos(theta_o) R (1/sr)")
    assert '"lecture/copper, m = 0.1 f' in head
    wi, theta = spherical(np.radians(30.0)), values[:, 0]
    wo = spherical(np.radians(np.abs(theta)), np.where(theta < 0, 0.0, np.pi))
    for at, changes in ((1, {}), (5, {"m": 0.1})):
        f = presets.find("copper").with_parameters(**changes).reference().evaluate(wi, wo)
        np.testing.assert_allclose(values[:, at : at + 3], f * wo[:, 2:] * wi[2], rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("ending", [".png", ".svg"])
def test_a_measured_file_is_drawn_beside_a_preset(line, ending):
    (line.folder / "c.bin").write_bytes(utia_bytes(Lambert(0.5).evaluate))
    done = vgroove("plot", "c.bin", "copper", "-o", f"a{ending}", "--plot", "albedo")
    assert done.code == 0, done.err
    assert (line.folder / f"a{ending}").stat().st_size > 5000


@pytest.mark.parametrize("name", ["a\udcff$_{.bin", "_ä\n.bin", "a:m=1.bin", ',".bin'], ids=ascii)
def test_files_of_any_name_are_plotted(line, name):
    (line.folder / name).write_bytes(utia_bytes(Lambert(0.5).evaluate))
    for output in ("a.csv", "a.svg", "a.png"):
        done = vgroove("plot", name, "-o", output)
        assert done.code == 0, done.err


def test_figures_alone_need_matplotlib(line, monkeypatch):
    monkeypatch.setattr(environment.importlib.util, "find_spec", lambda _name: None)
    assert "a .svg file needs matplotlib; install" in line.refuses("plot", "copper", "-o", "a.svg")
    assert vgroove("plot", "copper", "-o", "a.csv").code == 0


def test_it_needs_no_blender(line):
    code = "import sys; sys.modules['bpy'] = None; from vgroove import cli; cli.main()"
    command = [sys.executable, "-P", "-c", code, "plot", "copper", "-o", "a.svg"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=line.folder)
    assert (done.returncode, done.stderr) == (0, "wrote a.svg\n")


def test_time_and_set_are_those_of_every_preset(line):
    found = plot.named(["rusting_iron", "rusting_iron:m=0.5"], ["m=0.4"], 1.0)
    assert [one.parameters["m"] for one in found.values()] == [0.4, 0.5]


def test_options_are_what_plots_offer():
    assert list(plot.Plot) == list(curves.PLOTS)
    assert list(plot.Times) == list(lobe.TIMES)
    assert list(plot.Channel) == list(plots.CHANNELS)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["coper"], 'unknown preset "coper"; did you mean "copper"?'),
        (["copper", "copper"], "copper: is there twice"),
        (["copper:q=1"], 'unknown key "q"'),
        (["copper:m"], '--set "m": write NAME=NUMBER'),
        (["none.binary"], "none.binary: No such file"),
        (["."], 'unknown preset "."'),
        (["copper", "--theta-i", "90"], "--theta-i"),
        (["copper", "--times", "2"], "--times"),
        (["copper", "--plot", "pie"], "--plot"),
        (["copper", "--time", "1"], "does not change over time"),
        (["window"], "window: is a smooth mirror"),
        ([f"copper:m=0.{k}" for k in range(1, 10)], "shows 1 to 8 BRDFs, got 9"),
        ([], "Missing argument"),
    ],
    ids=lambda value: "_".join(value)[:40] if isinstance(value, list) else "",
)
def test_bad_input_is_one_line_and_nothing_written(line, arguments, message):
    assert message in line.refuses("plot", *arguments, "-o", "a.svg")


@pytest.mark.parametrize(
    ("output", "message"), [("a.pdf", "use .png, .svg or .csv"), ("no/a.svg", "no/a.svg: the folder")]
)
def test_an_output_that_cannot_be_is_refused(line, output, message):
    assert message in line.refuses("plot", "copper", "-o", output)
