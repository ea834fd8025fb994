# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs at their ends: what a texture drives beyond a socket's range is held to it, by every estimator.

Sockets hold only what is typed; what is linked reaches the shader as it is. Each input is driven through a linked node
and compared with the same number typed, where the socket holds it.
"""

from functools import partial

import numpy as np
import pytest

from vgroove.addon.blender import material
from vgroove.addon.blender.material import BUILDERS, Choice, build, lamps_to_bind
from vgroove.addon.library import presets
from vgroove.headless import scene

pytestmark = pytest.mark.blender

MATERIALS = {
    "schlick": presets.find("lecture/copper"),
    "f82": presets.find("metals_schlick/copper_schlick"),
    "conductor": presets.find("metals/copper"),
    "diffuse": presets.find("diffuse/chalk"),
    "coupled": presets.find("plastics/red_plastic"),
    "car paint": presets.find("car_paints/white"),
    "translucent": presets.find("translucent/apple"),
    "glass": presets.find("lecture/glass").with_parameters(m=0.2),
}
ROWS = [
    (name, estimator, backend)
    for name, preset in MATERIALS.items()
    for estimator in BUILDERS[preset.model]
    for backend in material.BACKENDS
]
ENDS = (0.0, 1.0, -3.0, 1e30)


def parameters_of(made):
    """The inputs that an artist may link a texture to; those of lamps and normals apart."""
    groups = (node for node in made.node_tree.nodes if node.bl_idname == "ShaderNodeGroup")
    node = next(node for node in groups if "Normal" in node.inputs)
    apart = ("Normal", "To Lamp", "Irradiance")
    return node, [socket for socket in node.inputs if not socket.name.startswith(apart)]


def drive(made, name, value):
    """Link the number to the input; all components where it has three."""
    tree, (node, _) = made.node_tree, parameters_of(made)
    source = tree.nodes.new("ShaderNodeValue")
    source.outputs[0].default_value = value  # a colour takes it thrice
    tree.links.new(source.outputs[0], node.inputs[name])


def type_in(made, name, value):
    """Set the number as an artist would, whom the socket holds to its range."""
    node, _ = parameters_of(made)
    socket = node.inputs[name]
    if socket.type == "RGBA":
        socket.default_value = (*[np.clip(value, 0.0, 1.0)] * 3, 1.0)  # reflectances, which Blender lets exceed 1
    else:
        item = next(i for i in node.node_tree.interface.items_tree if i.item_type == "SOCKET" and i.name == name)
        held = float(np.clip(value, item.min_value, item.max_value))
        socket.default_value = held if socket.type == "VALUE" else (held, held, held)


def pictures(balls, name, estimator, backend, dress):
    """A ball of each material that ``dress`` makes of the built one; pixels have the same noise in each picture."""
    preset = MATERIALS[name]

    def make(stage):
        scene.add_sun(stage)
        return list(dress(build(preset, Choice(backend, estimator, lamps_to_bind(stage, estimator, preset.model)))))

    seen = balls(make, osl=backend == "osl")
    assert np.isfinite(seen).all()
    return seen


@pytest.mark.parametrize(("name", "estimator", "backend"), ROWS)
def test_what_is_linked_is_held_to_the_range_of_its_socket(balls, name, estimator, backend):
    """Zero, one, less and far more: the picture is finite, and that of the number typed in."""

    def dress(plain, put):
        for socket in parameters_of(plain)[1]:
            for value in ENDS:
                made = plain.copy()
                put(made, socket.name, value)
                yield made

    linked, typed = (pictures(balls, name, estimator, backend, partial(dress, put=put)) for put in (drive, type_in))
    # One shader with the same numbers and the same noise; linked ones are folded in another order: 2^-24 each time.
    np.testing.assert_allclose(linked, typed, rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize(("name", "estimator", "backend"), ROWS)
def test_any_normal_that_is_linked_gives_a_picture(balls, name, estimator, backend):
    """Its length does not matter, and without one the surface's own is taken."""

    def dress(plain, parts):
        made = plain.copy()
        if parts is not None:
            tree, (node, _) = made.node_tree, parameters_of(made)
            source = tree.nodes.new("ShaderNodeCombineXYZ")
            for socket, part in zip(source.inputs, parts, strict=True):
                socket.default_value = part
            tree.links.new(source.outputs[0], node.inputs["Normal"])
        yield made

    plain, none, unit, long, _ = (
        pictures(balls, name, estimator, backend, partial(dress, parts=parts))
        for parts in (None, (0.0, 0.0, 0.0), (0.2, 0.1, 1.0), (2e14, 1e14, 1e15), (-1e30, 1e30, 1e30))
    )
    np.testing.assert_allclose(none, plain, rtol=1e-3, atol=1e-4)
    np.testing.assert_allclose(long, unit, rtol=1e-3, atol=1e-4)
