# SPDX-License-Identifier: GPL-3.0-or-later
"""Files from the other side of Blender 5.3 are reported and updated; a Blender newer than any tested is reported."""

from pathlib import Path

import numpy as np
import pytest

import vgroove
from vgroove import headless
from vgroove.addon.blender import gonio, material, rebuild
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.choose import advice
from vgroove.addon.reference import cycles
from vgroove.addon.ui import opened
from vgroove.nodegroups import osl_script, versions
from vgroove.nodegroups.osl_script import OslError

pytestmark = pytest.mark.blender

DATA = Path(__file__).parents[1] / "data"
CHANGED = {"chalk", "chalk osl", "frosted osl"}
FACING, ABOVE, INSIDE = gonio.Geometry(20.0), gonio.Geometry(60.0), gonio.Geometry(150.0, inside=True)


def open_file(blender, version):
    with headless.quiet():
        blender.ops.wm.open_mainfile(filepath=str(DATA / f"{version}.blend"))
    return {made.name: made for made in blender.data.materials}


def picture(made, geometry):
    with headless.quiet():
        osl = material.origin_of(made).backend == "osl"
        return gonio.measure(made, geometry, samples=1, shading_osl=osl).astype(np.float64)


def other():
    return next(one for one in cycles.VERSIONS if one != cycles.version())


def test_a_file_of_the_running_cycles_says_nothing(blender, capfd):
    """Nor does one that holds no materials of ours."""
    vgroove.register()
    try:
        open_file(blender, cycles.version())
        assert list(advice.cycles_problems(blender.context.scene)) == []
        assert "V-Groove" not in capfd.readouterr().out
    finally:
        vgroove.unregister()
    blender.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert list(advice.cycles_problems(blender.context.scene)) == []


def test_a_file_of_the_other_cycles_is_told_when_it_is_opened_and_fixed_by_one_button(blender, capfd):
    """The message names the materials that render differently; updated, they match new ones. Others do not change."""
    vgroove.register()
    try:
        made = open_file(blender, other())
        (line,) = (line for line in capfd.readouterr().out.splitlines() if line.startswith("V-Groove: "))
        (problem,) = advice.cycles_problems(blender.context.scene)
        assert line == f"V-Groove: {problem.text}"
        assert set(problem.text.rpartition(": ")[2].split(", ")) == CHANGED
        assert ("5.2 or earlier" in problem.text) == versions.since(5, 3)
        group = {name: one.node_tree.nodes[0].node_tree for name, one in made.items()}
        views = {"chalk": FACING, "chalk osl": ABOVE, "frosted osl": INSIDE, "copper": FACING}
        before = {name: picture(made[name], view) for name, view in views.items()}
        with headless.quiet():
            assert blender.ops.vgroove.mend(key="cycles") == {"FINISHED"}
        assert list(advice.cycles_problems(blender.context.scene)) == []
        assert made["copper"].node_tree.nodes[0].node_tree == group["copper"]
        for name, view in views.items():
            origin = material.origin_of(made[name])
            new = build(origin.preset, Choice(origin.backend, origin.estimator))
            now = picture(made[name], view)
            np.testing.assert_array_equal(now, picture(new, view))
            # A thousandth of the peak is 20 times what float32 loses; chalk is off by more, glass by a multiple.
            assert (np.abs(now - before[name]).max() > 1e-3 * now.max()) == (name in CHANGED), name
    finally:
        vgroove.unregister()


def test_what_cannot_be_updated_is_said_and_keeps_nothing_else_from_it(blender, monkeypatch):
    """As where Blender was built without OSL."""
    made = open_file(blender, other())
    compiled = osl_script.script

    def refuse(*arguments, **more):
        message = "This Blender was built without OSL; choose the backend Nodes"
        raise OslError(message)

    monkeypatch.setattr(osl_script, "script", refuse)
    (problem,) = advice.cycles_problems(blender.context.scene)
    with pytest.raises(OslError, match="without OSL"):
        problem.fix()
    assert {name for name in made if rebuild.is_of_other_cycles(made[name])} == {"chalk osl", "frosted osl"}
    monkeypatch.setattr(osl_script, "script", compiled)
    (problem,) = advice.cycles_problems(blender.context.scene)
    problem.fix()
    assert not any(map(rebuild.is_of_other_cycles, made.values()))


class Column:
    """A layout that keeps what is drawn."""

    def __init__(self):
        self.said, self.keys = [], []

    def column(self, **_):
        return self

    def label(self, *, text, **_):
        self.said.append(text)

    def operator(self, name, **_):
        assert name == "vgroove.mend"
        return self

    key = property(fset=lambda self, key: self.keys.append(key))


def test_the_popup_says_it_and_has_the_button(blender):
    open_file(blender, other())
    popup = type("Popup", (), {"layout": Column()})()
    opened.draw(popup, blender.context)
    (problem,) = advice.cycles_problems(blender.context.scene)
    assert " ".join(popup.layout.said) == problem.text
    assert popup.layout.keys == ["cycles"]


def test_linked_materials_are_named_and_left_alone(blender):
    """They change where they are kept."""
    with blender.data.libraries.load(str(DATA / f"{other()}.blend"), link=True) as (_, wanted):
        wanted.materials = ["chalk"]
    (problem,) = advice.cycles_problems(blender.context.scene)
    assert problem.text.endswith("chalk")
    assert (problem.button, problem.fix) == ("", None)


def test_a_newer_blender_than_any_that_was_tested_is_said_once(blender, monkeypatch):
    """By the command line on standard error, and in one line; nothing refuses to work."""
    from typer.testing import CliRunner

    from vgroove import cli

    assert versions.untested() == ""
    assert versions.version() in versions.TESTED
    monkeypatch.setattr(versions, "TESTED", ((4, 2), (4, 4)))
    done = CliRunner().invoke(cli.app, ["explain", "copper"])
    assert done.exit_code == 0
    said = [line for line in done.stderr.splitlines() if "tested" in line]
    assert said == [f"vgroove: {versions.untested()}"]
    assert versions.untested().count("\n") == 0
