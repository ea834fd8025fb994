# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's other words for a material's numbers: a metal's colour, and parameters as papers give them."""

import numpy as np
import pytest

from vgroove.addon.blender import beside, material, roles
from vgroove.addon.blender.material import Choice
from vgroove.addon.library import presets
from vgroove.addon.ui import panels

from .panel import drawn

pytestmark = pytest.mark.blender


def built(identity):
    made = material.build(presets.find(identity), Choice("nodes", "fit"))
    return made, made.vgroove_numbers


def test_the_colour_of_a_metal_moves_its_index(extension):
    """It is what the metal reflects head-on, before and after; the preset's n and k come back by the switch."""
    copper = presets.find("metals/copper")
    made, numbers = built("metals/copper")
    np.testing.assert_allclose(numbers.color, copper.reference_fresnel()(1.0), rtol=1e-6)
    assert numbers.measured
    numbers.color = (0.2, 0.5, 0.9)
    now = material.origin_of(made).preset
    np.testing.assert_allclose(now.reference_fresnel()(1.0), (0.2, 0.5, 0.9), rtol=1e-5)
    assert (numbers.measured, now.m) == (False, copper.m)
    numbers.measured = True
    assert numbers.measured
    assert not material.is_edited(made)
    for color in ((1.0, 1.0, 1.0), (0.0, 0.5, 0.99)):  # the ends have no n and k: held within
        numbers.color = color
        now = material.origin_of(made).preset
        assert now == now.with_parameters(m=now.m)  # in the range that files allow
        np.testing.assert_allclose(now.reference_fresnel()(1.0), np.clip(color, 1e-3, 0.9999), rtol=1e-3)
    numbers.measured = True
    for color in ((1.0, 1.0, 1.0), copper.reference_fresnel()(1.0)):  # n and k reach 20, and forget the edge
        numbers.color = color
    for name, value in material.origin_of(made).preset.parameters.items():
        np.testing.assert_allclose(value, copper.parameters[name], rtol=1e-4)
    sockets = material.parameter_sockets(made)
    numbers.color = (1.0, 1.0, 1.0)
    sockets["n"].default_value, sockets["k"].default_value = (1.5, 1.5, 1.5), (2.0, 2.0, 2.0)  # by hand: another edge
    numbers.color = numbers.color
    np.testing.assert_allclose(sockets["k"].default_value, 2.0, rtol=1e-4)
    noise = made.node_tree.nodes.new("ShaderNodeTexNoise")
    made.node_tree.links.new(noise.outputs["Color"], material.parameter_sockets(made)["n"])
    numbers.color = (0.5, 0.5, 0.5)  # nothing to set
    assert tuple(numbers.color) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("identity", "name", "value"), [("metals/copper", "m", 0.09), ("diffuse/clay", "sigma", 0.6)])
def test_parameters_as_papers_give_them(extension, identity, name, value):
    """Shown and set beside Roughness, which moves with them; held to their range."""
    made, numbers = built(identity)
    assert getattr(numbers, name) == pytest.approx(presets.find(identity).parameters[name], rel=1e-5)
    setattr(numbers, name, value)
    assert material.origin_of(made).preset.parameters[name] == pytest.approx(value, rel=1e-5)
    socket = material.parameter_sockets(made)[name]
    assert socket.name == "Roughness"
    if name == "m":
        assert socket.default_value == pytest.approx(0.3)
    setattr(numbers, name, 1e9)
    assert getattr(numbers, name) == pytest.approx(presets.find(identity).spec.parameter(name).high, rel=1e-5)


def test_what_a_material_lacks_reads_as_nothing(extension):
    """A material that is not ours, and one that is no metal."""
    plain = extension.data.materials.new("Plain").vgroove_numbers
    clay = built("diffuse/clay")[1]
    for numbers in (plain, clay):
        assert tuple(numbers.color) == (0.0, 0.0, 0.0)
        assert not numbers.measured
        assert numbers.alpha == 1.0
        numbers.m = 0.5
        assert numbers.m == 0.0


def test_alpha_is_shown_unless_a_texture_feeds_it(extension):
    """1 and without a node until it is set; read and set in either order of the mix's sides."""
    clay, numbers = built("diffuse/clay")
    extension.context.object.active_material = clay
    assert "alpha" in drawn(extension, panels.VGROOVE_PT_parameters).props
    count = len(clay.node_tree.nodes)
    numbers.alpha = 1.0
    assert (numbers.alpha, len(clay.node_tree.nodes)) == (1.0, count)
    numbers.alpha = 0.25
    assert numbers.alpha == 0.25
    (mix,) = beside.joints(clay, roles.CLEAR)
    beside.exchange(clay.node_tree, mix)
    assert numbers.alpha == 0.75
    numbers.alpha = 0.25
    assert (numbers.alpha, mix.inputs[0].default_value) == (0.25, 0.75)
    noise = clay.node_tree.nodes.new("ShaderNodeTexNoise")
    clay.node_tree.links.new(noise.outputs[0], mix.inputs[0])
    numbers.alpha = 0.5
    assert mix.inputs[0].default_value == 0.75
    assert "alpha" not in drawn(extension, panels.VGROOVE_PT_parameters).props
