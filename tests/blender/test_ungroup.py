# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures behind an artist's own node groups are found, and the groups stay as they are."""

import pytest

from vgroove.addon.blender import material, roles, textures
from vgroove.addon.blender.material import Choice
from vgroove.addon.library import presets

from .noises import feed, textured

pytestmark = pytest.mark.blender

CHOICE = Choice("nodes", "closure")


def put_into_group(blender, made, name, *passed):
    """Move the nodes before the output of ``made`` into a group; ``passed``: labels of nodes that stay outside."""
    tree, group = made.node_tree, blender.data.node_groups.new(name, "ShaderNodeTree")
    before = tree.get_output_node("CYCLES").inputs["Surface"].links[0].from_node
    inner, enter, leave = (group.nodes.new(kind) for kind in (before.bl_idname, "NodeGroupInput", "NodeGroupOutput"))
    if before.bl_idname == "ShaderNodeGroup":
        inner.node_tree = before.node_tree
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    node, sources = tree.nodes.new("ShaderNodeGroup"), {}
    for theirs, mine in zip(before.inputs, inner.inputs, strict=True):
        if hasattr(theirs, "default_value"):
            mine.default_value = theirs.default_value
        if not theirs.is_linked:
            continue
        source = theirs.links[0].from_socket
        if source.node.label in passed:
            item = group.interface.new_socket(source.node.label, in_out="INPUT", socket_type="NodeSocketColor")
            group.links.new(next(one for one in enter.outputs if one.identifier == item.identifier), mine)
            sources[item.identifier] = source
        else:
            feed(group, mine, source.node.label)
            tree.nodes.remove(source.node)
    group.links.new(inner.outputs[0], leave.inputs["Shader"])
    node.node_tree = group
    for identifier, source in sources.items():
        tree.links.new(source, next(one for one in node.inputs if one.identifier == identifier))
    tree.links.new(node.outputs["Shader"], tree.get_output_node("CYCLES").inputs["Surface"])
    tree.nodes.remove(before)
    return node


def labels_behind(socket):
    """The labels of the textures that feed an input, also those within groups."""
    source = socket.links[0].from_socket
    if source.node.bl_idname != "ShaderNodeGroup":
        return source.node.label
    leave = next(one for one in source.node.node_tree.nodes if one.bl_idname == "NodeGroupOutput")
    inner = next(one for one in leave.inputs if one.identifier == source.identifier)
    return labels_behind(inner)


@pytest.mark.parametrize("passed", [(), ("colour",), ("colour", "rough", "bumps")], ids=["inside", "one", "outside"])
@pytest.mark.parametrize("depth", [1, 2])
def test_groups_are_entered(blender, passed, depth):
    """Whether the textures are inside or passed in, and in a group within a group; the artist's own stay as before."""
    source = textured(
        "ShaderNodeBsdfPrincipled", colour="Base Color", rough="Roughness", bumps="Normal", coat="Coat Weight"
    )
    for level in range(depth):
        put_into_group(blender, source, f"Own {level}", *passed)
    groups = {one.name: (len(one.nodes), len(one.interface.items_tree)) for one in blender.data.node_groups}
    assert textures.may_have(source)
    made, lost = textures.build(presets.find("ceramics/bone_china"), CHOICE, source)
    assert lost == ["Principled BSDF: Coat Weight"]
    inputs = roles.node(made, roles.MODEL).inputs
    assert {one.name: labels_behind(one) for one in inputs if one.is_linked} == {
        "Base Color": "colour", "Roughness": "rough", "Normal": "bumps",
    }  # fmt: skip
    for name, of in groups.items():
        group = blender.data.node_groups[name]
        assert (len(group.nodes), len(group.interface.items_tree)) == of
    assert "BSDF_PRINCIPLED" in {node.type for one in groups for node in blender.data.node_groups[one].nodes}
    again, lost = textures.build(presets.find("diffuse/clay"), CHOICE, made)  # copied groups are the artist's to it
    assert (lost, labels_behind(roles.node(again, roles.MODEL).inputs["Base Color"])) == ([], "colour")


def test_values_given_to_a_group_count_as_typed_in(blender):
    """An alpha that the group's node has, and a coat inside; both sides of a mix inside it."""
    source = textured("ShaderNodeBsdfPrincipled", colour="Base Color")
    node = put_into_group(blender, source, "Own")
    group = node.node_tree
    shader, enter, leave = (
        next(one for one in group.nodes if one.bl_idname == kind)
        for kind in ("ShaderNodeBsdfPrincipled", "NodeGroupInput", "NodeGroupOutput")
    )
    shader.inputs["Coat Weight"].default_value = 0.5
    group.interface.new_socket("Clear", in_out="INPUT", socket_type="NodeSocketFloat")
    mix, clear = group.nodes.new("ShaderNodeMixShader"), group.nodes.new("ShaderNodeBsdfTransparent")
    for given, taken in ((enter.outputs["Clear"], mix.inputs[0]), (clear.outputs[0], mix.inputs[1]),
                         (shader.outputs[0], mix.inputs[2]), (mix.outputs[0], leave.inputs["Shader"])):  # fmt: skip
        group.links.new(given, taken)
    node.inputs["Clear"].default_value = 0.25
    made, lost = textures.build(presets.find("diffuse/clay"), CHOICE, source)
    assert lost == ["Principled BSDF: Coat Weight"]
    assert textures.read(made).alpha == 0.25


def test_a_group_without_textures_is_replaced(blender):
    """By the material that everybody gets; nothing of the attempt stays behind."""
    source = textured("ShaderNodeBsdfPrincipled")
    put_into_group(blender, source, "Own")
    built = material.build(presets.find("diffuse/clay"), CHOICE)
    before = len(blender.data.node_groups), len(blender.data.materials)
    assert textures.build(presets.find("diffuse/clay"), CHOICE, source) == (built, [])
    assert (len(blender.data.node_groups), len(blender.data.materials)) == before
