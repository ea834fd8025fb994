# SPDX-License-Identifier: GPL-3.0-or-later
"""From linear Rec.709, which presets are in, to the working space of the open file, and back.

Blender 5 files may render in Rec.2020 or ACEScg, where the same light has other numbers: c' = M c for a colour c. What
a number means decides how it is converted, for what Cycles computes with the new numbers to be M times what it computes
with the old ones:

- Colours (f0, albedo, tint, reflectance) by M: exact. Oren-Nayar's small interreflection term, in albedo^2, is not.
- f82_tint together with its f0, by what both reflect at 82 degrees: exact, as F82 is linear in that.
- n and k of a conductor: those that reflect M times as much head-on and at 82 degrees. Between, F of the shipped metals
  is off by at most 0.008, in the median by 0.0006.
- absorption: a sum of exponentials is no exponential, so each channel is exact where it has lost 1 - 1/e of what it can
  lose. Glass whose channels differ tenfold is off by up to 0.25 of the light elsewhere; the median is 0.035.
- mean_free_path: the mean of the channels' by what each contributes to the new channel's reflectance.

Grey stays as it is. The rows of M are weights (not below 0, sum 1) for every space that holds Rec.709, so forward
nothing leaves its range; on the way back a colour outside Rec.709 is clipped to what a preset may hold. In a Rec.709
file, as all of Blender 4.5's are, nothing is touched.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from mathutils import Color

from ...nodegroups import versions
from ..models import base_name, parameter
from ..reference.fresnel import F82_COSINE, fresnel_conductor, schlick
from ..reference.keyframes import Keyframes
from ..reference.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from bpy.types import Material
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

KEY = "vgroove_space"  # custom property of a material: the matrix of the space that its numbers are in; none in Rec.709
REC709 = np.eye(3)
OF_REC709 = "lin_rec709"  # what EXR files call it
SAME = 1e-5  # two matrices that differ by less are one: Blender's own differ by 1e-6 from what they stand for
UNCHANGED = 2e-4  # of the greatest channel: Blender converts colours by other digits of M than it tells, 6e-5 apart
EDGE = float(np.cos(np.radians(82.0)))  # where n and k of presets are fitted, beside head-on
PARTNERS = {"f82_tint": "f0", "n": "k", "k": "n", "mean_free_path": "reflectance"}  # what is converted together
HIGHEST_F0 = 0.9999  # of a conductor, beyond which its n and k have no bounds
MATCHED_SHARE = float(np.exp(-1.0))  # of the absorbable light: at the depth where this is left, conversion is exact


def matrix() -> Floats:
    """M (3, 3): linear Rec.709 to the open file's working space; exactly the identity where they are the same."""
    columns = [Color(channel).from_rec709_linear_to_scene_linear() for channel in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    M = np.array([tuple(column) for column in columns], dtype=np.float64).T
    return REC709 if is_same(M, REC709) else M / M.sum(axis=1, keepdims=True)  # white stays white


def name() -> str:
    """What EXR files call the open file's working space; empty where it has no such name."""
    if is_same(matrix(), REC709):
        return OF_REC709
    return versions.working_space()


def is_same(a: Floats, b: Floats) -> bool:
    """Whether two matrices stand for one working space."""
    return bool(np.abs(a - b).max() < SAME)


def of(material: Material) -> Floats:
    """The matrix of the space that a material's numbers are in."""
    kept = material.get(KEY)
    return REC709 if kept is None else np.array(kept, dtype=np.float64).reshape(3, 3)


def mark(material: Material) -> None:
    """Note on a material that its numbers are in the open file's space."""
    M = matrix()
    if is_same(M, REC709):
        if KEY in material:
            del material[KEY]
    else:
        material[KEY] = M.ravel().tolist()


def colour(value: ArrayLike, M: Floats) -> Floats:
    """A linear Rec.709 colour (..., 3) in the space of ``M``; grey stays as it is."""
    rgb = np.asarray(value, dtype=np.float64)
    return np.where(_is_grey(rgb), rgb, rgb @ M.T)


def to_rec709(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """A picture (..., 3) in the open file's working space, in linear Rec.709, unclipped."""
    M = matrix()
    return picture if is_same(M, REC709) else (picture @ np.linalg.inv(M).T).astype(np.float32)


def is_stale(material: Material) -> bool:
    """Whether a material's numbers are in another space than the open file's."""
    return not is_same(of(material), matrix())


def to_space(values: Mapping[str, Any], M: Floats) -> dict[str, Any]:
    """A preset's parameters, linear Rec.709, as the numbers of the space of ``M``. RGB has shape (3,) or (..., 3)."""
    if is_same(M, REC709):
        return dict(values)
    if all(
        isinstance(of, float | tuple) for of in values.values()
    ):  # one material's, which panels ask for at each draw
        return dict(_one_to_space(tuple(values.items()), tuple(M.ravel().tolist())))
    return _convert(values, M, _absorption)


@lru_cache(maxsize=1024)
def _one_to_space(values: tuple[tuple[str, Any], ...], M: tuple[float, ...]) -> dict[str, Any]:
    return _convert(dict(values), np.array(M).reshape(3, 3), _absorption)


def from_space(values: Mapping[str, Any], M: Floats) -> dict[str, Any]:
    """The parameters whose ``to_space`` is ``values``, held within what a preset may have."""
    return dict(values) if is_same(M, REC709) else _convert(values, np.linalg.inv(M), _absorption_back)


def read(values: Mapping[str, Any], built: Mapping[str, Any], M: Floats) -> dict[str, Any]:
    """``from_space`` of what a material holds; what nobody changed since it was built of ``built`` is that again."""
    if is_same(M, REC709):
        return dict(values)
    written = to_space(built, M)
    edited = {name for name in values if not is_unchanged(values[name], written.get(name))}
    affected = {
        name: _dependencies(name, values) for name in values if not edited.isdisjoint(_dependencies(name, values))
    }
    needed = {one: values[one] for together in affected.values() for one in together}
    back = from_space(needed, M)
    return {name: back[name] if name in affected else built[name] for name in values}


def is_unchanged(value: Any, written: Any) -> bool:
    """Whether ``value`` is what was written, but for rounding."""
    if written is None:
        return False
    return bool(np.abs(np.subtract(value, written)).max() <= UNCHANGED * np.abs(written).max() + 1e-7)


def as_blender(value: ArrayLike, T: Floats) -> Floats:
    """What Blender itself makes of a colour as it changes the file's space by ``T``: clipped where T may leave 0..1."""
    rgb = np.asarray(value, dtype=np.float64) @ T.T
    return np.clip(rgb, 0.0, 1.0) if float(np.min(T)) < -SAME else rgb


def course(laws: Trajectory, parameters: Mapping[str, Any], M: Floats) -> Trajectory:
    """A preset's course in the space of ``M``; ``parameters``: those that stand still too."""
    if is_same(M, REC709):
        return laws
    return Trajectory({name: _Converted(laws, name, dict(parameters), M) for name in laws.laws}, laws.start, laws.end)


@dataclass(frozen=True)
class _Converted:
    """A parameter's law in the space of ``M``."""

    laws: Trajectory
    name: str
    parameters: dict[str, Any]
    M: Floats

    def __call__(self, t: ArrayLike) -> Floats:
        now: dict[str, Any] = {}
        for name in _dependencies(self.name, self.parameters):
            now[name] = self.laws.value(name, t) if name in self.laws.laws else self.parameters[name]
        return np.asarray(to_space(now, self.M)[self.name])

    def events(self) -> Floats:
        together = [name for name in _dependencies(self.name, self.parameters) if name in self.laws.laws]
        return np.concatenate([self.laws.laws[name].events() for name in together])


def courses(keys: Mapping[str, Keyframes], still: Mapping[str, Any], M: Floats) -> dict[str, Keyframes]:
    """What plays in the space of ``M``, in Rec.709; ``still``: the numbers, in the space too, of what does not move."""
    if is_same(M, REC709):
        return dict(keys)
    return {name: convert_keys(name, keys, still, partial(from_space, M=M)) for name in keys}


def convert_keys(
    name: str, keys: Mapping[str, Keyframes], still: Mapping[str, Any], convert: Callable[..., dict[str, Any]]
) -> Keyframes:
    """The keys of one parameter, converted with those of its partner at the same times."""
    times = keys[name].times
    now = {one: keys[one](times) if one in keys else still[one] for one in _dependencies(name, still)}
    return Keyframes(times, np.asarray(convert(now)[name]))


def _dependencies(name: str, known: Mapping[str, Any]) -> list[str]:
    """A parameter and what its conversion depends on."""
    base = base_name(name)
    partner = PARTNERS.get(base, base) + name.removeprefix(base)
    return list(dict.fromkeys(one for one in (name, partner) if one in known))


def _convert(values: Mapping[str, Any], M: Floats, absorption: Any) -> dict[str, Any]:
    result = dict(values)
    index: tuple[Floats, Floats] | None = None  # no model has two conductors
    for name, value in values.items():
        base = base_name(name)
        if not parameter(base).is_rgb or np.ndim(value) == 0:
            continue
        of_lobe = name.removeprefix(base)
        rgb = np.asarray(value, dtype=np.float64)
        if base == "f82_tint":
            new, grey = _edge_tint(np.asarray(values["f0" + of_lobe], dtype=np.float64), rgb, M)
        elif base in {"n", "k"}:
            n, k = (np.asarray(values[part + of_lobe], dtype=np.float64) for part in "nk")
            grey = _is_grey(n) & _is_grey(k)
            index = index or _index(n, k, M)
            new = index["nk".index(base)]
        elif base == "mean_free_path":
            weight = np.asarray(values["reflectance"], dtype=np.float64)
            total = np.maximum(weight @ M.T, 1e-9)
            new, grey = ((weight * rgb) @ M.T) / total, _is_grey(rgb)
        elif base == "absorption":
            new, grey = np.apply_along_axis(absorption, -1, rgb, M), _is_grey(rgb)
        else:
            new, grey = rgb @ M.T, _is_grey(rgb)
        held = np.clip(new, parameter(base).low, parameter(base).high)
        converted = np.where(grey, rgb, held)
        result[name] = tuple(converted.tolist()) if converted.ndim == 1 else converted
    return result


def _is_grey(rgb: Floats) -> NDArray[np.bool_]:
    return (rgb[..., :1] == rgb[..., 1:]).all(axis=-1, keepdims=True)


def _edge_tint(f0: Floats, tint: Floats, M: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    at_edge = schlick(F82_COSINE, np.clip(f0, 0.0, 1.0)) * tint
    head_on = np.clip(np.where(_is_grey(f0), f0, f0 @ M.T), 0.0, 1.0)
    return (at_edge @ M.T) / schlick(F82_COSINE, head_on), _is_grey(f0) & _is_grey(tint)


def _index(n: Floats, k: Floats, M: Floats) -> tuple[Floats, Floats]:
    """n and k whose F is M times that of ``n`` and ``k`` head-on and, as near as it can be, at 82 degrees.

    All n, k of one reflectance R head-on lie on a circle: centre (1 + R) / (1 - R) on the n axis, radius
    2 sqrt(R) / (1 - R). Along it, from least to greatest n, F at 82 degrees falls.
    """
    R = np.clip(fresnel_conductor(1.0, n, k) @ M.T, 0.0, HIGHEST_F0)
    edge = fresnel_conductor(EDGE, n, k) @ M.T
    centre, radius = (1.0 + R) / (1.0 - R), 2.0 * np.sqrt(R) / (1.0 - R)

    def on_circle(turn: Floats) -> tuple[Floats, Floats]:
        return np.maximum(centre - radius * np.cos(turn), 0.0), np.maximum(radius * np.sin(turn), 1e-12)

    low, high = np.zeros_like(R), np.full_like(R, np.pi)
    for _ in range(48):  # halvings: to 1e-14 of a turn
        middle = 0.5 * (low + high)
        falls = fresnel_conductor(EDGE, *on_circle(middle)) > edge
        low, high = np.where(falls, middle, low), np.where(falls, high, middle)
    return on_circle(0.5 * (low + high))


def _absorption(a: Floats, M: Floats) -> Floats:
    """Of each channel the a' with which exp(-a' d) is exact at the depth d where it has lost 1 - 1/e of what it can."""
    greatest = float(np.max(a))
    if greatest == 0.0 or float(np.min(M)) < -SAME:
        return np.maximum(M @ a, 0.0)
    scaled = np.where(a > 1e-6 * greatest, a / greatest, 0.0)
    limit = M[:, scaled == 0.0].sum(axis=1)
    target = limit + (1.0 - limit) * MATCHED_SHARE
    d = np.zeros(3)
    for _ in range(100):  # Newton from the left of a falling convex function never passes the root
        left = M * np.exp(-scaled * d[:, None])
        d += (left.sum(axis=1) - target) / np.maximum((left * scaled).sum(axis=1), 1e-300)
    return -np.log(target) / d * greatest


def _absorption_back(a: Floats, inverse: Floats) -> Floats:
    """The absorption that ``_absorption`` makes ``a`` of, by trial: each round corrects every channel by its ratio."""
    M = np.linalg.inv(inverse)
    found = np.array(a)
    for _ in range(100):
        found *= np.where(a > 0.0, a, 0.0) / np.maximum(_absorption(found, M), 1e-300)
    return found
