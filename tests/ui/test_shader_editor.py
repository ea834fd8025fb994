# SPDX-License-Identifier: GPL-3.0-or-later
"""Single nodes of the models, for artists who build their materials themselves."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, shader_nodes
from vgroove.addon.library import presets
from vgroove.addon.ui import shader_editor
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender


@pytest.mark.parametrize("name", shader_nodes.NODES)
def test_a_node_has_one_output_and_mixes_in_cycles(extension, name):
    """Neither black nor white where it is half of a mix; Blender's names for colour and roughness."""
    made = versions.empty_material("Own")
    tree = made.node_tree
    node = shader_nodes.add(tree, name)
    assert [one.name for one in node.outputs] == ["BSDF"]
    assert not node.show_options  # which would show the group's internal name
    assert {"Normal"} <= {one.name for one in node.inputs}
    assert {"Base Color", "IOR"} & {one.name for one in node.inputs}
    mix, black = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeEmission")
    black.inputs["Color"].default_value = (0, 0, 0, 1)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    for source, socket in zip((node.outputs[0], black.outputs[0]), mix.inputs[1:], strict=True):
        tree.links.new(source, socket)
    shown = []
    for share in (0.0, 0.5):
        mix.inputs[0].default_value = share
        tree.links.new(mix.outputs[0], output.inputs["Surface"])
        with headless.quiet():
            image = gonio.measure(made, gonio.Geometry(furnace=True, resolution=(8, 8)), samples=16, shading_osl=False)
        shown.append(image.mean())
    assert 0.01 < shown[0] < 1.05
    if name not in {"glass", "pane", "translucent"}:  # of which the light goes on after a surface
        np.testing.assert_allclose(shown[1], shown[0] / 2, rtol=0.02)


def test_internal_groups_stay_out_of_lists(extension):
    """Blender leaves out of Add > Group, and of its lists, what begins with a dot; the models' own groups it shows."""
    tree = versions.empty_material("Own").node_tree
    top = {shader_nodes.add(tree, name).node_tree for name in shader_nodes.NODES}
    parts = {node.node_tree for group in top for node in group.nodes if node.bl_idname == "ShaderNodeGroup"}
    inner = set(extension.data.node_groups) - top - {one for one in parts if one.name.startswith("VGroove Cook")}
    hidden = {group.name for group in inner if group.name.startswith(".")}
    shown = {group.name for group in inner} - hidden
    assert all(name.startswith("VGroove Oren-Nayar Fit") for name in shown), shown
    assert hidden
    assert not any(group.name.startswith(".") for group in top)


def test_the_menu_is_there_while_the_extension_is_on(extension):
    """Below Add > Shader, each entry with what it is for."""
    menu = extension.types.NODE_MT_category_shader_shader
    assert shader_editor._draw in menu._dyn_ui_initialize()
    for entry in shader_nodes.NODES.values():
        assert presets.find(entry.preset)
        assert not entry.tip.endswith(".")
