# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme cases: finite, not negative, no more light than came, and unbiased, or the limit is stated.

A cell holds a group of ``TABLE``: {"cases": [...], "passed": all of them}. A case is one value in one setup:

    what, value, setup    what is varied, and how it is rendered ("NumPy": by the reference alone)
    finite, lowest        whether every number is, and the smallest
    highest               the largest; of a white sky the albedo, as the mean of pixels that see alike
    z                     of the factor that scales all pixels together; null where no reference is held against it
    limit                 what happens in place of what was asked; "" where it is done as asked
    passed                whether all is as the table asks, or as the limit states

and what else its group measures.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from .. import check, check_glass, check_oren_nayar, gonio, headless
from ..check import SETUPS, Row, Setup, View
from ..material import Choice, build, parameter_sockets
from ..preset_checks import PresetError
from ..presets import Preset, find, parse
from . import stability_pictures, stability_reference
from .record import Cell
from .stability_pictures import Shot

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

SAMPLES = 64
SLOPES = (1e-4, 1e-3, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0)
NATIVE_SLOPES = tuple(m for m in SLOPES if m <= 1.0)
ETAS = (0.1, 0.5, 1.0 - 1e-9, 1.0 + 1e-9, 1.5, 10.0)
THETAS = (0.0, 45.0, 89.0, 89.9, 89.99, 89.99999)
SIGMAS = (0.0, 1e-6, 0.1, 1.0, np.pi / 2)
NEAREST = 90.0 - 2.0**-17  # degrees: what float32 holds of 90 - 1e-6
ROUNDING = 2.0**-15.5  # of a sum of at most 2^17 samples in float32, as in ``check.View``
FEW = 2  # of a line's values, in a quick report: its ends
NOISY = 170  # cases that are judged by Z, for Sidak's correction; a test holds it to the table


@dataclass(frozen=True)
class Seen:
    """What a case gave. image: (..., 3). alike: pixels of a row see alike, up to noise. row: to be judged by Z."""

    image: NDArray[np.float64]
    alike: bool = False
    row: Row | None = None
    limit: str = ""
    more: dict[str, Any] = field(default_factory=dict)


Look: TypeAlias = "Callable[[Any, Setup], Seen]"


@dataclass(frozen=True)
class Line:
    """One thing that is varied, and what is asked of it beside that it is finite.

    most: albedo, at most; None where a number is no share of light. least: what rounding may leave below 0.
    setups: None for the reference alone, which renders nothing.
    """

    group: str
    what: str
    values: tuple[Any, ...]
    look: Look
    most: float | None = 1.0
    least: float = 0.0
    unbiased: bool = False
    setups: tuple[Setup, ...] = (SETUPS[0], SETUPS[2])


# Looks


def sky(estimator: str, change: Callable[[float], Preset], value: float, setup: Setup) -> Seen:
    """Any preset under a white sky."""
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32))
    return Seen(check.measure(change(value), setup, estimator, geometry, SAMPLES), alike=True)


def facets(change: Callable[[float], Preset], value: float, setup: Setup) -> Seen:
    """Cook-Torrance by ``mirror`` under a white sky, whose mean and variance are known."""
    preset, geometry = change(value), gonio.Geometry(furnace=True, resolution=(32, 32))
    m = float(np.float32(preset.m))
    mean, square = check.furnace_moments(preset.reference_fresnel(), m)
    variance = np.maximum(square - mean**2, 0.0) / SAMPLES
    image = check.measure(preset, setup, "mirror", geometry, SAMPLES)
    row = Row("mirror", setup, preset.kind, m, [View(geometry, image, mean, variance=variance)])
    return Seen(image, alike=True, row=row)


def diffuse(kind: str, sigma: float, setup: Setup) -> Seen:
    """Oren-Nayar by ``mirror`` under a white sky."""
    of, geometry = check_oren_nayar.preset(kind, sigma), gonio.Geometry(furnace=True, resolution=(32, 32))
    mean, square = check_oren_nayar.furnace_moments(check_oren_nayar.model(of))
    variance = np.maximum(square - mean**2, 0.0) / SAMPLES
    image = check.measure(of, setup, "mirror", geometry, SAMPLES)
    return Seen(image, alike=True, row=Row("mirror", setup, kind, sigma, [View(geometry, image, mean, variance=variance)]))


def glass(inside: bool, m: float, eta: float, setup: Setup) -> Seen:  # noqa: FBT001 - bound by name in the table
    """Glass by ``mirror``: R + T under a white sky."""
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32), inside=inside)
    ahead = float(np.float32(1.0) / np.float32(eta) if inside else np.float32(eta))
    mean, square = check_glass.furnace_moments(ahead, float(np.float32(m)), "all", thin=False)
    variance = np.maximum(square - mean**2, 0.0) / SAMPLES
    image = check_glass.measure(check_glass.material(setup, "mirror", eta, m), setup, geometry, SAMPLES)
    row = Row("glass", setup, f"IOR {eta:g}", m, [View(geometry, image, mean, variance=variance)])
    return Seen(image, alike=True, row=row)


def native_glass(inside: bool, m: float, eta: float, setup: Setup) -> Seen:  # noqa: FBT001 - the same
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32), inside=inside)
    made = check_glass.material(setup, "closure", eta, m)
    return Seen(check_glass.measure(made, setup, geometry, SAMPLES), alike=True)


def grazing_view(estimator: str, m: float, theta: float, setup: Setup) -> Seen:
    """The white sky by views within 1/64 of what is left to the horizon, at m."""
    preset = white(m)
    geometry = gonio.Geometry(theta, window=max(90.0 - theta, 1e-5) / 64, furnace=True, resolution=(16, 16))
    return Seen(check.measure(preset, setup, estimator, geometry, SAMPLES))


def grazing_light(estimator: str, m: float, theta: float, setup: Setup) -> Seen:
    """The sun at theta, on the hemisphere and around its mirror direction. Cosine-free: no share of light."""
    preset = check.materials()["dielectric"].with_parameters(m=m)
    views = [
        check.measure(preset, setup, estimator, gonio.Geometry(theta, window, (32, 32)))
        for window in (0.0, max(90.0 - theta, 1e-5) / 2)
    ]
    return Seen(np.stack(views))


def out_of_range(name: str, of: Preset, value: float, setup: Setup) -> Seen:
    """A value that presets refuse, and what the shader makes of it where a script sets it all the same."""
    try:
        of.with_parameters(**{name: value})
    except PresetError as error:
        refused = str(error).partition(": ")[2]
    else:
        refused = ""
    made = build(of, Choice(setup.backend, "mirror"))
    socket = parameter_sockets(made)[name]
    kept = socket.default_value
    socket.default_value = value
    with headless.quiet():
        geometry = gonio.Geometry(furnace=True, resolution=(32, 32))
        image = gonio.measure(made, geometry, samples=SAMPLES, shading_osl=setup.shading_osl)
    socket.default_value = kept
    limit = f"presets and jobs refuse it: {refused}" if refused else ""
    return Seen(image.astype(np.float64), alike=True, limit=limit, more={"refused": bool(refused)})


def picture(shot: Shot, setup: Setup) -> Seen:
    """A white plane, far away, large, small, moving."""
    photo = stability_pictures.photo(shot, setup)
    more = {"noise": photo.noise, "numbers": photo.numbers, "of": stability_pictures.NUMBERS**2, "rays": photo.rays}
    return Seen(photo.row.views[0].measured, row=photo.row, limit=photo.warned, more=more)


def copies(shot: Shot, setup: Setup) -> Seen:
    """Two instances far apart: each as it should be, and with noise of its own."""
    first, second = (stability_pictures.photo(one, setup) for one in (shot, stability_pictures.other_copy(shot)))
    a, b = (one.row.views[0].measured[..., 0].ravel() for one in (first, second))
    alike = float(np.corrcoef(a, b)[0, 1])  # of 1024 independent pixels: 0 with a standard deviation of 1/32
    both = Row("instances", setup, "white", first.row.m, [first.row.views[0], second.row.views[0]])
    images = np.stack([view.measured for view in both.views])
    return Seen(images, row=both, more={"correlation": alike, "holds": abs(alike) * a.size**0.5 < check.limit(NOISY)})


def bounces(estimator: str, most: int, setup: Setup) -> Seen:
    """Nine balls that mirror all light, close together."""
    image = stability_pictures.heap(white(0.3), estimator, most, setup)
    return Seen(image)


def inside_glass(most: int, setup: Setup) -> Seen:
    """A smooth glass ball under a white sky gives back all of it but for paths that are cut."""
    preset = find("lecture/glass").with_parameters(m=0.0)
    image = stability_pictures.heap(preset, "mirror", most, setup, balls=1)
    return Seen(image, more={"lost": float(1.0 - image.mean())})


def course(law: str, driving: str, rate: float, setup: Setup) -> Seen:
    """A slope that falls from 1 to 0.05 so fast that the course is a step, by ``direct`` at its moments."""
    return Seen(**stability_reference.played(law, driving, rate, setup))


# What is asked


def white(m: float) -> Preset:
    return check.materials()["white"].with_parameters(m=m)


def reflecting(kind: str, name: str, value: float) -> Preset:
    """A material whose Fresnel term is at an end of its range, at m = 0.3."""
    return check.materials()[kind].with_parameters(**{name: value})


def float32_eta(eta: float) -> Preset:
    """What a float32 socket holds of it."""
    return reflecting("dielectric", "eta", float(np.clip(np.float64(np.float32(eta)), 0.1, 10.0)))


def oren_nayar(kind: str, sigma: float) -> Preset:
    return check_oren_nayar.preset(kind, sigma)


def layered(identity: str, m: float) -> Preset:
    """A sum or a lacquer of presets, all its facets at slope m."""
    preset = find(identity)
    return preset.with_parameters(**{name: m for name in preset.parameters if name == "m" or name.startswith("m_")})


def _lines() -> tuple[Line, ...]:
    known = partial(Line, unbiased=True)
    held = 1.0 + 0.005  # hybrid: max(f, c f_fit) is above f by at most its bound
    lines = [known("slope", "m, mirror", SLOPES, partial(facets, white))]
    for estimator, most in (("hybrid", held), ("fit", 1.02), ("closure", 1.0)):
        lines.append(Line("slope", f"m, {estimator}", NATIVE_SLOPES, partial(sky, estimator, white), most))
    for m in (1e-3, 0.3, 10.0):
        for estimator in ("mirror", "direct"):
            look = grazing_view if estimator == "mirror" else grazing_light
            most = 1.0 if estimator == "mirror" else None
            lines.append(Line("grazing", f"theta, {estimator}, m = {m:g}", (*THETAS, NEAREST), partial(look, estimator, m), most))
    for estimator in ("closure", "fit", "corrected"):
        # f_fit is taken from the light that Cycles gave by the same formula: what is left of the two rounds.
        least = -1.0 if estimator == "corrected" else 0.0
        look = partial(grazing_light, estimator, 0.3)
        lines.append(Line("grazing", f"theta, {estimator}, m = 0.3", (*THETAS, NEAREST), look, None, least))
    for kind, name, values in (
        ("schlick", "f0", (0.0, 1.0)), ("conductor", "k", (0.0, 1e-9, 1.0, 20.0)), ("conductor", "n", (0.0, 1.0, 20.0)),
        ("f82", "f82_tint", (0.0, 1.0)),
    ):  # fmt: skip
        lines.append(known("fresnel", f"{name}, {kind}", values, partial(facets, partial(reflecting, kind, name))))
    lines.append(known("fresnel", "eta, dielectric", ETAS, partial(facets, float32_eta)))
    for kind in ("full", "qualitative"):
        lines.append(known("oren_nayar", f"sigma, {kind}, mirror", SIGMAS, partial(diffuse, kind)))
        for estimator in ("hybrid", "fit", "closure"):
            look = partial(sky, estimator, partial(oren_nayar, kind))
            lines.append(Line("oren_nayar", f"sigma, {kind}, {estimator}", SIGMAS, look, held))
    for inside in (False, True):
        side = "inside" if inside else "outside"
        for m in (1e-4, 0.1, 1.0, 10.0):
            lines.append(known("glass", f"eta, mirror, m = {m:g}, {side}", ETAS, partial(glass, inside, m)))
        lines.append(Line("glass", f"eta, closure, m = 0.1, {side}", ETAS, partial(native_glass, inside, 0.1)))
    for identity in ("lecture/plastic", "car_paints/blue", "plastics/red_plastic"):
        preset = partial(layered, identity)
        lines += [Line("layers", f"m, {identity}, {e}", (1e-4, 1.0), partial(sky, e, preset), held) for e in ("mirror", "fit")]
    refused: tuple[tuple[str, Preset, tuple[float, ...]], ...] = (
        ("m", white(0.3), (1e-6, 20.0)), ("eta", check.materials()["dielectric"], (0.01, 100.0)),
        ("sigma", check_oren_nayar.preset("full", 0.3), (-0.1, 2.0)),
    )  # fmt: skip
    lines += [Line("range", name, values, partial(out_of_range, name, of), None, -np.inf) for name, of, values in refused]
    lines += _pictures(known)
    lines += [Line("bounces", f"most bounces, {e}", (0, 4, 64, 1024), partial(bounces, e), 1.0) for e in ("mirror", "hybrid")]
    lines.append(Line("bounces", "most bounces, smooth glass", (4, 64, 1024), inside_glass))
    for law in ("exponential", "logistic"):
        for driving in ("curves", "age"):
            values = (1.0, 1e3, 1e6)
            lines.append(Line("course", f"rate, {law} by {driving}", values, partial(course, law, driving), None))
    lines += [Line("reference", *row, setups=()) for row in stability_reference.ROWS]
    return tuple(lines)


def _pictures(known: Callable[..., Line]) -> list[Line]:
    near, far = (0.0, 1e2, 1e3, 1e4, 1e5), (1e4, 1e5, 1e6)
    moved: list[tuple[str, str, tuple[Shot, ...], Look]] = [
        ("origin", "metres from the origin, orthographic", tuple(Shot(where=d) for d in near), picture),
        ("origin", "the same, aperture opened", tuple(Shot(where=d, opened=True) for d in far), picture),
        ("origin", "metres from the origin, perspective", tuple(Shot("PERSP", d) for d in (0.0, *far)), picture),
        ("origin", "metres from the camera, orthographic", (Shot(distance=1e3), Shot(distance=1e5)), picture),
        ("origin", "the same, aperture opened", (Shot(distance=1e5, opened=True),), picture),
        ("scale", "metres, orthographic", tuple(Shot(scale=s) for s in (1e-4, 1e-2, 1e2, 1e5)), picture),
        ("scale", "metres, perspective", tuple(Shot("PERSP", scale=s) for s in (1e-4, 1e5)), picture),
        ("filter", "pixels", tuple(Shot(where=10.0, filter_width=w) for w in (0.01, 0.1, 1.5)), picture),
        ("filter", "the same, aperture opened", (Shot(where=10.0, filter_width=0.01, opened=True),), picture),
        ("motion", "orthographic", (Shot(where=10.0, moving="object"), Shot(where=10.0, moving="camera")), picture),
        ("motion", "perspective", (Shot("PERSP", 10.0, moving="object"), Shot("PERSP", 10.0, moving="camera")), picture),
        ("motion", "far from the origin", (Shot(where=1e4, moving="object"),), picture),
        ("instances", "metres from the origin", (Shot(copy=0), Shot(where=1e4, copy=0, opened=True)), copies),
    ]
    return [known(*row) for row in moved]


# Cells


def cells(*, quick: bool) -> list[Cell]:
    """One for each group of the table; a quick report has the ends of each line, in one setup."""
    table = _lines()
    groups = dict.fromkeys(line.group for line in table)
    return [Cell(f"stability/{group}", partial(_measured, group, quick)) for group in groups]


def cases(group: str, *, quick: bool) -> list[tuple[Line, Any, Setup | None]]:
    """Line, value and setup of each case of a group."""
    found: list[tuple[Line, Any, Setup | None]] = []
    for line in _lines():
        if line.group == group:
            values = line.values if not quick or len(line.values) <= FEW else (line.values[0], line.values[-1])
            setups: tuple[Setup | None, ...] = line.setups[: 1 if quick else None] or (None,)
            found += [(line, value, setup) for setup in setups for value in values]
    return found


def _measured(group: str, quick: bool, _folder: Path) -> dict[str, Any]:  # noqa: FBT001 - bound in ``cells``
    found = [judged(*case) for case in cases(group, quick=quick)]
    return {"cases": found, "passed": all(case["passed"] for case in found)}


def judged(line: Line, value: Any, setup: Setup | None) -> dict[str, Any]:
    """A case as a cell holds it."""
    seen = line.look(value, setup) if setup else line.look(value, SETUPS[0])
    image = seen.image
    finite = bool(np.isfinite(image).all())
    numbers = image[np.isfinite(image)]
    lowest, highest = (float(numbers.min()), _highest(seen)) if finite and numbers.size else (None, None)
    z, unbiased = _unbiased(seen.row) if line.unbiased and seen.row and finite else (None, True)
    fits = lowest is not None and highest is not None and lowest >= line.least
    fits = fits and (line.most is None or highest[0] - highest[1] <= line.most * (1.0 + ROUNDING))
    passed = finite and (bool(seen.limit) or (fits and unbiased and seen.more.get("holds", True)))
    return {
        "what": line.what, "value": _plain(value), "setup": str(setup) if setup else "NumPy", "finite": finite,
        "lowest": lowest, "highest": highest and highest[0], "z": z, "limit": seen.limit, "passed": bool(passed), **seen.more,
    }  # fmt: skip


def _plain(value: Any) -> Any:
    """A shot by what of it is not as usual."""
    if not isinstance(value, Shot):
        return float(value) if isinstance(value, float) else value
    usual = Shot()
    return {name: kept for name, kept in vars(value).items() if kept != getattr(usual, name)}


def _highest(seen: Seen) -> tuple[float, float]:
    """The largest value, or mean of a row whose pixels see alike; and what noise may have added to that."""
    if not seen.alike:
        return float(seen.image.max()), 0.0
    means = seen.image.mean(axis=1)
    errors = seen.image.std(axis=1, ddof=1) / seen.image.shape[1] ** 0.5
    at = np.unravel_index(int(np.argmax(means)), means.shape)
    return float(means[at]), check.limit(NOISY * means.size) * float(errors[at])


def _unbiased(row: Row) -> tuple[float, bool]:
    """Z of the common factor, and whether it, each pixel and the spread of all are as chance has them."""
    try:
        z = row.scale_z
    except ZeroDivisionError:  # no pixel carries noise: each is judged by its rounding
        z = 0.0
    enough = all(check.share_within(view.z) >= row.bar for view in row.views)
    spread = max(check.spread_z(view.z) for view in row.views)
    return z, enough and abs(z) <= check.limit(NOISY) and spread <= check.limit(NOISY * len(row.views))
