# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme cases: finite, not negative, no more light than came, and unbiased, or the limit is stated."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ...addon.blender.course import DRIVINGS
from ...addon.models import MODELS
from ...addon.reference.hybrid import DEFAULT_BOUND
from ...addon.reference.oren_nayar_fit import KINDS
from ..check.rows import FLOAT_SUM, NOISY_ROWS, SETUPS, Row, Setup, share_within, spread_z
from ..sidak import limit
from . import stability_measures as measures
from . import stability_models as models
from . import stability_reference as reference
from .cells import Case
from .stability_measures import ALL, NOISY_CASES, Outcome
from .stability_pictures import FIRST_SEED, Shot

if TYPE_CHECKING:
    from collections.abc import Callable
SLOPES = (1e-4, 1e-3, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0)
ETAS = (0.1, 0.5, 1.0 - 2.0**-24, 1.0 - 1e-9, 1.0 + 1e-9, 1.0 + 2.0**-23, 1.5, 10.0)  # with float32's next to 1
NEAREST = 90.0 - 2.0**-17  # degrees: what float32 holds of 90 - 1e-6
THETAS = (0.0, 45.0, 89.0, 89.9, 89.99, 89.99999, NEAREST)
SIGMAS = (0.0, 1e-6, 0.1, 1.0, np.pi / 2)
SIDES = ("outside", "inside")


Measure: TypeAlias = "Callable[[Any, Setup], Outcome]"


@dataclass(frozen=True)
class Sweep:
    """One thing that is varied, and what its cases must show beside that they are finite.

    most: albedo, at most; None where a number is no share of light. least: what rounding may leave below 0.
    setups: none for the reference alone, which renders nothing. quick: whether a quick report has it, by its ends.
    """

    group: str
    what: str
    values: tuple[Any, ...]
    measure: Measure
    most: float | None = 1.0
    least: float = 0.0
    unbiased: bool = False
    setups: tuple[Setup, ...] = (SETUPS[0], SETUPS[2])
    quick: bool = True


# The table


UNBIASED = partial(Sweep, unbiased=True)
# The largest albedo of what sends back all light. f of hybrid is max(f, c f_fit), beyond the model by at most its
# bound; fit is within 1 % of the albedo.
HYBRID_MOST, FIT_MOST = 1.0 + DEFAULT_BOUND, 1.01
ESTIMATORS = (("hybrid", HYBRID_MOST), ("fit", FIT_MOST), ("closure", 1.0))
# A difference rounds to below 0, to which its bar is held.
UNDER_A_SUN = (("direct", 0.0), ("closure", 0.0), ("fit", 0.0), ("corrected", -np.inf))
ENDS = (
    ("schlick", "f0", (0.0, 1.0), True),
    ("conductor", "k", (0.0, 1e-9, 1.0, 20.0), True),
    ("conductor", "n", (0.0, 1.0, 20.0), False),
    ("f82", "f82_tint", (0.0, 1.0), False),
)
OUTSIDE = (
    ("m", partial(measures.white, 0.3), (1e-6, 20.0)),
    ("eta", partial(measures.reflecting, "dielectric", "eta", 1.5), (0.01, 100.0)),
    ("sigma", partial(measures.oren_nayar, "full", 0.3), (-0.1, 2.0)),
    ("albedo", partial(measures.oren_nayar, "full", 0.3), (1.0,)),
)
LAYERED = (("lecture/plastic", True), ("car_paints/blue", True), ("plastics/red_plastic", False))
FAR = (1e4, 1e5, 1e6)  # metres from the origin
PICTURES = (
    ("origin", "orthographic", tuple(Shot(where=d) for d in (0.0, 1e2, 1e3, 1e4, 1e5))),
    ("origin", "orthographic, aperture opened", tuple(Shot(where=d, opened=True) for d in FAR)),
    ("origin", "perspective", tuple(Shot("PERSP", d) for d in (0.0, *FAR))),
    ("origin", "camera far away, orthographic", (Shot(distance=1e3), Shot(distance=1e5))),
    ("origin", "camera far away, aperture opened", (Shot(distance=1e5, opened=True),)),
    ("scale", "orthographic", tuple(Shot(scale=s) for s in (1e-4, 1e-2, 1e2, 1e5))),
    ("scale", "perspective", tuple(Shot("PERSP", scale=s) for s in (1e-4, 1e5))),
    ("filter", "orthographic", tuple(Shot(where=10.0, filter_width=w) for w in (0.01, 0.1, 1.5))),
    ("filter", "perspective", tuple(Shot("PERSP", 10.0, filter_width=w) for w in (0.01, 1.5))),
    ("filter", "orthographic, aperture opened", (Shot(where=10.0, filter_width=0.01, opened=True),)),
    ("motion", "of object and camera", tuple(Shot("ORTHO", 10.0, moving=m) for m in ("object", "camera"))),
    ("motion", "of object and camera", tuple(Shot("PERSP", 10.0, moving=m) for m in ("object", "camera"))),
    ("motion", "far from the origin", (Shot(where=1e4, moving="object"),)),
)

TABLE: tuple[Sweep, ...] = (
    UNBIASED("slope", "m, mirror", SLOPES, partial(measures.facets, measures.white)),
    *(Sweep("slope", f"m, {e}", SLOPES, partial(measures.sky, e, measures.white), most) for e, most in ESTIMATORS),
    *(
        UNBIASED("grazing", f"theta_o, mirror, m = {m:g}", THETAS, partial(measures.grazing_view, m), quick=m != 0.3)
        for m in (1e-3, 0.3, 10.0)
    ),
    *(
        Sweep("grazing", f"theta_i, {e}, m = {m:g}", THETAS, measure, None, least, quick=m != 0.3)
        for m in (1e-3, 0.3, 10.0)
        for e, least in (UNDER_A_SUN if m == 0.3 else UNDER_A_SUN[:1])
        for measure in (partial(measures.grazing_light, e, m),)
    ),
    *(
        UNBIASED("fresnel", f"{name}, {kind}", values, partial(measures.facets, change), quick=quick)
        for kind, name, values, quick in ENDS
        for change in (partial(measures.reflecting, kind, name),)
    ),
    UNBIASED("fresnel", "eta, dielectric", ETAS, partial(measures.facets, measures.float32_eta)),
    *(UNBIASED("oren_nayar", f"sigma, {k}, mirror", SIGMAS, partial(measures.diffuse, k)) for k in KINDS),
    *(
        Sweep("oren_nayar", f"sigma, {k}, {e}", SIGMAS, partial(measures.sky, e, change), most, quick=k == "full")
        for k in KINDS
        for change in (partial(measures.oren_nayar, k),)
        for e, most in ESTIMATORS
    ),
    *(
        UNBIASED("glass", f"eta, mirror, m = {m:g}, {side}", ETAS, measure, quick=m in {1e-4, 10.0})
        for side in SIDES
        for m in (1e-4, 0.1, 1.0, 10.0)
        for measure in (partial(measures.glass, side == "inside", m),)
    ),
    *(
        Sweep("glass", f"eta, closure, m = 0.1, {side}", ETAS, partial(measures.native_glass, side == "inside", 0.1))
        for side in SIDES
    ),
    *(
        Sweep("layers", f"m, {identity}, {e}", (1e-4, 1.0), partial(measures.sky, e, change), FIT_MOST, quick=quick)
        for identity, quick in LAYERED
        for change in (partial(measures.layered, identity),)
        for e in ("mirror", "fit")
    ),
    *(
        Sweep("range", name, values, partial(measures.out_of_range, name, usual), None, -np.inf)
        for name, usual, values in OUTSIDE
    ),
    *(UNBIASED(group, what, shots, measures.picture) for group, what, shots in PICTURES),
    UNBIASED("instances", "of a collection", (Shot(copy=0), Shot(where=1e4, copy=0, opened=True)), measures.copies),
    *(
        Sweep("bounces", f"at most, {e}", (0, 4, 64, ALL), partial(measures.bounces, e), most)
        for e, most in (("mirror", 1.0), ("hybrid", HYBRID_MOST))
    ),
    Sweep("bounces", "at most, smooth glass", (4, 64, ALL), measures.inside_glass),
    *(
        Sweep(
            "course", f"rate, {law} by {driving}", (1.0, 1e3, 1e6, 1e8), partial(reference.course, law, driving), None
        )
        for law in ("exponential", "logistic")
        for driving in DRIVINGS
    ),
    *(
        Sweep("models", f"{what}, {model}, {e}", values, partial(models.sky, e, of), FIT_MOST if e == "fit" else 1.0)
        for model, (what, values, of) in models.VARIED.items()
        for e in ("mirror", "fit", "closure")
        if e in MODELS[model].estimators
    ),
    *(
        Sweep("tangents", f"{model}, {e}", models.TANGENTS, partial(models.tangent, e, model), None, quick=False)
        for model in models.GROOVED
        for e in ("direct", "fit", "closure")
    ),
    *(Sweep("reference", what, values, measure, most, setups=()) for what, values, measure, most in reference.ROWS),
)


# Cells


def names(**_quick: bool) -> list[str]:
    """Groups of the table; a quick report has the ends of each sweep, in one setup."""
    return [*dict.fromkeys(sweep.group for sweep in TABLE)]


def measure(group: str, *, quick: bool) -> tuple[Case, ...]:
    return tuple(judged(*case) for case in cases(group, quick=quick))


def cases(group: str, *, quick: bool) -> list[tuple[Sweep, Any, Setup | None]]:
    """Sweep, value and setup of each case of a group."""
    found: list[tuple[Sweep, Any, Setup | None]] = []
    for sweep in TABLE:
        if sweep.group == group and (sweep.quick or not quick):
            values = dict.fromkeys((sweep.values[0], sweep.values[-1])) if quick else sweep.values
            setups: tuple[Setup | None, ...] = sweep.setups[: 1 if quick else None] or (None,)
            found += [(sweep, value, setup) for setup in setups for value in values]
    return found


def judged(sweep: Sweep, value: Any, setup: Setup | None) -> Case:
    """Measure a case and say whether it passes."""
    found = sweep.measure(value, setup or SETUPS[0])
    finite = bool(np.isfinite(found.image).all())
    lowest = float(np.min(found.image)) if finite else None
    highest, noise = _highest(found) if finite else (None, 0.0)
    z, resolves, unbiased = _unbiased(found.row) if sweep.unbiased and found.row and finite else (None, None, True)
    again = None if unbiased or found.limit else _by_chance(sweep, value, setup)
    least = lowest is not None and lowest >= sweep.least
    most = sweep.most is None or (highest is not None and highest - noise <= sweep.most * (1.0 + FLOAT_SUM))
    as_required = most and (unbiased or bool(again) or bool(found.limit))
    held = float(np.float32(value)) if setup and isinstance(value, float) else None
    passed = bool(least and as_required and found.holds)
    return Case(
        group=sweep.group, what=sweep.what, value=_plain(value), setup=str(setup) if setup else "NumPy",
        passed=passed, held=held, lowest=lowest, highest=highest, z=z, resolves=resolves, again=again,
        limit=found.limit, **{name: float(more) if np.isfinite(more) else None for name, more in found.more.items()},
    )  # fmt: skip


def _by_chance(sweep: Sweep, value: Any, setup: Setup | None) -> bool | None:
    """Whether a picture that fails passes by another seed; None of what else is rendered.

    All Z-tests together fail by chance in one report of a hundred: always in the same, as seeds stay. What is wrong
    fails by both seeds, and chance alone in one of ten thousand.
    """
    if not isinstance(value, Shot) or value.seed != FIRST_SEED:
        return None
    return judged(sweep, replace(value, seed=FIRST_SEED + 1), setup).passed


def _plain(value: Any) -> Any:
    """A shot by what of it is not as usual."""
    if not isinstance(value, Shot):
        return float(value) if isinstance(value, float) else value
    usual = Shot()
    return {name: own for name, own in vars(value).items() if own != getattr(usual, name)}


def _highest(found: Outcome) -> tuple[float, float]:
    """The largest value, or mean of a row whose pixels see alike; and what noise may have added to that."""
    if not found.alike:
        return float(np.max(found.image)), 0.0
    means = found.image.mean(axis=1)
    errors = found.image.std(axis=1, ddof=1) / found.image.shape[1] ** 0.5
    at = np.unravel_index(int(np.argmax(means)), means.shape)
    return float(means[at]), limit(NOISY_CASES * means.size) * float(errors[at])


def _unbiased(row: Row) -> tuple[float, float, bool]:
    """Z of the common factor, how far off it would be seen, and whether all that is tested is as by chance."""
    z, resolved = row.scale_z, row.resolves * limit(NOISY_CASES) / limit(NOISY_ROWS)
    enough = all(share_within(view.z) >= row.bar for view in row.views)
    spread = max(spread_z(view.z) for view in row.views)
    by_chance = enough and abs(z) <= limit(NOISY_CASES) and spread <= limit(NOISY_CASES * len(row.views))
    return z, resolved, by_chance
