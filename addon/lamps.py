# SPDX-License-Identifier: GPL-3.0-or-later
"""Binding lamps to a material by drivers: where the lamp is, its colour and strength follow it wherever it goes.

Drivers use simple expressions only, so they run where Python scripts are barred, and read through the view layer
that is being rendered: a lamp that is deleted, excluded or a ghost of an append is not in it and gives no light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from bpy.types import Node, NodeSocket, Object

LIMIT = 4
KINDS = ("SUN", "POINT", "SPOT")


def refusal(lamp: Object) -> str | None:
    """Why ``direct`` cannot follow this lamp, and how to mend it; None if it can."""
    light = lamp.data
    if light.type not in KINDS:
        return f'lamp "{lamp.name}" is an area lamp, which "direct" cannot evaluate; use a sun, point or spot'
    # 5.x warns when use_nodes is read and always uses the tree; 4.5 may have one that is switched off.
    uses_nodes = light.node_tree is not None and (bpy.app.version >= (5, 0, 0) or light.use_nodes)
    if uses_nodes and _has_own_nodes(light.node_tree):
        return f'lamp "{lamp.name}" has a node tree, which "direct" cannot follow; switch its Use Nodes off'
    if light.type != "SUN" and not light.normalize:
        return f'lamp "{lamp.name}" is not normalized, which "direct" cannot follow; switch Normalize on'
    if any(item.light_linking.receiver_collection for item in (lamp,)):
        return f'lamp "{lamp.name}" has light linking, which "direct" cannot follow; clear it, or use "closure"'
    scale = lamp.matrix_world.to_scale()
    if light.type == "SPOT" and max(scale) - min(scale) > 1e-4 * max(scale):
        return f'spot "{lamp.name}" is scaled unevenly, which "direct" cannot follow; apply its scale'
    return None


def size(lamp: Object) -> float:
    """Radius in metres or angle in radians; 0 for a lamp that rays cannot hit."""
    light = lamp.data
    if light.type == "SUN":
        return light.angle
    if light.type == "AREA":
        return light.size
    return light.shadow_soft_size


def of_scene(scene: bpy.types.Scene) -> list[Object]:
    """The lamps that light this scene's render, strongest first."""
    lamps = [item for item in scene.objects if item.type == "LIGHT" and not item.hide_render]
    return sorted(lamps, key=lambda lamp: (-_brightness(lamp), lamp.name))


def _brightness(lamp: Object) -> float:
    light = lamp.data
    power = light.energy * 2.0**light.exposure * sum(light.color)
    return power if light.type == "SUN" else power / 40.0  # at 1 m or so a point of 4 pi^2 W is a sun of 1 W/m^2


def _has_own_nodes(tree: bpy.types.NodeTree) -> bool:
    """Whether a lamp's nodes do more than the plain white Emission that Blender starts with."""
    emissions = [node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission"]
    others = [node for node in tree.nodes if node.bl_idname not in {"ShaderNodeEmission", "ShaderNodeOutputLight"}]
    if others or len(emissions) != 1:
        return True
    color, strength = emissions[0].inputs["Color"], emissions[0].inputs["Strength"]
    return (
        color.is_linked
        or strength.is_linked
        or tuple(color.default_value) != (1, 1, 1, 1)
        or strength.default_value != 1
    )


def bind(node: Node, lamp: Object) -> None:
    """Drive the inputs of a lamp group (``nodegroups/lamp.py``) by ``lamp``."""
    for channel in range(3):
        _drive(
            node.inputs["Color"],
            channel,
            lamp,
            "c * (1 - t + t * k)",
            {"c": f"data.color[{channel}]", "t": "data.use_temperature", "k": f"data.temperature_color[{channel}]"},
        )
    _drive(
        node.inputs["Strength"],
        -1,
        lamp,
        "e * pow(2, x) * (1 - h)",
        {"e": "data.energy", "x": "data.exposure"},
        gate="h",
    )
    # RNA gives the matrix transposed: row 2 is the lamp's z axis, row 3 its place.
    for name, row in (("Axis", 2), ("Position", 3)):
        if name in node.inputs:
            for channel in range(3):
                _drive(node.inputs[name], channel, lamp, "v", {"v": f"matrix_world[{row}][{channel}]"})
    for name, path in (("Size", "data.spot_size"), ("Blend", "data.spot_blend")):
        if name in node.inputs:
            _drive(node.inputs[name], -1, lamp, "v", {"v": path})


def _drive(
    socket: NodeSocket, index: int, lamp: Object, expression: str, paths: dict[str, str], gate: str | None = None
) -> None:
    driver = socket.driver_add("default_value", index).driver
    driver.type = "SCRIPTED"
    for name, path in paths.items():
        variable = driver.variables.new()
        variable.name = name
        target = variable.targets[0]
        target.id_type, target.id, target.data_path = "OBJECT", lamp, path
        target.use_fallback_value, target.fallback_value = True, 0.0  # when the lamp is deleted
    if gate:
        variable = driver.variables.new()
        variable.name, variable.type = gate, "CONTEXT_PROP"
        target = variable.targets[0]
        target.context_property = "ACTIVE_VIEW_LAYER"
        target.data_path = f'objects["{bpy.utils.escape_identifier(lamp.name)}"].hide_render'
        target.use_fallback_value, target.fallback_value = True, 1.0  # not in this view layer: as if hidden
    driver.expression = expression
