# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of an artist's, textured by noises."""

from vgroove.nodegroups import versions


def textured(kind, **names):
    """A material of one of Blender's shaders, its inputs fed by noises of the labels given."""
    made = versions.empty_material("Bricks")
    tree = made.node_tree
    shader, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    for label, name in names.items():
        feed(tree, shader.inputs[name], label)
    return made


def feed(tree, socket, label):
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.label = label
    tree.links.new(noise.outputs["Color"], socket)
