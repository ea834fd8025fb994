# SPDX-License-Identifier: GPL-3.0-or-later
"""How an extreme case is measured: a function for each kind, from what is varied and a setup to ``Outcome``."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ... import headless
from ...addon.blender import gonio
from ...addon.blender.inputs import scale_of
from ...addon.blender.material import NATIVE, Choice, build, parameter_sockets
from ...addon.choose import advice
from ...addon.choose.advice import FEWEST_BOUNCES, FEWEST_RAYS, LIGHTEST
from ...addon.library.checks import PresetError
from ...addon.library.presets import Preset, find
from ...addon.reference import CookTorrance, albedo, rendered
from ...addon.reference.quadrature import diffuse_albedo, vgroove_albedo, vgroove_mean
from ..check import glass as check_glass
from ..check import oren_nayar as check_oren_nayar
from ..check.cook_torrance import fresnel_approximation, materials
from ..check.rows import ROUNDING, Row, Setup, View
from ..check.views import closure_bar, direct_bar, measure, pooled_view
from ..sidak import limit
from . import stability_pictures

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from .stability_pictures import Shot

SAMPLES = 256
SKY = gonio.Geometry(furnace=True, resolution=(64, 8))
COLUMN = SKY.wo()[:, :1]
ALL, SMOOTH_LOSS = 1024, check_glass.SMOOTH_BAR  # bounces, as many as Cycles makes; of light, to rounding
DARKEST = 0.5  # smallest share of the formula's albedo by estimators that only come near it; none of them is black
MAX_SILENT_ROUNDING = 0.01  # share of the lobe's peak; larger rounding errors are reported
NOISY_CASES = 312  # cases that are judged by Z-tests, for Sidak's correction; a test compares it with the table


@dataclass(frozen=True)
class Outcome:
    """What a case gave. image: (..., 3). alike: pixels of a row should be equal, up to noise. row: to be judged by Z.

    holds: whether what only this kind of case must show is so. more: further fields of ``Case``.
    """

    image: NDArray[np.float64]
    alike: bool = False
    row: Row | None = None
    limit: str = ""
    holds: bool = True
    more: dict[str, float] = field(default_factory=dict)


def sky(estimator: str, change: Callable[[float], Preset], value: float, setup: Setup) -> Outcome:
    """Any preset under a white sky, by an estimator that is no more than near the formula."""
    preset = change(value)
    image = measure(preset, setup, estimator, SKY, SAMPLES)
    limit = _warned(preset, setup, estimator, "slope")
    return Outcome(image, alike=True, limit=limit, holds=_is_lit(image, albedo(preset.reference(), COLUMN)))


def _is_lit(image: NDArray[np.float64], formula: NDArray[np.float64]) -> bool:
    """Whether enough of the formula's albedo is seen: estimators differ, but none is black."""
    return bool(np.min(image.mean(axis=1) / formula[:, 0]) >= DARKEST)


def _warned(preset: Preset, setup: Setup, estimator: str, key: str) -> str:
    """What the panel says of it."""
    found = advice.problems_with(bpy.context.scene, preset, setup.backend, estimator)
    return next((problem.text for problem in found if problem.key == key), "")


def facets(change: Callable[[float], Preset], value: float, setup: Setup) -> Outcome:
    """Cook-Torrance by ``mirror`` under a white sky, whose mean and variance are known."""
    preset = change(value)
    m, F = float(np.float32(preset.m)), preset.reference_fresnel()
    moments = albedo(CookTorrance(m, F), COLUMN), vgroove_albedo(COLUMN, m, F, moment=2)
    found = weighed(measure(preset, setup, "mirror", SKY, SAMPLES), setup, *moments)
    if not 0.0 < np.max(moments[0]) < LIGHTEST:
        return found
    warned = _warned(preset, setup, "mirror", "faint")
    return replace(found, limit=warned, holds=bool(warned) and not found.image.any())


def diffuse(kind: str, sigma: float, setup: Setup) -> Outcome:
    """Oren-Nayar by ``mirror`` under a white sky."""
    preset = check_oren_nayar.preset(kind, sigma)
    model = check_oren_nayar.model(preset)
    square = diffuse_albedo(COLUMN, lambda wi, wo: np.pi * model.evaluate(wi, wo) ** 2)
    image = measure(preset, setup, "mirror", SKY, SAMPLES)
    return weighed(image, setup, model.directional_albedo(COLUMN), square)


def glass(inside: bool, m: float, eta: float, setup: Setup) -> Outcome:  # noqa: FBT001 - bound by place in the table
    """Glass by ``mirror``: R + T under a white sky."""
    ahead = float(np.float32(1.0) / np.float32(eta) if inside else np.float32(eta))

    def worth(F: Any, R: Any, T: Any) -> Any:
        total = F * R + (1.0 - F) * T
        return np.stack([total, total**2, 0.0 * total], axis=-1)

    found = vgroove_mean(COLUMN, float(np.float32(m)), ahead, worth)
    made = check_glass.probe(setup, "mirror", eta, m)
    image = check_glass.measure_probe(made, setup, replace(SKY, inside=inside), SAMPLES)
    return weighed(image, setup, found[..., :1], found[..., 1:2])


def weighed(
    image: NDArray[np.float64], setup: Setup, mean: NDArray[np.float64], square: NDArray[np.float64]
) -> Outcome:
    """``image`` of a white sky beside the moments (rows, 1, channels) of one sample.

    A sample is worth 0 to 1. A variance of v then is that of at least v N rare events among N samples, and pixels are
    judged together until they have 25.
    """
    mean, square = (np.broadcast_to(part, image.shape) for part in (mean, square))
    events = SAMPLES * np.maximum(square - mean**2, 0.0)[..., 0]
    view = pooled_view(SKY, events, image, mean, square, SAMPLES)
    return Outcome(image, alike=True, row=Row("sky", setup, views=[view]))


def native_glass(inside: bool, m: float, eta: float, setup: Setup) -> Outcome:  # noqa: FBT001 - the same
    made = check_glass.probe(setup, "closure", eta, m)
    image = check_glass.measure_probe(made, setup, replace(SKY, inside=inside), SAMPLES)
    return Outcome(image, alike=True, holds=_is_lit(image, np.ones(image.shape)))  # next to all of it, at this m


def grazing_view(m: float, theta: float, setup: Setup) -> Outcome:
    """The white sky by ``mirror``, by views within 1/64 of what is left to the horizon."""
    geometry = gonio.Geometry(theta, window=max(90.0 - theta, 1e-5) / 64, furnace=True, resolution=(16, 8))
    image = measure(white(m), setup, "mirror", geometry, SAMPLES)
    return replace(weighed(image, setup, *_grazing_moments(m, geometry)), alike=False)


@cache
def _grazing_moments(m: float, geometry: gonio.Geometry) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two of one sample, the same in every setup."""
    held, F, (width, height) = float(np.float32(m)), white(m).reference_fresnel(), geometry.resolution
    half = float32_wo(geometry)[: height // 2]  # rows are alike above and below the middle
    moments = albedo(CookTorrance(held, F), half), vgroove_albedo(half, held, F, moment=2)
    first, second = (np.concatenate([part, part[::-1]]).reshape(height, width, 3) for part in moments)
    return first, second


def float32_wo(geometry: gonio.Geometry) -> NDArray[np.float64]:
    """``geometry.wo()`` from angles in degrees that float32 holds, as the camera has them: near 90 by 2^-17."""
    if not geometry.window:
        return geometry.wo()
    width, height = geometry.resolution
    across, down = (np.float32(2.0 * (np.arange(n) + 0.5) / n - 1.0) for n in (width, height))
    window, theta = np.float32(geometry.window), np.float32(geometry.theta_i)
    above = np.radians(90.0 - np.float64(theta + window * across))[None]
    a, b = np.radians(np.float64(window * across))[None], np.radians(np.float64(window * down))[:, None]
    wo = np.stack(np.broadcast_arrays(-np.cos(above), np.cos(a) * np.tan(b), np.sin(above)), axis=-1)
    return wo / np.linalg.norm(wo, axis=-1, keepdims=True)


def grazing_light(estimator: str, m: float, theta: float, setup: Setup) -> Outcome:
    """The sun at theta, on the hemisphere and around its mirror direction, against the formula.

    Cosine-free: no share of light. Around it as far as the horizon's half or, if that is less, four times the slope.
    """
    preset = materials()["dielectric"].with_parameters(m=m)
    near = min(max(90.0 - theta, 1e-5) / 2, np.degrees(4.0 * m))
    geometries = [gonio.Geometry(theta, window, (33, 33)) for window in (0.0, near)]  # one pixel sees the peak itself
    images = [measure(preset, setup, estimator, geometry) for geometry in geometries]
    views = [beside(*pair, estimator, preset, setup) for pair in zip(images, geometries, strict=True)]
    worst = max(views, key=lambda view: view.error / view.bar)
    approximate = fresnel_approximation(setup, "dielectric") if estimator in {*NATIVE, "corrected"} else 0.0
    limits = [_warned(preset, setup, estimator, "fresnel") if approximate else ""]
    limits += _rounded(max(view.bar for view in views) - approximate, float(np.min(images)))
    return Outcome(
        np.stack(images), limit="; ".join(filter(None, limits)), holds=bool(worst.error <= worst.bar),
        more={"error": worst.error, "bar": worst.bar},
    )  # fmt: skip


def _rounded(bar: float, lowest: float) -> list[str]:
    """What float32 leaves of light that comes near the horizon, where wi + wo nearly cancels; bar: the loosest."""
    said = []
    if bar > MAX_SILENT_ROUNDING:
        held = (
            f"held to {100.0 * bar:.2g} % of the lobe" if bar < 1.0 else "around the mirror direction held to nothing"
        )
        said.append(f"so near the horizon float32 rounds the half vector: {held}")
    if lowest < 0.0:
        said.append("a difference of two large numbers rounds to below 0")
    return said


def beside(image: NDArray[np.float64], geometry: gonio.Geometry, estimator: str, preset: Preset, setup: Setup) -> View:
    """``image`` beside the formula of ``estimator``; of a sun where float32 puts it.

    As ``noiseless_row``. The sun's strength allows for the cosine of theta, not of what float32 has of it.

    Normalizing rounds each component of wi and wo by up to 2^-24 of it, for the length and for the quotient. Then h
    turns, and its slope s changes by up to d = 2^-23 max(|wi|, |wo|) / (wi + wo)_z along each axis. At grazing angles
    wi + wo is small; by (2 s d + d^2) / m^2 of it exp(-s^2 / m^2) changes. Cycles takes F at c = dot(wo, h), which is
    off by up to 2^-23 / |wi + wo|; near c = 0 the F of a dielectric falls by 2 (1 + eta^2) / sqrt(eta^2 - 1) a unit of
    c, by no more than all of it.
    """
    theta, m = _held(geometry.theta_i), preset.m
    wi, wo = np.array([np.sin(theta), 0.0, np.cos(theta)]), float32_wo(geometry)
    brighter = np.cos(theta) / np.cos(np.radians(geometry.theta_i))
    native = estimator in {*NATIVE, "corrected"}
    approximate = fresnel_approximation(setup, "dielectric") if native else 0.0
    of = (white(m) if approximate else preset).reference()
    lobes = [rendered(of, name) for name in {"corrected": ("direct", "fit")}.get(estimator, (estimator,))]
    formula = rendered(preset.reference(), estimator if estimator in NATIVE else "direct")
    expected = brighter * formula(wi, wo)
    # Where the view holds less than 2^-64 of the lobe there is only what exp() leaves of its underflow.
    peak = float(np.max(lobes[0](wi, wi * [-1.0, -1.0, 1.0])))
    scale = brighter * max(*(float(np.max(lobe(wi, wo))) for lobe in lobes), 2.0**-64 * peak)
    h = wi + wo
    turned = 2.0 * ROUNDING * np.maximum(np.abs(wi), np.abs(wo))[..., :2] / h[..., 2:]
    changed = np.sum(2.0 * np.abs(h[..., :2] / h[..., 2:]) * turned + turned**2, axis=-1, keepdims=True) / m**2
    bar = float(np.max(np.minimum(changed, 1.0) * expected / scale))  # weighed by what the view shows there
    if native:
        eta = float(np.asarray(preset.parameters["eta"]))
        steep = 2.0 * (1.0 + eta**2) / (eta**2 - 1.0) ** 0.5
        nearest = float(np.min(np.linalg.norm(h, axis=-1)))
        bar += approximate + closure_bar(m) + min(1.0, steep * 2.0 * ROUNDING / nearest)
    else:
        bar += direct_bar(m)
    # A difference of two equal numbers may round to below 0.
    signed = estimator == "corrected" and np.min(image) >= -bar * scale
    return View(geometry, np.maximum(image, 0.0) if signed else image, expected, bar, scale)


def _held(theta: float) -> float:
    """Degrees as the radians that float32 holds."""
    return float(np.float32(np.radians(theta)))


def out_of_range(name: str, usual: Callable[[], Preset], value: float, setup: Setup) -> Outcome:
    """A value that presets refuse, and what the shader makes of it where a script sets it all the same."""
    of = usual()
    try:
        of.with_parameters(**{name: value})
    except PresetError as error:
        refused = str(error).partition(": ")[2]
    else:
        refused = ""
    made = build(of, Choice(setup.backend, "mirror"))
    socket = parameter_sockets(made)[name]
    usual_value = tuple(socket.default_value) if socket.type == "RGBA" else socket.default_value
    given = scale_of(name, socket).to_input(value)
    socket.default_value = (given, given, given, 1.0) if socket.type == "RGBA" else given
    with headless.quiet():
        image = gonio.measure(made, SKY, samples=SAMPLES, shading_osl=setup.shading_osl)
    socket.default_value = usual_value
    limit = f"presets and jobs refuse it: {refused}" if refused else ""
    return Outcome(image.astype(np.float64), alike=True, limit=limit, holds=bool(refused))


def picture(shot: Shot, setup: Setup) -> Outcome:
    """A white plane, far away, large, small, moving. Of what moves the panel says nothing."""
    photo = stability_pictures.photo(shot, setup)
    image, moves = photo.row.views[0].measured, shot.moving == "object"
    limit = "" if moves else photo.warned
    if limit:
        apart = abs(np.log2(photo.rays / photo.numbers))  # rays fall on places about so: up to half are cut by an edge
        holds = apart <= 1.0 and stability_pictures.is_explained(image, stability_pictures.sharing(shot))
    else:
        holds = 2.0 * photo.numbers >= FEWEST_RAYS * stability_pictures.SAMPLES
    more = {"noise": photo.noise, "numbers": photo.numbers, "rays": photo.rays}
    return Outcome(image, row=photo.row, limit=limit, holds=bool(holds), more=more)


def copies(shot: Shot, setup: Setup) -> Outcome:
    """Two instances far apart: each as it should be, and with noise of its own."""
    first, second = (stability_pictures.photo(one, setup) for one in (shot, stability_pictures.other_copy(shot)))
    a, b = (one.row.views[0].measured[..., 0].ravel() for one in (first, second))
    alike = float(np.corrcoef(a, b)[0, 1])  # of 1024 independent pixels: 0 with a standard deviation of 1/32
    both = replace(first.row, test="instances", views=[first.row.views[0], second.row.views[0]])
    images = np.stack([view.measured for view in both.views])
    return Outcome(images, row=both, holds=abs(alike) * a.size**0.5 < limit(NOISY_CASES))


def bounces(estimator: str, most: int, setup: Setup) -> Outcome:
    """Nine balls that mirror all light, close together: they go black by none but the bounces that are cut.

    A sample of ``mirror`` is worth at most 1; of ``hybrid`` only the mean is, within its bound, and 4 x 4 pixels are
    judged together: what these differ by for other reasons only adds to what noise may explain.
    """
    image, _ = stability_pictures.heap(white(0.3), estimator, most, setup)
    holds = bool(image.mean() >= DARKEST or not most)
    if estimator == "mirror":
        return Outcome(image, limit=cut(most), holds=holds)
    blocks = image.reshape(8, 4, 8, 4, 3).swapaxes(1, 2).reshape(64, 16, 3)
    return Outcome(blocks, alike=True, limit=cut(most), holds=holds)


def inside_glass(most: int, setup: Setup) -> Outcome:
    """A smooth glass ball under a white sky gives back all of it but for paths that are cut, of which the panel warns.

    A path that is trapped takes hundreds of bounces, as facets are flat; that loses little, and is stated alone.
    """
    preset = find("glasses/bk7_crown_glass").with_parameters(m=0.0, absorption=0.0)
    image, warned = stability_pictures.heap(preset, "mirror", most, setup, balls=1)
    lost = float(1.0 - image.mean())
    limit = f"{warned or cut(most)} ({100.0 * lost:.2g} % of all light)" if lost > SMOOTH_LOSS else ""
    holds = bool(warned) == (most < FEWEST_BOUNCES) and (most < ALL or not limit)
    return Outcome(image, limit=limit, holds=holds)


def cut(most: int) -> str:
    """What a scene asks for with so few bounces."""
    return f"light of more than {most} bounces is left out" if most < ALL else ""


# The presets that are varied


def white(m: float) -> Preset:
    return materials()["white"].with_parameters(m=m)


def reflecting(kind: str, name: str, value: float) -> Preset:
    """A material whose Fresnel term is at an end of its range, at m = 0.3."""
    return materials()[kind].with_parameters(**{name: value})


def float32_eta(eta: float) -> Preset:
    """What a float32 socket holds of it."""
    return reflecting("dielectric", "eta", float(np.clip(np.float64(np.float32(eta)), 0.1, 10.0)))


def oren_nayar(kind: str, sigma: float) -> Preset:
    return check_oren_nayar.preset(kind, sigma)


def layered(identity: str, m: float) -> Preset:
    """A sum or a lacquer of presets, all its facets at slope m."""
    preset = find(identity)
    return preset.with_parameters(**{name: m for name in preset.parameters if name == "m" or name.startswith("m_")})
