# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders are compiled without a trace in the temporary folder, where the Cycles add-on leaves what it made."""

import contextlib
import tempfile

import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.nodegroups import osl_script
from vgroove.nodegroups._tree import Tree

pytestmark = pytest.mark.blender


@pytest.fixture
def scratch(tmp_path, monkeypatch):
    """The temporary folder, empty."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def new_tree(blender):
    return Tree(blender.data.node_groups.new("Test", "ShaderNodeTree"))


@pytest.mark.parametrize("engine", ["CYCLES", "BLENDER_WORKBENCH"])
def test_a_compiled_shader_leaves_no_file(blender, scratch, engine):
    """In a scene of Cycles Blender compiles a script as soon as a node has it; in others we do."""
    blender.context.scene.render.engine = engine
    node = osl_script.script(new_tree(blender), "glass_mirror")
    assert node.bytecode
    assert node.bytecode_hash
    assert len(node.inputs) > 2
    assert list(scratch.iterdir()) == []


@pytest.mark.parametrize("engine", ["CYCLES", "BLENDER_WORKBENCH"])
def test_a_shader_that_does_not_compile_leaves_no_file(blender, scratch, monkeypatch, engine):
    blender.context.scene.render.engine = engine
    monkeypatch.setattr(osl_script, "source", lambda *_: "no shader")
    before = set(blender.data.texts)
    with headless.quiet(), pytest.raises(osl_script.OslError, match="cannot compile"):
        osl_script.script(new_tree(blender), "glass_mirror")
    assert list(scratch.iterdir()) == []
    assert set(blender.data.texts) == before


@pytest.mark.parametrize("engine", ["CYCLES", "BLENDER_WORKBENCH"])
def test_the_instruments_camera_leaves_no_file(blender, scratch, engine):
    stage = blender.context.scene
    stage.render.engine = engine
    gonio._camera(stage, gonio.Geometry(45.0))
    assert stage.camera.data.custom_bytecode
    assert list(scratch.iterdir()) == []


def test_what_others_compile_stays(blender, scratch):
    """The add-on's own function is back in its place."""
    from cycles import osl

    known = osl.osl_compile
    with contextlib.suppress(ZeroDivisionError), osl_script.tidy():
        assert osl.osl_compile is not known
        raise ZeroDivisionError
    assert osl.osl_compile is known
