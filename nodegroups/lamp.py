# SPDX-License-Identifier: GPL-3.0-or-later
"""What a light sends to the shaded point, by the numbers that the scene tells of it.

Cycles' units: a sun's strength is its irradiance in W/m^2 across the beam; a point or spot of power P in W gives
P / (4 pi d^2) at distance d, as if it shone evenly in all directions (the spot's cone does not concentrate it).

A lamp with a size is met at one random point for each sample. Its irradiance is divided by the density of that point,
so that the mean over samples is what the whole lamp sends; what is left of the formulas is free of the lamp's area:

    sun          a disc of radiance E / (pi sin^2 a), a half its angle, drawn evenly by solid angle: 2 E / (1 + cos a)
    point, spot  a ball of radiance P / (4 pi^2 r^2), drawn evenly by solid angle: P / (2 pi d^2 (1 + cos b)),
                 sin b = r / d; from inside, all around: P / (pi r^2), and no spot cone there. With soft falloff the
                 lamp is a disc that faces the shaded point: d^2 + r^2 in place of d^2, sin^2 b = r^2 / (d^2 + r^2)
    area         radiance P / (pi A) of one side, drawn evenly by area: P cos(c) / (pi d^2), c at the lamp; a spread of
                 less than 180 degrees hides tan(c) / tan(spread / 2) of it and makes up for that by Gain. Only the
                 part of the lamp that a spread does not hide is drawn from
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import pi
from typing import TYPE_CHECKING, Any

from . import ensure, osl_script, versions
from ._tree import (
    Tree,
    Value,
    clamp,
    cos,
    cross,
    dot,
    length,
    less,
    maximum,
    minimum,
    normalize,
    output,
    scale,
    select,
    sin,
    sqrt,
    tangents,
    vector,
)
from .random_numbers import random_numbers, stream

if TYPE_CHECKING:
    from bpy.types import Node

REVISION = 5
AREAS = ("RECTANGLE", "ELLIPSE")
KINDS = ("SUN", "POINT", "SPOT", *AREAS)
RIG = "vgroove_lights"  # custom property of a scene that tells of its lights (addon/blender/lamps.py)


@dataclass(frozen=True)
class Slot:
    """Where a scene's rig has a light: the ``number``-th of its kind, from 1.

    sized: an angle or a radius above 0, as area lights always have. shadows: whether the light casts any.
    """

    kind: str
    sized: bool
    shadows: bool
    number: int

    def __str__(self) -> str:
        """Such as "SUN sized 1", "SPOT unshadowed 2"."""
        return " ".join([self.kind, *["sized"] * self.sized, *["unshadowed"] * (not self.shadows), str(self.number)])

    def entry(self, array: str) -> str:
        """The name of one of its arrays in the rig."""
        return f"{self} {array}"

    def arrays(self) -> dict[str, int]:
        """The arrays that the rig has of it, with their lengths.

        color: linear RGB and strength (W/m^2 or W). axis: its own z axis. place: metres. across, up: an area light's
        edges, metres. shape: as ``_SHAPES`` has it.
        """
        found = {"color": 4}
        if self.kind != "POINT":
            found["axis"] = 3
        if self.kind != "SUN":
            found["place"] = 3
        if self.kind in AREAS:
            found |= {"across": 3, "up": 3}
        if (self.kind, self.sized) in _SHAPES:
            found["shape"] = 4
        return found


_SHAPES = {  # the inputs of a lamp group that the numbers of ``shape`` are for
    ("SUN", True): ("Angle",),
    ("POINT", True): ("Radius", "Soft Falloff"),
    ("SPOT", False): ("Size", "Blend"),
    ("SPOT", True): ("Size", "Blend", "Radius", "Soft Falloff"),
    **{(area, True): ("Grid", "Gain") for area in AREAS},
}


def name(kind: str, *, shadows: bool, sized: bool = False) -> str:
    """``sized``: for a sun with an angle, a point or spot with a radius; area lamps always are."""
    parts = [f".VGroove {kind.title()} Lamp", *["sized"] * (sized and kind not in AREAS), *["shadows"] * shadows]
    return ", ".join(parts)


def can_cast_shadows() -> bool:
    """Whether this Blender's shader nodes can trace a ray."""
    return versions.RAYCAST


def interface(tree: Tree, kind: str, *, sized: bool = False) -> dict[str, Value]:
    """Inputs by the parameter names of ``osl/lamp.osl``."""
    inputs = {
        "Colour": tree.input_color("Color", (1, 1, 1), tip="The lamp's colour with its temperature, linear RGB"),
        "Strength": tree.input_float(
            "Strength", 0.0, low=-1e30, high=1e30, tip="Sun: W/m^2; others: W. With exposure; 0 when hidden"
        ),
    }
    if kind != "POINT":
        inputs["Axis"] = tree.input_vector(
            "Axis", (0, 0, 1), tip="The lamp's own z axis in world space; it shines against it"
        )
    if kind != "SUN":
        inputs["Position"] = tree.input_vector("Position", tip="Of the lamp in world space, metres")
    if kind == "SPOT":
        inputs["Size"] = tree.input_float(
            "Size", pi / 4, low=0.0, high=pi, subtype="ANGLE", tip="Full angle of the cone"
        )
        inputs["Blend"] = tree.input_float("Blend", 0.15, low=0.0, high=1.0, tip="Softness of the cone's edge")
    return inputs | (_size_interface(tree, kind) if sized or kind in AREAS else {})


def _size_interface(tree: Tree, kind: str) -> dict[str, Value]:
    inputs = {}
    if kind == "SUN":
        inputs["Angle"] = tree.input_float(
            "Angle", 0.0, low=0.0, high=pi, subtype="ANGLE", tip="Angle across the sun's disc"
        )
    elif kind in AREAS:
        inputs["Across"] = tree.input_vector("Across", (1, 0, 0), tip="From edge to edge along the lamp's x, metres")
        inputs["Up"] = tree.input_vector("Up", (0, 1, 0), tip="From edge to edge along the lamp's y, metres")
        inputs["Grid"] = tree.input_float(
            "Grid", 0.0, low=-1e30, high=1e30, tip="Cotangent of half the spread, which hides what leaves at a slant"
        )
        inputs["Gain"] = tree.input_float(
            "Gain", 1.0, low=0.0, high=1e30, tip="By how much the rest is brighter, so that a spread keeps the power"
        )
    else:
        inputs["Radius"] = tree.input_float("Radius", 0.0, low=0.0, high=1e30, tip="Of the lamp, metres")
        inputs["Soft"] = tree.input_float(
            "Soft Falloff", 0.0, low=0.0, high=1.0, tip="1: a disc that faces what it lights; 0: a ball"
        )
    inputs["Stream"] = tree.input_float(
        "Stream", stream("LIGHT"), low=0.0, high=40.0, tip="Random numbers of its own for each lamp"
    )
    return inputs


@dataclass(frozen=True)
class Beam:
    """Direction to the lamp, distance (None: no end) and irradiance across the beam, before colour and shadow."""

    wi: Value
    distance: Value | None
    irradiance: Value


def build(tree: Tree, kind: str, *, shadows: bool, sized: bool = False) -> None:
    inputs = interface(tree, kind, sized=sized)
    if kind in AREAS:
        beam = _area(tree, inputs, kind)
    elif kind == "SUN":
        beam = _sun_disc(tree, inputs) if sized else Beam(normalize(inputs["Axis"]), None, inputs["Strength"])
    else:
        beam = (_ball if sized else _point)(tree, inputs, kind)
    irradiance = beam.irradiance
    if shadows:
        irradiance = irradiance * _unblocked(tree, beam.wi, beam.distance)
    tree.output_vector("To Lamp", beam.wi, tip="Direction to the lamp")
    tree.output_color("Irradiance", scale(inputs["Colour"], irradiance), tip="W/m^2 across the beam")


def build_osl(tree: Tree, kind: str, *, shadows: bool, sized: bool = False) -> None:
    inputs = interface(tree, kind, sized=sized)
    drawn = sized or kind in AREAS
    more = {} if drawn else {"seed": 0.0}
    node = osl_script.script(
        tree, "lamp", kind=KINDS.index(kind), sized=int(drawn), shadows=int(shadows), **inputs, **more
    )
    tree.output_vector("To Lamp", osl_script.output(tree, node, "ToLamp"), tip="Direction to the lamp")
    tree.output_color("Irradiance", osl_script.output(tree, node, "Irradiance"), tip="W/m^2 across the beam")


def build_slot(tree: Tree, slot: Slot, *, shadows: bool, osl: bool) -> None:
    """A light of the scene that is rendered, as its rig tells of it; nothing where the rig has no such light."""
    variant: dict[str, Any] = {"kind": slot.kind, "shadows": shadows, "sized": slot.sized}
    make = build_osl if osl else build
    group = ensure(name(**variant) + " (OSL)" * osl, REVISION, partial(make, **variant))
    tip = "Random numbers of its own for each light"
    drawn = {"Stream": tree.input_float("Stream", stream("LIGHT"), low=0.0, high=40.0, tip=tip)} if slot.sized else {}
    with tree.frame("What the scene tells of the light"):
        node = tree.group(group, **drawn)
        read = {array: _attribute(tree, slot.entry(array)) for array in slot.arrays()}
        links = {"Color": output(read["color"], "Color"), "Strength": output(read["color"], "Alpha")}
        sockets = {"axis": "Axis", "place": "Position", "across": "Across", "up": "Up"}
        links |= {socket: output(read[array], "Vector") for array, socket in sockets.items() if array in read}
        if "shape" in read:
            apart = tree.node("ShaderNodeSeparateXYZ", Vector=Value(tree, output(read["shape"], "Vector")))
            numbers = (*(output(apart, name) for name in "XYZ"), output(read["shape"], "Alpha"))
            links |= dict(zip(_SHAPES[slot.kind, slot.sized], numbers, strict=False))
        for socket, source in links.items():
            tree.node_tree.links.new(source, node.inputs[socket])
    tree.output_vector("To Lamp", Value(tree, node.outputs["To Lamp"]), tip="Direction to the light")
    tree.output_color("Irradiance", Value(tree, node.outputs["Irradiance"]), tip="W/m^2 across the beam")


def _attribute(tree: Tree, entry: str) -> Node:
    return tree.node("ShaderNodeAttribute", attribute_type="VIEW_LAYER", attribute_name=f'["{RIG}"]["{entry}"]')


def _point(tree: Tree, inputs: dict[str, Value], kind: str) -> Beam:
    with tree.frame("Irradiance P / (4 pi d^2)"):
        offset = inputs["Position"] - tree.geometry("Position")
        wi, distance = normalize(offset), length(offset)
        irradiance = inputs["Strength"] / (4.0 * pi * distance * distance)
    if kind == "SPOT":
        irradiance = irradiance * _cone(tree, inputs, wi)
    return Beam(wi, distance, irradiance)


def _sun_disc(tree: Tree, inputs: dict[str, Value]) -> Beam:
    u1, u2, _ = random_numbers(tree, inputs["Stream"])
    with tree.frame("A direction in the disc; irradiance 2 E / (1 + cos a)"):
        deep = 2.0 * sin(inputs["Angle"] * 0.25) ** 2
        wi = _in_cone(normalize(inputs["Axis"]), u1 * deep, u2)
        return Beam(wi, None, inputs["Strength"] / (1.0 - 0.5 * deep))


def _ball(tree: Tree, inputs: dict[str, Value], kind: str) -> Beam:
    u1, u2, _ = random_numbers(tree, inputs["Stream"])
    with tree.frame("Cone that holds the lamp: (1 - cos b) / r^2"):
        offset = inputs["Position"] - tree.geometry("Position")
        d, r2 = length(offset), inputs["Radius"] ** 2
        reach2 = d * d + inputs["Soft"] * r2
        inside = less(reach2, r2)
        seen = 1.0 / (reach2 * (1.0 + sqrt(1.0 - minimum(r2 / reach2, 1.0))))
        share = select(inside, 2.0 / r2, seen)
    with tree.frame("A direction in it; irradiance P (1 - cos b) / (2 pi r^2)"):
        deep = u1 * r2 * share
        wi = _in_cone(normalize(offset), deep, u2)
        irradiance = inputs["Strength"] * share / (2.0 * pi)
    with tree.frame("Distance to the lamp's surface"):
        along = d * (1.0 - deep)
        half_chord = sqrt(maximum(r2 - d * d * deep * (2.0 - deep), 0.0))
        ball = along + half_chord * (2.0 * inside - 1.0)
        distance = select(inputs["Soft"], d / (1.0 - deep), ball)
    if kind == "SPOT":
        irradiance = irradiance * maximum(_cone(tree, inputs, wi), inside)
    return Beam(wi, distance, irradiance)


def _area(tree: Tree, inputs: dict[str, Value], kind: str) -> Beam:
    u1, u2, _ = random_numbers(tree, inputs["Stream"])
    P = tree.geometry("Position")
    axis = normalize(inputs["Axis"])
    with tree.frame("What of the lamp the spread leaves: a rectangle about the foot of the perpendicular"):
        behind = P - inputs["Position"]
        reach = dot(axis, -behind) / maximum(inputs["Grid"], 1e-6)
        u, width = _cut(inputs["Across"], behind, reach, u1)
        v, height = _cut(inputs["Up"], behind, reach, u2)
        share = width * height
    if kind == "ELLIPSE":
        with tree.frame("The ellipse if it is smaller, else only points of it"):
            radius, phi = 0.5 * sqrt(u1), 2.0 * pi * u2
            narrow = less(share, pi / 4.0)
            share = select(narrow, share * less(u * u + v * v, 0.25) * (4.0 / pi), 1.0)
            u, v = select(narrow, u, radius * cos(phi)), select(narrow, v, radius * sin(phi))
    with tree.frame("Irradiance P (cos c - sin c / tan(spread / 2)) / (pi d^2)"):
        offset = scale(inputs["Across"], u) + scale(inputs["Up"], v) - behind
        wi, distance = normalize(offset), length(offset)
        front = maximum(dot(axis, wi), 0.0)
        passed = maximum(front - inputs["Grid"] * length(cross(axis, wi)), 0.0)
        irradiance = inputs["Strength"] * inputs["Gain"] * share * passed / (pi * distance * distance)
    return Beam(wi, distance, irradiance)


def _cut(edge: Value, behind: Value, reach: Value, u: Value) -> tuple[Value, Value]:
    """A place drawn by ``u`` where the lamp (-0.5 to 0.5 along ``edge``) is in reach, and the length of that part."""
    middle, half = dot(behind, edge) / dot(edge, edge), reach / length(edge)
    low, high = maximum(middle - half, -0.5), minimum(middle + half, 0.5)
    return low + u * (high - low), maximum(high - low, 0.0)


def _in_cone(axis: Value, deep: Value, u: Value) -> Value:
    """The direction at 1 - cosine = ``deep`` from the axis, turned about it by the random ``u``."""
    T, B = tangents(axis)
    across, phi = sqrt(deep * (2.0 - deep)), 2.0 * pi * u
    return normalize(scale(axis, 1.0 - deep) + scale(T, across * cos(phi)) + scale(B, across * sin(phi)))


def _cone(tree: Tree, inputs: dict[str, Value], wi: Value) -> Value:
    with tree.frame("Spot cone: smooth step of the cosine over the blend"):
        edge = tree.math("COSINE", inputs["Size"] * 0.5)
        inside = dot(normalize(inputs["Axis"]), wi) - edge
        step = clamp(inside / tree.math("MAXIMUM", (1.0 - edge) * inputs["Blend"], 1e-9))
        return step * step * (3.0 - 2.0 * step)


def _unblocked(tree: Tree, wi: Value, distance: Value | None) -> Value:
    with tree.frame("Shadow"):
        ray = tree.node("ShaderNodeRaycast")  # Position unlinked: an offset would leak or freckle
        # Linked through Combine XYZ: Cycles takes a Direction that it thinks unlinked for the normal.
        tree.wire(ray, "Direction", vector(*wi.xyz))
        tree.wire(ray, "Length", 1e9 if distance is None else distance)
        # On a shared edge the ray may hit the next triangle where it starts, give or take what float32 rounds P.
        start = 1e-6 * (1.0 + length(tree.geometry("Position")))
        beyond = less(start, Value(tree, output(ray, "Hit Distance")))
        return 1.0 - Value(tree, output(ray, "Is Hit")) * beyond
