# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure in Cycles: another process, its points, its end. tests/window has the button."""

import sys
import time

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import measuring

from .panel import drawn

pytestmark = pytest.mark.blender
# In place of Blender: tells how far it is and writes points of 2.
WRITE = """
import pathlib, sys, numpy as np
folder = pathlib.Path(sys.argv[1])
(folder / "progress").write_text("0.5")
one = {"at": np.arange(3.0), "rgb": np.full((3, 3), 2.0), "cosines": np.full((3, 2), 0.5)}
plots = "PLANE", "ACROSS", "ALBEDO", "THETA_H"
np.savez(folder / "points.npz", **{f"{plot}.{name}": of for plot in plots for name, of in one.items()})
"""
WI = np.array([0.0, 0.6, 0.8])


@pytest.fixture
def job(extension, monkeypatch):
    """A function that starts a measurement of the cube's Principled by a script."""
    from vgroove.addon.ui import viewer_measure

    def start(script):
        monkeypatch.setattr(viewer_measure, "command", lambda folder: [sys.executable, "-c", script, str(folder)])
        with headless.quiet():
            return viewer_measure.Job(extension.context.object.active_material, WI, shading_osl=False)

    yield start
    viewer_measure.unregister()


def test_points_appear_under_the_light_that_was_measured(extension, job):
    """And under no other; cosines as in the plots; the folder goes."""
    from vgroove.addon.ui import viewer_draw, viewer_measure, viewer_panel

    one = job(WRITE)
    assert (one.folder / measuring.BLEND).stat().st_size > 1000
    assert one.blender.process.wait(60) == 0
    assert one.progress == 0.5
    assert one.finish() == ""
    assert not one.folder.exists()
    of = extension.context.object.active_material
    assert viewer_measure.points_of(of, WI, measuring.PLANE).rgb.tolist() == [[2.0] * 3] * 3
    assert viewer_measure.points_of(of, np.array([0.6, 0.0, 0.8]), measuring.PLANE) is None
    extension.context.scene.vgroove_viewer.times = "cos_io"
    (curve,) = viewer_draw.plot_curves(extension.context, measuring.PLANE, WI)
    assert curve.measured
    assert curve.rgb.tolist() == [[0.5] * 3] * 3
    assert f"{of.name}: points at 36.9°" in drawn(extension, viewer_panel.VGROOVE_PT_viewer).texts
    viewer_measure.unregister()
    assert viewer_measure.points_of(of, WI, measuring.PLANE) is None


def test_a_failure_says_why_and_leaves_nothing(job):
    one = job("import sys; sys.exit('no memory left')")
    one.blender.process.wait(60)
    assert one.finish().endswith("Blender in the background ended with 1: no memory left")
    assert not one.folder.exists()
    one = job("pass")  # it ends well, and has written nothing
    one.blender.process.wait(60)
    assert "was not measured" in one.finish()


def test_it_can_be_stopped(job):
    one = job("import time; time.sleep(600)")
    start = time.monotonic()
    one.stop()
    assert time.monotonic() - start < 30.0
    assert one.blender.process.returncode
    assert not one.folder.exists()


def test_the_panel_says_why_it_cannot_measure(extension):
    """Here Blender is a module of Python."""
    from vgroove.addon.ui import viewer_panel

    assert "module of Python" in " ".join(drawn(extension, viewer_panel.VGROOVE_PT_viewer).texts)
    assert not extension.ops.vgroove.measure.poll()
