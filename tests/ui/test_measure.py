# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure This Material: by another Blender, which is watched, stopped and resumed."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import OpenImageIO
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio_merl, merl_file
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.addon.measured import read
from vgroove.nodegroups import versions

from .panel import drawn

pytestmark = pytest.mark.blender
# In place of Blender: the bands done, then what is to be measured or an error.
WAIT = """
import json, pathlib, sys, time
job = json.loads(sys.argv[1])
pathlib.Path(job["steps"]).write_text("3")
time.sleep({seconds})
{then}
"""


@pytest.fixture
def plain(extension):
    """The cube's material: Principled without a reflection."""
    made = versions.empty_material("Plain")
    tree = made.node_tree
    node, out = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    node.inputs["Specular IOR Level"].default_value = 0.0
    tree.links.new(node.outputs[0], out.inputs["Surface"])
    extension.context.object.active_material = made
    return made


@pytest.fixture
def bands(monkeypatch):
    """Bands at once, of .25, and where each measurement began; it stops after ``stop`` bands."""
    of = SimpleNamespace(began=[], stop=gonio_merl.BANDS)

    def made(_make, *, first=0, **_options):
        of.began.append(first)
        for index in range(first, gonio_merl.BANDS):
            if index == of.stop:
                message = "stopped"
                raise OSError(message)
            yield np.full((3, gonio_merl.BAND, 90, 180), 0.25)

    monkeypatch.setattr(gonio_merl, "bands", made)
    return of


def call(extension, path):
    with headless.quiet():
        return extension.ops.vgroove.measure_material(filepath=str(path))


def test_a_material_becomes_a_table(extension, plain, bands, tmp_path):
    """In this session where Blender is a module of Python; what stopped is resumed if the material is the same."""
    path = tmp_path / "plain.binary"
    bands.stop = 4
    with pytest.raises(RuntimeError, match="stopped"):
        call(extension, path)
    bands.stop = gonio_merl.BANDS
    assert call(extension, path) == {"FINISHED"}
    assert bands.began == [0, 4]
    assert read(path).table == pytest.approx(0.25)
    bands.stop = 4
    with pytest.raises(RuntimeError, match="stopped"):
        call(extension, path)
    plain.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.3
    bands.stop = gonio_merl.BANDS
    assert call(extension, path) == {"FINISHED"}
    assert bands.began[2:] == [0, 0]
    assert [one.name for one in tmp_path.iterdir()] == ["plain.binary"]


def test_a_digest_tells_materials_apart(extension, plain):
    """By a value, a link, a ramp's colour and what a group holds; where a node stands does not count."""
    tree, found = plain.node_tree, [merl_file.digest(plain)]
    tree.nodes["Principled BSDF"].location = (300.0, 40.0)
    assert merl_file.digest(plain) == found[0]

    def changed():
        found.append(merl_file.digest(plain))
        assert len(set(found)) == len(found)

    ramp = tree.nodes.new("ShaderNodeValToRGB")
    changed()
    tree.links.new(ramp.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    changed()
    ramp.color_ramp.elements[0].color = (1.0, 0.0, 0.0, 1.0)
    changed()
    inner = extension.data.node_groups.new("Inner", "ShaderNodeTree")
    tree.nodes.new("ShaderNodeGroup").node_tree = inner
    changed()
    inner.nodes.new("ShaderNodeValue").outputs[0].default_value = 2.0
    changed()


def test_what_cannot_be_measured_is_refused_in_one_line(extension, plain, tmp_path, monkeypatch):
    """Glass of ours, another ending, a folder that is not there, no material, and a Blender without OSL."""
    from vgroove.addon.ui import measure

    with pytest.raises(RuntimeError, match=r"end(s)? in \.binary"):
        call(extension, tmp_path / "x.exr")
    with pytest.raises(RuntimeError, match="does not exist"):
        call(extension, tmp_path / "none" / "x.binary")
    glass = next(one for one in presets.all_presets().values() if one.transparent)
    extension.context.object.active_material = build(glass, Choice("nodes", "closure"))
    with pytest.raises(RuntimeError, match="lets light through"):
        call(extension, tmp_path / "x.binary")
    extension.context.object.active_material = None
    with pytest.raises(RuntimeError, match="Select an object with a material"):
        call(extension, tmp_path / "x.binary")
    without = SimpleNamespace(app=SimpleNamespace(build_options=SimpleNamespace(cycles_osl=False)))
    monkeypatch.setattr(measure, "bpy", without)
    said = []
    monkeypatch.setattr(measure.VGROOVE_OT_measure_material, "poll_message_set", said.append, raising=False)
    assert not measure.VGROOVE_OT_measure_material.poll(extension.context)
    assert said == ["This Blender was built without OSL, which the measuring camera needs"]
    assert list(tmp_path.iterdir()) == []


# --- in the background --------------------------------------------------------------------------------------------


@pytest.fixture
def behind(extension, plain, monkeypatch):
    """A function that starts a measurement whose process waits, then runs the code that it is given."""
    from vgroove.addon.ui import measure

    def begin(path, seconds=60, then=""):
        line = [sys.executable, "-c", WAIT.format(seconds=seconds, then=then)]
        monkeypatch.setattr(measure, "command", lambda of: [*line, of])
        assert call(extension, path) == {"FINISHED"}
        return measure

    return begin


def until(condition):
    end = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_progress_shows_and_esc_stops(extension, behind, tmp_path):
    """The panel has the bands; events pass through while it runs; Esc ends the process and says how to resume."""
    measure = behind(tmp_path / "plain.binary")
    (of,) = measure._measuring
    until(lambda: of.done == 3)
    assert "Plain: 3 of 9" in drawn(extension, measure.VGROOVE_PT_measure).texts
    assert measure._look() == measure.background.PAUSE
    with pytest.raises(RuntimeError, match="is being measured"):
        call(extension, tmp_path / "other.binary")
    said = []
    manager = SimpleNamespace(event_timer_remove=lambda _: None)
    watch = SimpleNamespace(_timer=None, report=lambda _, text: said.append(text))
    context = SimpleNamespace(window_manager=manager)

    def modal(kind):
        return measure.VGROOVE_OT_watch_measuring.modal(watch, context, SimpleNamespace(type=kind, value="PRESS"))

    assert modal("MOUSEMOVE") == {"PASS_THROUGH"}
    assert modal("ESC") == {"FINISHED"}
    assert said == ["Stopped at 3 of 9; measure into plain.binary again to resume"]
    assert not of.job.is_running
    assert not of.folder.exists()
    assert measure._look() is None


@pytest.mark.parametrize(
    ("then", "says"), [("", "Wrote"), ("raise OSError('disk full')", "Plain is not measured: disk full")]
)
def test_how_it_ends_is_said(extension, behind, tmp_path, then, says):
    """In one line of the panel."""
    measure = behind(tmp_path / "plain.binary", 0, then)
    until(lambda: measure._look() is None)
    assert says in " ".join(drawn(extension, measure.VGROOVE_PT_measure).texts)


@pytest.mark.once
def test_the_other_blender_measures(extension, plain, tmp_path):
    """By its script alone: 0.8 / pi of Principled's base color. Only the last band, as the others are held already."""
    from vgroove.addon.ui import background, measure

    path = tmp_path / "plain.binary"
    of = measure.Measurement.__new__(measure.Measurement)
    line = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measure, "command", lambda job: line.append(job) or [sys.executable, "-c", ""])
        of.__init__(plain, path, 1, runs_osl=False)
    of.job.process.wait()
    assert of.job.failure() == ""
    held = np.full((gonio_merl.BANDS - 1, 3, gonio_merl.BAND, 90, 180), 0.25)
    np.savez((tmp_path / "plain.npz"), key=json.loads(line[0])["key"], table=held)
    (tmp_path / "plain.npz").rename(tmp_path / "plain.binary.part")
    script = "import sys; sys.modules['vgroove'] = None\n" + background.script(measure.MODULE)
    path_of_blender = os.environ | {"PYTHONPATH": str(Path(OpenImageIO.__file__).parents[1])}
    command = [sys.executable, "-c", script, "--", line[0]]
    done = subprocess.run(command, env=path_of_blender, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert of.done == of.bands
    of.close()
    table = read(path).table
    assert table[:, :80] == pytest.approx(0.25)
    lit = table[:, 80:][table[:, 80:] > 0]
    assert np.median(lit) == pytest.approx(0.8 / np.pi, rel=1e-3)
