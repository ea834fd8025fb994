# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's lights, written into the scene for materials that evaluate the formula at them.

A material holds no reference to a light: it reads the first sun, the second spot and so on from the *rig*, a custom
property of the scene whose numbers are driven by the lights themselves. So a material that is appended elsewhere drags
no light along and meets the lights of its new scene. ``follow`` rewrites a rig when lights come, go or change their
kind.

Drivers use simple expressions only, so they run where Python scripts are barred. A light that is hidden, deleted,
excluded from the view layer that is rendered, renamed, linked to some objects only, or of another kind than it was when
the rig was written gives nothing until the rig is rewritten; estimators that see it by themselves then show it in their
own way. Drivers cannot see a light's nodes, which count from the next rewrite on.
"""

from __future__ import annotations

import json
from collections import Counter
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import pi, sin
from typing import TYPE_CHECKING, Any

import bpy
from mathutils import Matrix, Vector

from ...nodegroups import versions
from ...nodegroups.lamp import AREAS, RIG, Slot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Collection, LayerCollection, Material, NodeTree, Object, Scene

LIMIT = 8
SMALLEST_SPREAD = 0.0175  # radians, 1 degree: below, hardly any random point on the lamp sends light
# 5.2 flushes driver values near 0 to 0, which would put a low sun on the horizon. Readers normalise an axis, and
# a power of two rounds nothing.
AXIS_SCALE = 65536
PLAN = "plan"  # beside the arrays of the rig, RIG: what they were written for


@dataclass(frozen=True)
class Light:
    """A light that lights a scene.

    item: the light's object. scene: whose render it lights. source: the collection instance that brings it, None for
    an object of the scene itself or of its background sets (``in_set``). number: among those of its kind in the rig,
    from 1; 0 while it has no place there.
    """

    item: Object
    scene: Scene
    source: Object | None = None
    in_set: bool = False
    number: int = 0

    @property
    def slot(self) -> Slot:
        """Its entry in the rig, by the light's present kind and size."""
        return Slot(kind(self.item), size(self.item) > 0.0, self.item.data.use_shadow, self.number)

    @property
    def name(self) -> str:
        """Its name in messages."""
        return f"{self.item.name} (instance {self.source.name})" if self.source else self.item.name

    @property
    def offset(self) -> Vector:
        """The instance offset (3,), metres, which is subtracted from the places of what it brings."""
        return self.source.instance_collection.instance_offset if self.source else Vector()

    @property
    def matrix(self) -> Matrix:
        """From the light's space to the world's."""
        if self.source is None:
            return self.item.matrix_world
        return self.source.matrix_world @ Matrix.Translation(-self.offset) @ self.item.matrix_world


def refusal(light: Light | Object) -> str | None:
    """Why the formula cannot be evaluated at this light, and how to fix it; None if it can."""
    one = light if isinstance(light, Light) else Light(light, bpy.context.scene)
    kind = "spot" if one.item.data.type == "SPOT" else "light"
    return next((f'{kind} "{one.name}" {why}' for why in _refusals(one)), None)


def _refusals(light: Light) -> Iterator[str]:  # noqa: C901 - one condition a refusal
    lamp, data, matrix = light.item, light.item.data, light.matrix
    if (tree := versions.used_nodes(data)) is not None and _has_own_nodes(tree):
        yield "has a node tree, which the formula does not include; turn its Use Nodes off"
    if lamp.light_linking.receiver_collection:
        yield "has light linking, which the formula does not include; clear it, or choose Standard"
    if lamp.light_linking.blocker_collection:
        yield "has shadow linking, which the formula does not include; clear it, or choose Standard"
    if not (lamp.visible_diffuse and lamp.visible_glossy):
        yield "is hidden from diffuse or glossy rays, which the formula does not include; show it, or choose Standard"
    if light.source and max(abs(s - 1.0) for s in light.source.matrix_world.to_scale()) > 1e-4:
        yield f'belongs to the scaled instance "{light.source.name}", which the formula does not include; unscale it'
    if data.type == "SPOT":
        scale = matrix.to_scale()
        if max(scale) - min(scale) > 1e-4 * max(scale):
            yield "is scaled unevenly, which the formula does not include; apply its scale"
    if data.type == "AREA":
        if data.cycles.is_portal:
            yield "is a portal, which emits no light of its own; turn Portal off"
        if data.spread < SMALLEST_SPREAD:
            yield "has a spread under 1 degree, which the formula does not include; widen it, or use a Sun light"
        x, y, z = (column.normalized() for column in matrix.to_3x3().col)
        if max(abs(x.dot(y)), abs(y.dot(z)), abs(z.dot(x))) > 1e-4:
            yield "is sheared, which the formula does not include; scale its parent evenly"


def kind(lamp: Object) -> str:
    """Which group (``nodegroups/lamp.py``) follows this light: an area light's by its shape."""
    light = lamp.data
    if light.type != "AREA":
        return light.type
    return "RECTANGLE" if light.shape in {"SQUARE", "RECTANGLE"} else "ELLIPSE"


def size(lamp: Object) -> float:
    """Radius in metres or angle in radians; 0 for a light that rays cannot hit."""
    light = lamp.data
    if light.type == "SUN":
        return light.angle
    if light.type == "AREA":
        return light.size
    return light.shadow_soft_size


# The lights of a scene


def of_scene(scene: Scene) -> list[Object]:
    """The lights among the scene's own objects that light its render, strongest first."""
    return [light.item for light in all_lights(scene) if not (light.source or light.in_set)]


def all_lights(scene: Scene) -> list[Light]:
    """The lights that the scene's objects, its collection instances and its background sets bring, strongest first.

    Strongest is what sends most to the mean of the objects' own middles. Each light counts as if it shone right at it,
    wherever it turns now. What instances bring within instances, and what particles and geometry nodes bring, is not
    among them.
    """
    if _known is None:
        return _found(scene)
    if scene not in _known:
        _known[scene] = _found(scene)
    return list(_known[scene])


_known: dict[Scene, list[Light]] | None = None  # within ``read_once``


@contextmanager
def read_once() -> Iterator[None]:
    """Look at each scene's lights once within the block, in which nothing may change them."""
    global _known  # noqa: PLW0603 - as the lights of a scene are one thing for all who ask
    outer, _known = _known, _known if _known is not None else {}
    try:
        yield
    finally:
        _known = outer


def _found(scene: Scene) -> list[Light]:
    things = [item for item in scene.objects if item.type in _SHADED and not item.hide_render]
    middles = [item.matrix_world @ (sum(map(Vector, item.bound_box), Vector()) / 8) for item in things]
    middle = sum(middles, Vector()) / max(len(middles), 1)
    lights = [light for light in _brought(scene) if not light.item.hide_render]
    return sorted(lights, key=lambda light: (-_irradiance(light, middle), light.name))


def _brought(scene: Scene) -> Iterator[Light]:
    for shown, in_set in ((scene, False), *((one, True) for one in _sets(scene))):
        for item in rendered(shown):
            if item.type == "LIGHT":
                if item.parent is None or item.parent.instance_type not in {"VERTS", "FACES"}:  # else only copies shine
                    yield Light(item, scene, in_set=in_set)
            elif item.instance_type == "COLLECTION" and item.instance_collection and not item.hide_render:
                inside = _of_collection(item.instance_collection)
                yield from (Light(one, scene, item, in_set) for one in inside if one.type == "LIGHT")


def _sets(scene: Scene) -> Iterator[Scene]:
    """Background sets, each behind the one before; Blender allows no circle."""
    while scene := scene.background_set:
        yield scene


def _of_collection(collection: Collection) -> Iterator[Object]:
    if not collection.hide_render:
        yield from collection.objects
        for child in collection.children:
            yield from _of_collection(child)


def rendered(scene: Scene) -> set[Object]:
    """What is in a collection that a view layer renders: neither excluded there nor switched off for renders.

    A view layer's own list of objects is of its last update, which may be long ago.
    """
    layers = [layer for layer in scene.view_layers if layer.use]
    for layer in layers:
        if layer.layer_collection is None:  # of a scene that no window has shown
            layer.update()
    roots = [layer.layer_collection for layer in layers]
    return {item for root in roots for item in _inside(root)}


def materials_in(scene: Scene) -> set[Material]:
    """The materials of what a scene renders."""
    slots = (slot for item in rendered(scene) for slot in item.material_slots)
    return {slot.material for slot in slots if slot.material}


def _inside(of: LayerCollection) -> Iterator[Object]:
    if not of.exclude and not of.collection.hide_render:
        yield from of.collection.objects
        for child in of.children:
            yield from _inside(child)


_SHADED = {"MESH", "CURVE", "SURFACE", "META", "FONT", "POINTCLOUD", "CURVES"}


def _irradiance(light: Light, place: Vector) -> float:
    """Approximate irradiance at ``place`` (metres) on a surface that faces the light, W/m^2, summed over R, G and B."""
    lamp, data = light.item, light.item.data
    color = [c * (t if data.use_temperature else 1.0) for c, t in zip(data.color, data.temperature_color, strict=True)]
    power = data.energy * 2.0**data.exposure * sum(color) * (1.0 if data.normalize else _surface(light))
    if data.type == "SUN":
        return power
    d2 = (light.matrix.translation - place).length_squared + size(lamp) ** 2
    return power / max(d2, 1e-12) / (pi if data.type == "AREA" else 4 * pi)


def _surface(light: Light) -> float:
    """The area by which Cycles divides the strength of a normalized light, m^2; 4 for a point of zero size: W/sr."""
    data, extent = light.item.data, size(light.item)
    if data.type == "SUN":
        return pi * sin(extent / 2) ** 2 if extent > 0 else 1.0
    if data.type != "AREA":
        return 4 * pi * extent**2 if extent > 0 else 4.0
    height = data.size if data.shape in {"SQUARE", "DISK"} else data.size_y
    x, y, _ = light.matrix.to_scale()
    return abs(x * y) * extent * height * (1.0 if kind(light.item) == "RECTANGLE" else pi / 4)


def _has_own_nodes(tree: NodeTree) -> bool:
    """Whether a light's nodes are not what Blender starts with: a plain white Emission, linked to the output."""
    if sorted(node.bl_idname for node in tree.nodes) != ["ShaderNodeEmission", "ShaderNodeOutputLight"]:
        return True
    emission = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission")
    color, strength = (emission.inputs[name].default_value for name in ("Color", "Strength"))
    linked = [link for link in tree.links if not (link.is_muted or emission.mute)]  # without, the light is black
    return len(linked) != 1 or tuple(color) != (1, 1, 1, 1) or strength != 1


# The rig


def rig_lights(scene: Scene) -> list[Light]:
    """The lights that belong into the rig of ``scene``, each with its slot, strongest first; writes nothing.

    They are the strongest of all and the strongest of those without a size, ``LIMIT`` of each.
    """
    return with_numbers([light for light in all_lights(scene) if refusal(light) is None])


def with_numbers(fit: list[Light]) -> list[Light]:
    """The lights that get an entry in the rig, with their numbers, of those that the formula allows; in order."""
    wanted = {*fit[:LIMIT], *[light for light in fit if size(light.item) == 0.0][:LIMIT]}
    counts: Counter[Slot] = Counter()
    numbered = []
    for light in (light for light in fit if light in wanted):
        counts[light.slot] += 1
        numbered.append(replace(light, number=counts[light.slot]))
    return numbered


def follow(scene: Scene) -> list[Light]:
    """Update the scene's rig to its lights; returns them, strongest first. Writes nothing if the rig is up to date."""
    lights = rig_lights(scene)
    plan = json.dumps([_plan(light) for light in lights])
    rig = scene.get(RIG)
    if rig is None or rig.get(PLAN) != plan:
        release(scene)
        scene[RIG] = {PLAN: plan} | {name: [0.0] * width for light in lights for name, width in _entries(light)}
        for light in lights:
            _describe(light)
        scene.update_tag()
    return lights


def release(scene: Scene) -> None:
    """Remove the rig from a scene."""
    if scene.animation_data:
        for curve in [one for one in scene.animation_data.drivers if one.data_path.startswith(f'["{RIG}"]')]:
            scene.animation_data.drivers.remove(curve)
    if RIG in scene:
        del scene[RIG]


def _plan(light: Light) -> list[Any]:
    """What a light's entries in the rig depend on but for what its drivers read."""
    who = [str(light.slot), light.item.name, light.item.library and light.item.library.filepath]
    return [*who, light.in_set, light.source and [light.source.name, *light.offset]]


def _entries(light: Light) -> list[tuple[str, int]]:
    """The arrays of a light in the rig, by name, with their lengths."""
    return [(light.slot.entry(name), width) for name, width in light.slot.arrays().items()]


def _describe(light: Light) -> None:
    """Drive the light's entries in the rig of its scene."""
    slot = light.slot
    for channel in range(3):
        paths = {"c": f"data.color[{channel}]", "t": "data.use_temperature", "k": f"data.temperature_color[{channel}]"}
        _drive(light, "color", channel, "c * (1 - t + t * k)", paths)
    _drive_strength(light)
    columns = {"axis": 2, "place": 3, "across": 0, "up": 1}
    for name in columns.keys() & slot.arrays().keys():
        for channel in range(3):
            _drive_vector(light, name, channel, columns[name])
    for index, (expression, path) in enumerate(_SHAPES.get((slot.kind, slot.sized), ())):
        _drive(light, "shape", index, expression, {"v": path})


def _drive_strength(light: Light) -> None:
    """W/m^2 or W with exposure; 0 where the light is not what the slot says, or not in the view layer."""
    slot, data = light.slot, light.item.data
    surface, paths = _SURFACES[slot.kind]
    code = data.bl_rna.properties["type"].enum_items[data.type].value
    gates = {
        "hide_render": "{} == 0", "visible_diffuse": "{} == 1", "visible_glossy": "{} == 1",
        "data.type": f"{{}} == {code}", "data.use_shadow": f"{{}} == {int(slot.shadows)}",
    }  # fmt: skip
    if slot.kind in AREAS:
        gates |= {"data.shape": "{} < 2" if slot.kind == "RECTANGLE" else "{} > 2", "data.size": "{} > 0"}
        gates |= {"data.cycles.is_portal": "{} == 0"}
    else:
        gates["data.angle" if slot.kind == "SUN" else "data.shadow_soft_size"] = "{} > 0" if slot.sized else "{} <= 0"
    names = dict(zip(gates, "ABCDFGJM", strict=False))
    conditions = [gates[path].format(name) for path, name in names.items()]
    conditions.append("K + L < -1")  # neither collection is there: both paths lead to their fallback, -1
    variables = {"e": "data.energy", "x": "data.exposure", "n": "data.normalize", **paths}
    variables |= {name: path for path, name in names.items()}
    here = light.source or (None if light.in_set else light.item)
    if here is not None:
        conditions.append("H >= 0")
    if light.source:
        conditions.append("I == 0")
    expression = f"e * pow(2, x) * ({surface}) if {' and '.join(conditions)} else 0"  # Blender takes 255 characters
    driver = _drive(light, "color", 3, expression, variables)
    for name, of in (("K", "receiver"), ("L", "blocker")):
        _object_variable(driver, name, light.item, f"light_linking.{of}_collection.hide_render", -1.0)
    if here is not None:
        # Only the view layer that is being rendered tells whether an object is in it: by name.
        path = f'objects["{bpy.utils.escape_identifier(here.name)}"].type'
        _context_variable(driver, "H", path)
    if light.source:
        _object_variable(driver, "I", light.source, "hide_render", 1.0)


def _drive_vector(light: Light, name: str, channel: int, column: int) -> None:
    """A column of the light's matrix: RNA gives it transposed, so that [3] is the light's place."""
    extent: dict[str, str] = {}
    factor = f" * {AXIS_SCALE}" if name == "axis" else ""
    if name == "across":
        extent, factor = {"s": "data.size"}, " * s"
    elif name == "up":  # squares and disks have one size
        extent = {"s": "data.size", "l": "data.size_y", "q": "data.shape"}
        factor = " * (s if q == 0 or q == 4 else l)"
    if light.source is None:
        _drive(light, name, channel, f"v{factor}", {"v": f"matrix_world[{column}][{channel}]"} | extent)
        return
    own = {v: f"matrix_world[{column}][{k}]" for k, v in enumerate("uvw")}
    less = [f" - {part!r}" if column == 3 else "" for part in light.offset]
    terms = [f"{outer} * ({inner}{of})" for outer, inner, of in zip("abc", "uvw", less, strict=True)]
    total = " + ".join([*terms, *["d"] * (column == 3)])
    driver = _drive(light, name, channel, f"({total}){factor}", own | extent)
    for k, outer in enumerate("abcd" if column == 3 else "abc"):
        _object_variable(driver, outer, light.source, f"matrix_world[{k}][{channel}]", 0.0)


# Factor from a light's strength to the normalized one: 1 if it is normalized (n), else the area of ``_surface``.
_AREA = "sqrt(a*a + b*b + c*c) * sqrt(o*o + p*p + q*q) * w * (w if y == 0 or y == 4 else l)"
_AREA_PATHS = {"w": "data.size", "l": "data.size_y", "y": "data.shape"} | {
    name: f"matrix_world[{row}][{channel}]"
    for row, names in enumerate(("abc", "opq"))
    for channel, name in enumerate(names)
}
_RADIUS = "n + (1 - n) * (4 * pi * r * r if r > 0 else 4)", {"r": "data.shadow_soft_size"}
_SURFACES = {
    "SUN": ("n + (1 - n) * (pi * pow(sin(a / 2), 2) if a > 0 else 1)", {"a": "data.angle"}),
    "POINT": _RADIUS,
    "SPOT": _RADIUS,
    "RECTANGLE": (f"pow({_AREA}, 1 - n)", _AREA_PATHS),
    "ELLIPSE": (f"pow({_AREA} * pi / 4, 1 - n)", _AREA_PATHS),
}
_HALF_SPREAD = f"(max(v, {SMALLEST_SPREAD}) / 2)"
_BALL = ("v", "data.shadow_soft_size"), ("v", "data.use_soft_falloff")
_CONE = ("v", "data.spot_size"), ("v", "data.spot_blend")
_SPREAD = (
    (f"1 / tan({_HALF_SPREAD})", "data.spread"),
    (f"1 / (1 - {_HALF_SPREAD} / tan({_HALF_SPREAD}))", "data.spread"),
)
_SHAPES = {  # (kind, sized) -> of each number of ``shape``, the driver's expression and what v is
    ("SUN", True): (("v", "data.angle"),),
    ("POINT", True): _BALL,
    ("SPOT", False): _CONE,
    ("SPOT", True): (*_CONE, *_BALL),
    **{(area, True): _SPREAD for area in AREAS},
}


def _drive(light: Light, array: str, index: int, expression: str, paths: dict[str, str]) -> Any:
    driver = light.scene.driver_add(f'["{RIG}"]["{light.slot.entry(array)}"]', index).driver
    driver.type = "SCRIPTED"
    for name, path in paths.items():
        _object_variable(driver, name, light.item, path, 0.0)
    driver.expression = expression
    return driver


def _object_variable(driver: Any, name: str, item: Object, path: str, fallback: float) -> None:
    variable = driver.variables.new()
    variable.name = name
    target = variable.targets[0]
    target.id_type, target.id, target.data_path = "OBJECT", item, path
    target.use_fallback_value, target.fallback_value = True, fallback  # when the object is deleted


def _context_variable(driver: Any, name: str, path: str) -> None:
    variable = driver.variables.new()
    variable.name, variable.type = name, "CONTEXT_PROP"
    target = variable.targets[0]
    target.context_property, target.data_path = "ACTIVE_VIEW_LAYER", path
    target.use_fallback_value, target.fallback_value = True, -1.0  # not in this view layer
