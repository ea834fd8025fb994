# SPDX-License-Identifier: GPL-3.0-or-later
"""Binding lamps to a material by drivers: where the lamp is, its colour and strength follow it wherever it goes.

Drivers use simple expressions only, so they run where Python scripts are barred, and read through the view layer
that is being rendered: a lamp that is deleted, excluded or a ghost of an append is not in it and gives no light.
"""

from __future__ import annotations

from math import pi, sin
from typing import TYPE_CHECKING

import bpy
from mathutils import Vector

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material, Node, NodeSocket, Object

LIMIT = 8
SMALLEST_SPREAD = 0.0175  # radians, 1 degree: below, hardly a random point on the lamp sends anything
# Blender 5.2 takes what a driver writes for 0 below 1e-4, which would put a low sun on the horizon. What reads an axis
# normalizes it, and a power of two rounds nothing.
FARTHER = 65536
STREAM = 10  # random numbers of the first bound lamp; mirror's facet has the first streams


def refusal(lamp: Object) -> str | None:
    """Why the formula cannot follow this lamp, and how to mend it; None if it can."""
    return next(
        (f'{"spot" if lamp.data.type == "SPOT" else "lamp"} "{lamp.name}" {why}' for why in _refusals(lamp)), None
    )


def _refusals(lamp: Object) -> Iterator[str]:  # noqa: C901 - one condition a refusal
    light = lamp.data
    # 5.x warns when use_nodes is read and always uses the tree; 4.5 may have one that is switched off.
    uses_nodes = light.node_tree is not None and (bpy.app.version >= (5, 0, 0) or light.use_nodes)
    if uses_nodes and _has_own_nodes(light.node_tree):
        yield "has a node tree, which the formula cannot follow; switch its Use Nodes off"
    if lamp.light_linking.receiver_collection:
        yield 'has light linking, which the formula cannot follow; clear it, or use "closure"'
    if lamp.light_linking.blocker_collection:
        yield 'has shadow linking, which the formula cannot follow; clear it, or use "closure"'
    if not (lamp.visible_diffuse and lamp.visible_glossy):
        yield 'is hidden from diffuse or glossy rays, which the formula cannot follow; show it, or use "closure"'
    if light.type == "SPOT":
        scale = lamp.matrix_world.to_scale()
        if max(scale) - min(scale) > 1e-4 * max(scale):
            yield "is scaled unevenly, which the formula cannot follow; apply its scale"
    if light.type == "AREA":
        if light.cycles.is_portal:
            yield "is a portal, which gives no light of its own; switch Portal off"
        if light.spread < SMALLEST_SPREAD:
            yield "has a spread under 1 degree, which the formula cannot follow; widen it, or use a sun"
        x, y, z = (column.normalized() for column in lamp.matrix_world.to_3x3().col)
        if max(abs(x.dot(y)), abs(y.dot(z)), abs(z.dot(x))) > 1e-4:
            yield "is sheared, which the formula cannot follow; scale its parent evenly"


def kind(lamp: Object) -> str:
    """Which group (``nodegroups/lamp.py``) follows this lamp: an area lamp's by its shape."""
    light = lamp.data
    if light.type != "AREA":
        return light.type
    return "RECTANGLE" if light.shape in {"SQUARE", "RECTANGLE"} else "ELLIPSE"


def size(lamp: Object) -> float:
    """Radius in metres or angle in radians; 0 for a lamp that rays cannot hit."""
    light = lamp.data
    if light.type == "SUN":
        return light.angle
    if light.type == "AREA":
        return light.size
    return light.shadow_soft_size


def of_scene(scene: bpy.types.Scene) -> list[Object]:
    """The lamps that light this scene's render, strongest first: by what reaches the middle of its objects.

    That is the mean of the objects' own middles. Each lamp counts as if it shone right at it, wherever it turns now.
    """
    things = [item for item in scene.objects if item.type in _SHADED and not item.hide_render]
    middles = [item.matrix_world @ (sum(map(Vector, item.bound_box), Vector()) / 8) for item in things]
    middle = sum(middles, Vector()) / max(len(middles), 1)
    lamps = [item for item in rendered(scene) if item.type == "LIGHT" and not item.hide_render]
    return sorted(lamps, key=lambda lamp: (-_irradiance(lamp, middle), lamp.name))


def rendered(scene: bpy.types.Scene) -> set[Object]:
    """What is in a collection that a view layer renders: neither excluded there nor switched off for renders.

    A view layer's own list of objects is of its last update, which may be long ago.
    """
    layers = [layer for layer in scene.view_layers if layer.use]
    for layer in layers:
        if layer.layer_collection is None:  # of a scene that no window has shown
            layer.update()
    roots = [layer.layer_collection for layer in layers]
    return {item for root in roots for item in _inside(root)}


def _inside(of: bpy.types.LayerCollection) -> Iterator[Object]:
    if not of.exclude and not of.collection.hide_render:
        yield from of.collection.objects
        for child in of.children:
            yield from _inside(child)


_SHADED = {"MESH", "CURVE", "SURFACE", "META", "FONT", "POINTCLOUD", "CURVES"}


def _irradiance(lamp: Object, place: Vector) -> float:
    """About what reaches ``place`` across the beam: W/m^2 summed over R, G and B."""
    light = lamp.data
    color = [
        c * (t if light.use_temperature else 1.0) for c, t in zip(light.color, light.temperature_color, strict=True)
    ]
    power = light.energy * 2.0**light.exposure * sum(color) * (1.0 if light.normalize else _surface(lamp))
    if light.type == "SUN":
        return power
    d2 = (lamp.matrix_world.translation - place).length_squared + size(lamp) ** 2
    return power / max(d2, 1e-12) / (pi if light.type == "AREA" else 4 * pi)


def _surface(lamp: Object) -> float:
    """What Cycles divides the strength of a normalized lamp by; 4 for a point of no size makes it W per steradian."""
    light, extent = lamp.data, size(lamp)
    if light.type == "SUN":
        return pi * sin(extent / 2) ** 2 if extent > 0 else 1.0
    if light.type != "AREA":
        return 4 * pi * extent**2 if extent > 0 else 4.0
    height = light.size if light.shape in {"SQUARE", "DISK"} else light.size_y
    x, y, _ = lamp.matrix_world.to_scale()
    return abs(x * y) * extent * height * (1.0 if kind(lamp) == "RECTANGLE" else pi / 4)


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


def bound(material: Material) -> set[Object]:
    """The lamps that drive a material."""
    animation = material.node_tree.animation_data
    drivers = animation.drivers if animation else []
    targets = (target for curve in drivers for variable in curve.driver.variables for target in variable.targets)
    return {target.id for target in targets if isinstance(target.id, bpy.types.Object)}


def bind(node: Node, lamp: Object, index: int = 0, *, only_pointlike: bool = False) -> None:
    """Drive the inputs of a lamp group (``nodegroups/lamp.py``) by ``lamp``, the ``index``-th of its material.

    only_pointlike: the lamp gives nothing here once it has a size, as then rays hit it and it would count twice.
    """
    for channel in range(3):
        _drive(
            node.inputs["Color"],
            channel,
            lamp,
            "c * (1 - t + t * k)",
            {"c": f"data.color[{channel}]", "t": "data.use_temperature", "k": f"data.temperature_color[{channel}]"},
        )
    surface, paths = _SURFACES[kind(lamp)]
    square = lamp.data.type == "AREA" and lamp.data.shape in {"SQUARE", "DISK"}
    height = "data.size" if square else "data.size_y"
    paths = {name: height if path == "data.size_y" else path for name, path in paths.items()}
    _drive(
        node.inputs["Strength"],
        -1,
        lamp,
        f"e * pow(2, x) * (1 - h) * ({surface})" + " * (z <= 0)" * only_pointlike,
        {"e": "data.energy", "x": "data.exposure", "n": "data.normalize"}
        | paths
        | ({"z": "data.angle" if lamp.data.type == "SUN" else "data.shadow_soft_size"} if only_pointlike else {}),
        gate="h",
    )
    # RNA gives the matrix transposed: row 2 is the lamp's z axis, row 3 its place.
    vectors = {"Axis": (2, ""), "Position": (3, ""), "Across": (0, "data.size"), "Up": (1, height)}
    for name, (row, extent) in vectors.items():
        if name in node.inputs:
            for channel in range(3):
                entry = {"v": f"matrix_world[{row}][{channel}]"}
                expression = "v * s" if extent else f"v * {FARTHER}" if name == "Axis" else "v"
                _drive(node.inputs[name], channel, lamp, expression, entry | ({"s": extent} if extent else {}))
    for name, (expression, path) in _NUMBERS.items():
        if name in node.inputs:
            _drive(node.inputs[name], -1, lamp, expression, {"v": path})
    if "Stream" in node.inputs:
        node.inputs["Stream"].default_value = STREAM + index


# By what to multiply a strength for Cycles' normalized one, n: that is 1, else the surface as in ``_surface``.
_AREA = "sqrt(a*a + b*b + c*c) * sqrt(o*o + p*p + q*q) * w * l"
_AREA_PATHS = {"w": "data.size", "l": "data.size_y"} | {
    name: f"matrix_world[{row}][{channel}]"
    for row, names in enumerate(("abc", "opq"))
    for channel, name in enumerate(names)
}
_RADIUS = "n + (1 - n) * (4 * pi * r * r if r > 0 else 4)", {"r": "data.shadow_soft_size"}
_SURFACES = {
    "SUN": ("n + (1 - n) * (pi * pow(sin(a / 2), 2) if a > 0 else 1)", {"a": "data.angle"}),
    "POINT": _RADIUS,
    "SPOT": _RADIUS,
    "RECTANGLE": (f"n * ({_AREA} > 0) + (1 - n) * {_AREA}", _AREA_PATHS),
    "ELLIPSE": (f"n * ({_AREA} > 0) + (1 - n) * {_AREA} * pi / 4", _AREA_PATHS),
}
_HALF_SPREAD = f"(max(v, {SMALLEST_SPREAD}) / 2)"
_NUMBERS = {  # input -> driver expression and what v is
    "Size": ("v", "data.spot_size"),
    "Blend": ("v", "data.spot_blend"),
    "Angle": ("v", "data.angle"),
    "Radius": ("v", "data.shadow_soft_size"),
    "Soft Falloff": ("v", "data.use_soft_falloff"),
    "Grid": (f"1 / tan({_HALF_SPREAD})", "data.spread"),
    "Gain": (f"1 / (1 - {_HALF_SPREAD} / tan({_HALF_SPREAD}))", "data.spread"),
}


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
