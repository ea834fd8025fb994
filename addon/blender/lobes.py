# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes of materials at a point of a scene: where the light is from there, and the surface to draw."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from itertools import count
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from mathutils import Matrix, Vector

from ..reference import lobe, rendered
from . import material, texel

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import Material, Object

    from ..library.preset import Preset
    from ..measured.curves import Numbers
    from ..reference.directions import Floats
    from ..reference.lobe import Lobe

    Uvs = dict[str, tuple[float, float]]

T = TypeVar("T")
BRDF = "f"  # the whole, beside the terms "D", "G" and "F"
KINDS = {lobe.PLANE: "polar", lobe.ACROSS: "polar", lobe.ALBEDO: "albedo", lobe.THETA_H: "theta_h"}  # of curves
MOST_KEPT = 64  # lobes and curves: of two materials, under the lights of several viewports
DIGITS = 7  # of a direction; Blender's matrices hold float32
NODES = 32, 48  # of the albedo's quadrature
FARTHEST = 0.9  # cosine: an axis that is nearer to the normal gives no tangent


def frame(point: Sequence[float], normal: Sequence[float], tangent: Sequence[float] = (1.0, 0.0, 0.0)) -> Matrix:
    """From the local frame at a point, whose z axis is the normal, into the world.

    The x axis is ``tangent`` as far as it lies in the surface, or the world's Y axis where it is along the normal.
    """
    z = Vector(normal).normalized()
    along = Vector(tangent).normalized()
    if abs(along.dot(z)) > FARTHEST:
        along = Vector((0.0, 1.0, 0.0)) if abs(z.y) <= FARTHEST else Vector((0.0, 0.0, 1.0))
    x = (along - along.dot(z) * z).normalized()
    y = z.cross(x)
    rows = [[*axes, place] for axes, place in zip(zip(x, y, z, strict=True), point, strict=True)]
    return Matrix([*rows, [0.0, 0.0, 0.0, 1.0]])


def toward(lamp: Object, point: Sequence[float]) -> Vector:
    """To a light from a point, in world; a sun is as far away along its own Z axis everywhere."""
    if lamp.data.type == "SUN":
        return lamp.matrix_world.col[2].to_3d().normalized()
    return (lamp.matrix_world.translation - Vector(point)).normalized()


def aimed(at: Matrix, radius: float, start: Vector, direction: Vector) -> tuple[float, float]:
    """theta, at most a right angle, and phi of where a ray in world meets a ball of ``radius`` around the point.

    Of a ray that passes by, where it is nearest.
    """
    back = at.inverted()
    near, along = back @ start, (back.to_3x3() @ direction).normalized()
    ahead = -near.dot(along)
    beside = near + ahead * along
    depth = max(radius**2 - beside.length_squared, 0.0) ** 0.5
    hit = beside - depth * along
    return float(np.arctan2(np.hypot(hit.x, hit.y), max(hit.z, 0.0))), float(np.arctan2(hit.y, hit.x))


def local(direction: Vector, at: Matrix) -> Floats:
    """A direction of the world in the frame ``at``, of unit length to float64's digits."""
    w = np.array(at.to_3x3().transposed() @ direction, dtype=np.float64)
    w = np.round(w / np.linalg.norm(w), DIGITS)
    return w / np.linalg.norm(w)


@dataclass(frozen=True)
class _Seen:
    """A material as it was seen last: its preset, f and terms by name, and a number of its own."""

    preset: Preset
    brdfs: dict[str, Any]
    isotropic: bool
    mirrors: bool  # whether it also reflects into a single direction, which f does not hold
    number: int


_seen: dict[int, _Seen] = {}  # by the material's session_uid
_numbers = count()
_results: OrderedDict[tuple[Any, ...], Any] = OrderedDict()


def of_material(of: Material, wi: Floats, times: str = "one", term: str = BRDF, uvs: Uvs | None = None) -> Lobe | None:
    """The lobe of a material as it is now; None without the term, and where the light is below the surface.

    Numbers are those of the material's inputs; with ``uvs`` those that textures give there. MaterialError if it was not
    made by vgroove.
    The same material under the same light gives the same object.
    """

    def evaluated(seen: _Seen) -> Lobe:
        return lobe.lobe(seen.brdfs[term], wi, times, isotropic=seen.isotropic)

    return _kept(of, (wi, "", uvs), times, term, evaluated)


def curve_of(
    of: Material, wi: Floats, plot: str, times: str = "one", term: str = BRDF, uvs: Uvs | None = None
) -> Numbers | None:
    """What a plot, one of ``lobe.PLOTS``, shows of a material under the light of ``of_material``; its name is "".

    The albedo is that of the whole f, by a quadrature that is quick and good to 0.003; None of what also mirrors in one
    direction.
    """
    from ..measured import curves  # here, as Blender imports this file when it starts
    from ..measured.summary import reflected

    def curve(seen: _Seen) -> Numbers | None:
        if plot == lobe.ALBEDO and seen.mirrors:
            return None
        theta, phi = np.degrees([np.arctan2(np.hypot(wi[0], wi[1]), wi[2]), np.arctan2(wi[1], wi[0])])
        view = curves.View(theta, phi, 90.0 if plot == lobe.ACROSS else 0.0, times=times)
        whole = seen.brdfs[BRDF]

        def albedo(wo: Floats) -> Floats:
            return np.stack(
                [
                    weight @ whole(there, one)
                    for one, (there, weight) in zip(wo, (reflected(w, NODES) for w in wo), strict=True)
                ]
            )

        return curves.PLOTS[KINDS[plot]]({"": curves.Plotted(seen.brdfs[term], albedo)}, view)

    return _kept(of, (wi, plot, uvs), times, term, curve)


def _kept(
    of: Material, at: tuple[Floats, str, Uvs | None], times: str, term: str, evaluated: Callable[[_Seen], T]
) -> T | None:
    wi, plot, uvs = at
    preset = preset_of(of, uvs)
    seen = _seen.get(of.session_uid)
    if seen is None or seen.preset != preset:
        from ..measured import curves  # here, as Blender imports this file when it starts

        model = preset.reference()
        brdfs = {BRDF: rendered(model, "direct"), **lobe.terms(model)}
        seen = _seen[of.session_uid] = _Seen(
            preset, brdfs, lobe.is_isotropic(model), curves.plotted(model).mirrors, next(_numbers)
        )
    if term not in seen.brdfs or wi[2] <= 0.0:
        return None
    key = (plot, seen.number, *wi.tolist(), times, term)
    if key not in _results:
        _results[key] = evaluated(seen)
        while len(_results) > MOST_KEPT:
            _results.popitem(last=False)
    _results.move_to_end(key)
    return _results[key]


def preset_of(of: Material, uvs: Uvs | None) -> Preset:
    """What a material of ours is now, at a point of it where ``uvs`` are given."""
    preset = material.origin_of(of).preset
    values = texel.read(of, uvs).values if uvs else {}
    return replace(preset, parameters=preset.parameters | values) if values else preset


def has_term(of: Material, term: str, uvs: Uvs | None = None) -> bool:
    """Whether a material of ours has a term, or the whole. ValueError if its numbers do not go together."""
    model = preset_of(of, uvs).reference()
    return term == BRDF or bool(lobe.terms(model))


def forget() -> None:
    """All that is kept."""
    _seen.clear()
    _results.clear()
    texel.forget()
