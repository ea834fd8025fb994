# SPDX-License-Identifier: GPL-3.0-or-later
"""The fewest keys that play a law within a tolerance, placed where the law bends, whatever its rates.

Keys lie on the law: what a material is at a key it truly is at that time, and no key is outside the law's range.
Between keys the value goes straight, or by the cubic through both keys with handles at thirds ("shape").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from .directions import as_range
from .trajectory import Keys

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from .directions import Floats
    from .trajectory import Trajectory

Indices: TypeAlias = "NDArray[np.intp]"
Interpolation: TypeAlias = Literal["linear", "shape"]
TOLERANCE = 1e-3  # of a parameter's range, where none is asked for
TOLERANCES = (1e-6, 0.1)
FINE = 1024.0  # the law is sampled until chords between samples miss it by a FINE-th of the tolerance
COARSEST = 256  # samples at least, so that what happens between two events is found
DEEPEST = 40  # halvings of one of these: float64 has no more to give
WINDOW = 4096  # samples that one pair of keys may span


@dataclass(frozen=True)
class Keyframes:
    """times (n,), values (n,) or (n, 3), and for "shape" the values of the handles a third before and after each key.

    A parameter that does not move has one key.
    """

    times: Floats
    values: Floats
    before: Floats | None = None
    after: Floats | None = None

    def law(self) -> Keys:
        """The linear interpolation of the keys, as a law."""
        return Keys(self.times, self.values)

    def __call__(self, t: Floats) -> Floats:
        """Value at times t (...), as Blender plays the keys."""
        if self.before is None or self.after is None or self.times.size == 1:
            return self.law()(t)
        t = np.asarray(t, float)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, self.times.size - 2)
        u = np.clip((t - self.times[k]) / (self.times[k + 1] - self.times[k]), 0.0, 1.0)
        u = u[..., None] if self.values.ndim == 2 else u
        return bezier(self.values[k], self.after[k], self.before[k + 1], self.values[k + 1], u)


def bezier(a: Floats, b: Floats, c: Floats, d: Floats, u: Floats) -> Floats:
    """(1 - u)^3 a + 3 u (1 - u)^2 b + 3 u^2 (1 - u) c + u^3 d: within the least and greatest of the four."""
    v = 1.0 - u
    return v**3 * a + 3.0 * u * v**2 * b + 3.0 * u**2 * v * c + u**3 * d


def place_keys(
    trajectory: Trajectory, name: str, tolerance: float = TOLERANCE, interpolation: Interpolation = "linear"
) -> Keyframes:
    """The fewest keys of parameter ``name`` whose interpolation misses its law by at most ``tolerance`` of its range.

    The range is the largest that one of its channels runs through. "Fewest" is among keys at samples of the law, which
    are so dense that chords between them miss it by a 1024th of the tolerance; there the search is exact: the shortest
    path over all pairs of samples that a straight line may join. With "shape" each key is as far on as a cubic allows.

    tolerance in [1e-6, 0.1], ValueError otherwise. Handles that would leave the law's range are drawn in to it: a
    Bezier curve stays among its four points, so nothing overshoots.
    """
    as_range(tolerance, "tolerance", *TOLERANCES)

    def law(t: Floats) -> Floats:
        values = trajectory.value(name, t)
        return values if values.ndim == 2 else values[:, None]

    times, values = _samples(law, trajectory, name, tolerance)
    allowed = tolerance * float(np.max(np.ptp(values, axis=0)))
    scalar = trajectory.value(name, trajectory.start).ndim == 0
    if allowed <= 1e-15 * float(np.max(np.abs(values))):  # it stands still
        return Keyframes(times[:1], values[:1, 0] if scalar else values[:1])
    allowed *= 1.0 - 2.0 / FINE  # what chords between samples may add
    if interpolation == "linear":
        chosen = _fewest(times.size, lambda i: _straight(times, values, i, allowed))
        return Keyframes(times[chosen], values[chosen, 0] if scalar else values[chosen])
    return _shaped(times, values, allowed, scalar=scalar)


def _samples(
    law: Callable[[Floats], Floats], trajectory: Trajectory, name: str, tolerance: float
) -> tuple[Floats, Floats]:
    """Times and values (n, channels) so dense that a chord misses the law by a FINE-th of the tolerance."""
    start, end = trajectory.start, trajectory.end
    events = np.asarray(trajectory.laws[name].events(), float)
    times = np.unique(np.concatenate([np.linspace(start, end, COARSEST + 1), np.clip(events, start, end)]))
    values = law(times)
    for _ in range(DEEPEST):
        allowed = tolerance / FINE * float(np.max(np.ptp(values, axis=0)))
        middle = 0.5 * (times[:-1] + times[1:])
        found = law(middle)
        off = np.max(np.abs(found - 0.5 * (values[:-1] + values[1:])), axis=-1)
        new = (off > allowed) & (middle > times[:-1]) & (middle < times[1:])
        if not new.any():
            break
        order = np.argsort(np.concatenate([times, middle[new]]), kind="stable")
        times = np.concatenate([times, middle[new]])[order]
        values = np.concatenate([values, found[new]])[order]
    return times, values


def _straight(times: Floats, values: Floats, i: int, allowed: float) -> Indices:
    """Which samples j > i a straight line from i reaches without missing one between by more than ``allowed``.

    Each sample between asks of the line's slope that it pass within ``allowed``; those slopes that suit all are a cone.
    """
    j = slice(i + 1, i + 1 + WINDOW)
    t, rise = (times[j] - times[i])[:, None], values[j] - values[i]
    low, high = (
        np.maximum.accumulate((rise - allowed) / t, axis=0),
        np.minimum.accumulate((rise + allowed) / t, axis=0),
    )
    inside = ((rise / t >= low) & (rise / t <= high)).all(axis=-1)
    return i + 1 + np.flatnonzero(inside)


def _fewest(count: int, reach: Callable[[int], Indices]) -> list[int]:
    """The shortest way from sample 0 to the last over pairs that ``reach`` allows, as samples."""
    came_from = np.full(count, -1)
    front = [0]
    while came_from[-1] < 0:
        following: list[int] = []
        for i in front:
            reached = reach(i)
            new = reached[came_from[reached] < 0]
            came_from[new] = i
            following += new.tolist()
        front = sorted(following, reverse=True)  # the farthest first: later keys are then as far apart as can be
    way = [count - 1]
    while way[-1] != 0:
        way.append(int(came_from[way[-1]]))
    return way[::-1]


def _shaped(times: Floats, values: Floats, allowed: float, *, scalar: bool) -> Keyframes:
    """Keys with handles a third of the way: each as far from the one before as the cubic allows."""
    right, left = _slopes(times, values), -_slopes(-times[::-1], values[::-1])[::-1]
    low, high = values.min(axis=0), values.max(axis=0)

    def handles(i: int, j: int) -> tuple[Floats, Floats]:
        third = (times[j] - times[i]) / 3.0
        return np.clip(values[i] + right[i] * third, low, high), np.clip(values[j] - left[j] * third, low, high)

    def is_near(i: int, j: int) -> bool:
        u = ((times[i : j + 1] - times[i]) / (times[j] - times[i]))[:, None]
        return _farthest(values[i], *handles(i, j), values[j], u, values[i : j + 1]) <= allowed

    chosen, last = [0], times.size - 1
    before, after = [values[0]], []
    while chosen[-1] != last:
        i = chosen[-1]
        j, step = i + 1, 1
        while step:  # strides that double while they hold, then halve
            if j + step <= last and is_near(i, j + step):
                j, step = j + step, 2 * step
            else:
                step //= 2
        rise = (values[j] - values[i]) / 3.0  # straight where the law has a corner
        pair = handles(i, j) if is_near(i, j) else (values[i] + rise, values[j] - rise)
        after.append(pair[0])
        before.append(pair[1])
        chosen.append(j)
    after.append(values[last])
    parts = (values[chosen], np.array(before), np.array(after))
    return Keyframes(times[chosen], *(part[:, 0] if scalar else part for part in parts))


def _farthest(a: Floats, b: Floats, c: Floats, d: Floats, u: Floats, values: Floats) -> float:
    """The largest distance of a cubic from the polyline of ``values`` at ``u`` (n, 1).

    On each piece it is where the cubic's slope is the piece's, or at an end: a quadratic's roots, drawn into the piece.
    """
    slope = np.diff(values, axis=0) / np.diff(u, axis=0)
    square, linear, constant = 3.0 * (d - 3.0 * c + 3.0 * b - a), 6.0 * (a - 2.0 * b + c), 3.0 * (b - a) - slope
    q = -0.5 * (linear + np.copysign(np.sqrt(np.maximum(linear**2 - 4.0 * square * constant, 0.0)), linear))
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = [q / square, constant / q]
    found = [np.clip(np.where(np.isnan(root), u[:-1], root), u[:-1], u[1:]) for root in roots]
    off = [np.abs(bezier(a, b, c, d, u) - values)]
    off += [np.abs(bezier(a, b, c, d, at) - values[:-1] - slope * (at - u[:-1])) for at in found]
    return float(max(np.max(one) for one in off))


def _slopes(times: Floats, values: Floats) -> Floats:
    """dp/dt at each sample, from the two that follow: exact for parabolas, and blind to a corner at the sample."""
    width, rise = np.diff(times)[:, None], np.diff(values, axis=0)
    chord = rise / width
    slope = chord.copy()
    slope[:-1] += (chord[:-1] - chord[1:]) * width[:-1] / (width[:-1] + width[1:])
    return np.concatenate([slope, slope[-1:]])
