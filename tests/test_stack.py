# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material needs of Cycles' stack is known before it is rendered: never too little."""

import numpy as np
import pytest

from vgroove.addon import gonio, presets
from vgroove.addon.gonio import Geometry
from vgroove.addon.headless import stack_overflows
from vgroove.addon.material import Choice, build, lamps_to_bind
from vgroove.addon.stack import SIZE, stack_need

pytestmark = pytest.mark.blender

ALLOWED = 1.15  # by how much the estimate may be above what is needed
RIGS = {  # lamps that a material binds
    "one sun": ["SUN"],
    "two areas": ["AREA"] * 2,
    "one of each": ["SUN", "POINT", "SPOT", "AREA"],
    "eight mixed": ["SUN", "POINT", "SPOT", "AREA"] * 2,
    "eight spots": ["SPOT"] * 8,
}
MATERIALS = [
    ("metals/copper", "closure", None),
    ("metals/copper", "fit", None),
    ("lecture/copper", "mirror", None),
    ("lecture/copper", "hybrid", None),
    ("diffuse/clay", "fit", None),
    ("car_paints/blue", "fit", None),
    ("lecture/glass", "mirror", None),
    ("lecture/copper", "corrected", "one sun"),
    ("diffuse/clay", "corrected", "two areas"),
    ("lecture/copper", "corrected", "one of each"),
]


def light(blender, rig):
    """Lights of some size, in the open scene."""
    for number, kind in enumerate(RIGS[rig] if rig else ()):
        data = blender.data.lights.new(f"Light {number}", kind)
        if kind in {"POINT", "SPOT"}:
            data.shadow_soft_size = 0.1
        item = blender.data.objects.new(f"Light {number}", data)
        item.location = (number - 3.0, -2.0, 3.0)
        blender.context.scene.collection.objects.link(item)


def made_of(blender, name, estimator, rig):
    light(blender, rig)
    preset = presets.find(name)
    return build(preset, Choice("nodes", estimator, lamps_to_bind(blender.context.scene, estimator, preset.model)))


def render(material):
    """A pixel of it, by SVM."""
    return gonio.measure(material, Geometry(furnace=True, resolution=(1, 1)), shading_osl=False)


def padded(material, count):
    """Wrap a material's surface so that ``count`` more floats lie on the stack all the while: read on both sides."""
    tree = material.node_tree
    output = tree.get_output_node("CYCLES")
    inner = output.inputs["Surface"].links[0].from_socket
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(geometry.outputs["Position"], split.inputs[0])

    def add(a, b, kind="ShaderNodeVectorMath"):
        node = tree.nodes.new(kind)
        node.operation = "ADD"
        for value, socket in zip((a, b), node.inputs, strict=False):
            if isinstance(value, float):
                socket.default_value = (value,) * 3 if kind == "ShaderNodeVectorMath" else value
            else:
                tree.links.new(value, socket)
        return node.outputs[0]

    # Three at a time: Cycles takes long over many nodes.
    pads = [add(geometry.outputs["Position"], 1.0 + k) for k in range(count // 3)]
    pads += [add(split.outputs[0], 1.0 + k, "ShaderNodeMath") for k in range(count % 3)]
    sides = []
    for side in range(2):
        total = geometry.outputs[("Normal", "Incoming")[side]]
        for pad in pads:
            total = add(total, pad)
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(total, emission.inputs["Color"])
        sides.append(emission.outputs[0])
    both = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(inner, both.inputs[0])
    tree.links.new(sides[0], both.inputs[1])
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(split.outputs[0], mix.inputs[0])
    tree.links.new(both.outputs[0], mix.inputs[1])
    tree.links.new(sides[1], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def filled(material, need):
    """A copy beside which as many more floats lie as the estimate says that there is room for ``need``."""
    count = need - stack_need(material)
    while True:
        copy = material.copy()
        padded(copy, count)
        over = stack_need(copy) - need
        if over <= 0:
            return copy
        count -= over


def test_the_message_is_heard(empty_material):
    """A shader of 300 floats is black, and nothing but a line on the standard streams says so."""
    material = empty_material()
    tree = material.node_tree
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    seen = []
    assert not stack_overflows(lambda: seen.append(render(material)))
    padded(material, 300)
    assert stack_overflows(lambda: seen.append(render(material)))
    assert np.all(seen[0] > 0.5)
    assert np.all(seen[1] == 0.0)


@pytest.mark.parametrize(("name", "estimator", "rig"), MATERIALS)
def test_the_estimate_is_never_too_small_and_not_much_too_large(blender, name, estimator, rig):
    """What it says to fill the stack renders; what it says to be 15 % more does not, but where many lamps are bound."""
    made = made_of(blender, name, estimator, rig)
    assert not stack_overflows(lambda: render(filled(made, SIZE)))
    if rig in {None, "one sun"}:  # what drivers set may be any number, which folds less than what it is
        assert stack_overflows(lambda: render(filled(made, int(SIZE * ALLOWED))))


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("name", ["car_paints/blue", "lecture/copper"])
def test_what_the_estimate_lets_pass_renders(blender, name, rig):
    """Of materials as they are."""
    made = made_of(blender, name, "corrected", rig)
    assert stack_need(made) > SIZE or not stack_overflows(lambda: render(made))
