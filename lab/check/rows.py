# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove check``: every model x estimator x backend, Cycles against NumPy.

Estimators without noise (``closure``, ``direct``) are compared by their largest difference, as a share of the
reference's maximum in the same view. ``mirror`` is noisy and is judged by Z-tests whose variances come from the
reference, so nothing is tuned. docs/testing.md derives every bar.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from scipy.stats import norm
from scipy.stats import t as student

from ... import headless
from ...addon.blender import gonio
from ...addon.blender.material import NATIVE
from ...addon.choose.advice import native_fresnel_error
from ...addon.library.presets import Preset, find, parse
from ...addon.reference import CookTorrance, albedo, cook_torrance, rendered
from ...addon.reference.directions import dot
from ...addon.reference.quadrature import gauss_legendre, vgroove_albedo

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from ...addon.reference import Fresnel, Model

THETAS = (0.0, 20.0, 45.0, 70.0, 85.0)
WINDOW = 5.0
DIRECT_SLOPES = (1.0, 0.6, 0.3, 0.1, 0.05, 0.02, 0.005, 0.001)
# Nodes run as OSL are the same as in SVM, and slow to compile: what OSL may round otherwise shows at these.
OSL_SLOPES, OSL_THETAS = (0.3, 0.05), (20.0, 70.0)
CLOSURE_SLOPES = (1.0, 0.6, 0.3, 0.1, 0.05, 0.02)
MIRROR_SLOPES = (0.1, 0.3, 0.6, 1.0)
SPHERE_SLOPES = (1.0, 0.3, 0.1)
SUN_THETAS = (20.0, 60.0, 74.0)  # the widest sun stays above the horizon
# Broad lobes seldom hit a small sun; a wider one asks for as many fewer samples as it is larger.
SUN_ANGLES = {0.1: 20.0, 0.3: 30.0, 0.6: 30.0, 1.0: 30.0}
FURNACE_SAMPLES = 1024
SUN_SAMPLES = {0.1: 2560, 0.3: 2560, 0.6: 7168, 1.0: 15360}  # a pixel, so that every row resolves surely_seen(0.01)
NOISY_ROWS = 32  # rows of the plan that are judged by Z-tests; a test holds it to the plan
OWN_SEEDS = 100  # degrees of freedom to which a variance may be a pixel's own; beyond, it is that of many
ROUNDING = 2.0**-24  # float32 rounds a number near 1 by up to this much


@dataclass(frozen=True)
class Setup:
    """A backend, and whether Cycles runs its shaders as OSL or as SVM."""

    backend: str
    shading_osl: bool

    def __str__(self) -> str:
        return "osl" if self.backend == "osl" else f"nodes in {'OSL' if self.shading_osl else 'SVM'}"


SETUPS = (Setup("nodes", shading_osl=False), Setup("nodes", shading_osl=True), Setup("osl", shading_osl=True))


@dataclass(frozen=True)
class View:
    """One measured image beside the reference of its every pixel; ``variance`` is that of the image's mean.

    ``degrees``: those of freedom of a variance that is itself an estimate; infinite where the reference gives it.
    """

    geometry: gonio.Geometry
    measured: NDArray[np.float64]
    expected: NDArray[np.float64]
    bar: float = 0.0
    scale: float = 0.0
    variance: NDArray[np.float64] | None = None
    degrees: float = np.inf

    @property
    def error(self) -> float:
        """Largest difference as a share of ``scale``; infinite where a value is negative or not finite."""
        if not np.isfinite(self.measured).all() or np.min(self.measured) < 0:
            return float("inf")
        return float(np.max(np.abs(self.measured - self.expected)) / self.scale)

    @cached_property
    def z(self) -> NDArray[np.float64]:
        """(measured - expected) / standard error for every pixel-channel; float32 sums add to the noise.

        Over an estimated error that is Student's t, returned as the normal value of the same probability.
        """
        assert self.variance is not None
        # A sum of N float32 samples rounds by sqrt(N) 2^-24 of the mean at random; N <= 2^17 gives 2^-15.5.
        error = np.sqrt(self.variance + np.square(self.expected * 2.0**-15.5))
        difference = self.measured - self.expected
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(difference == 0, 0.0, difference / error)
        if np.isinf(self.degrees):
            return ratio
        return np.sign(ratio) * norm.isf(student.sf(np.abs(ratio), self.degrees))


@dataclass
class Row:
    """One line of the table: an estimator in a setup on one material, over all its views.

    noisy_rows: how many rows of its plan are judged by Z-tests, for Sidak's correction.
    """

    test: str
    setup: Setup
    fresnel: str
    m: float
    views: list[View] = field(default_factory=list)
    noisy_rows: int = NOISY_ROWS

    @property
    def is_noisy(self) -> bool:
        return self.views[0].variance is not None

    @property
    def error(self) -> float:
        """Worst share of the bar's own measure: largest difference; for noisy rows the share of pixels that pass."""
        if self.is_noisy:
            return float(min(share_within(view.z, self.noisy_rows) for view in self.views))
        return max(view.error for view in self.views)

    @property
    def bar(self) -> float:
        return 0.9975 if self.is_noisy else max(view.bar for view in self.views)

    @property
    def passed(self) -> bool:
        if not self.is_noisy:
            return all(view.error <= view.bar for view in self.views)
        enough = all(share_within(view.z, self.noisy_rows) >= self.bar for view in self.views)
        spread = max(spread_z(view.z) for view in self.views)
        limits = limit(self.noisy_rows), limit(self.noisy_rows * len(self.views))
        return enough and abs(self.scale_z) <= limits[0] and spread <= limits[1]

    @property
    def scale_z(self) -> float:
        """Z of the one number that scales all pixels together: finds a 1 % error that single pixels hide in noise."""
        return float(self._score() * np.sqrt(self._information()))

    @property
    def resolves(self) -> float:
        """The smallest common scale error that the row would turn red on, or its bar if it is free of noise."""
        return float(limit(self.noisy_rows) / np.sqrt(self._information())) if self.is_noisy else self.bar

    def _information(self) -> float:
        return sum(float(np.sum(expected**2 / variance)) for _, expected, variance in map(_noisy, self.views))

    def _score(self) -> float:
        total = sum(
            float(np.sum((measured - expected) * expected / variance))
            for measured, expected, variance in map(_noisy, self.views)
        )
        return total / self._information()

    def scaled(self, factor: float) -> Row:
        """The row as it would be with a reference ``factor`` times as bright; to see that it can fail."""
        views = [replace(view, expected=view.expected * factor, scale=view.scale * factor) for view in self.views]
        return replace(self, views=views)

    def as_json(self) -> dict[str, Any]:
        return {
            "test": self.test, "setup": str(self.setup), "fresnel": self.fresnel, "m": self.m, "error": self.error,
            "bar": self.bar, "resolves": self.resolves, "passed": self.passed, "views": len(self.views),
        }  # fmt: skip


def _noisy(view: View) -> tuple[NDArray[np.float64], ...]:
    """Measured, expected and variance of the pixels that carry noise; where the weight is constant there is none.

    One channel: the random facet is common to all three, so they are no independent evidence. Where the variance is an
    estimate from a pixel's own few seeds, those that came out dark by chance have a small one too and would count for
    more: there all are summed.
    """
    assert view.variance is not None
    measured, expected, variance = (image[..., 0] for image in (view.measured, view.expected, view.variance))
    rounding = np.square(expected * 2.0**-15.5)
    if view.degrees > OWN_SEEDS:
        live = variance > rounding
        return measured[live], expected[live], variance[live]
    return tuple(np.sum(column, keepdims=True) for column in (measured, expected, variance + rounding))


def limit(tests: int) -> float:
    """Two-sided 1 % limit of a standard normal value, Sidak-corrected for ``tests`` of them."""
    return float(norm.isf((1.0 - 0.99 ** (1.0 / tests)) / 2.0))


def surely_seen(error: float, noisy_rows: int = NOISY_ROWS) -> float:
    """What every row has to resolve so that noise hides an ``error`` of their reference but once in a hundred plans."""
    return error / (1.0 + limit(2 * noisy_rows) / limit(noisy_rows))


def share_within(z: NDArray[np.float64], noisy_rows: int = NOISY_ROWS) -> float:
    """Share of pixel-channels within the Sidak limit for all of them.

    Of fewer than 400 none may be beyond, so that there the limit is for those of all of the plan's ``noisy_rows``.
    """
    return float(np.mean(np.abs(z) <= limit(z.size if z.size >= 400 else z.size * noisy_rows)))


def spread_z(z: NDArray[np.float64]) -> float:
    """Z of the mean of z^2 over independent pixels (one channel: all share the random facet); 1 is expected.

    A frozen hash shows here: its noise does not fall with samples. Values are cut at 4 so that a pixel of rare hits
    does not decide; cut normal squares have mean 0.9989 and variance 1.98.
    """
    cut = np.minimum(np.square(z[..., 0]), 16.0)
    live = cut[np.abs(z[..., 0]) > 1e-3]  # where the weight is constant, only rounding is left
    return max(0.0, float((live.mean() - 0.9989) / np.sqrt(1.98 / live.size))) if live.size > 30 else 0.0


# What each estimator should give


def direct_bar(m: float) -> float:
    """Largest difference allowed for the formula itself, as a share of the view's maximum."""
    return 2e-5 if m >= 0.1 else 1e-4 if m >= 0.02 else 1e-3


def closure_bar(m: float) -> float:
    """The same for Cycles' own lobe: its 1 - 1/cos^2 rounds by 4 * 2^-24, and exp() divides that by m^2."""
    return max(2e-4, 4.0 * ROUNDING / m**2)


def _unit(v: NDArray[np.float64]) -> NDArray[np.float64]:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def materials() -> dict[str, Preset]:
    """One material for each Fresnel kind, and a white one; m is set by each row."""
    test = 'name = "Test"\nmodel = "cook_torrance"\nm = 0.3\n[fresnel]\n{}\n[source]\ndata = "check"\n'
    return {
        "schlick": find("lecture/copper"),
        "dielectric": parse(test.format("eta = 1.5"), "check/dielectric", "check"),
        "conductor": parse(test.format("n = [0.27, 0.68, 1.32]\nk = [3.61, 2.62, 2.29]"), "check/conductor", "check"),
        "f82": parse(test.format("f0 = [0.7, 0.5, 0.3]\nf82_tint = [0.6, 0.9, 1.0]"), "check/f82", "check"),
        "white": parse(test.format("f0 = 1.0"), "check/white", "check"),
    }


def direct_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``direct`` at every theta_i, on the hemisphere and in the window, against the V-groove model."""
    return exact_row("direct", setup, fresnel, m, materials()[fresnel].with_parameters(m=m), direct_bar(m))


def closure_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``closure`` against the same model with Smith's G."""
    return native_row("closure", setup, fresnel, m)


def fit_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``fit`` against its mixture as the reference has it; how near that is to the V-groove model, tests say."""
    return native_row("fit", setup, fresnel, m)


def native_row(estimator: str, setup: Setup, fresnel: str, m: float) -> Row:
    """An estimator of Cycles' own lobes. Where their F is an approximation, that is a share of the lobe with F = 1."""
    preset = materials()[fresnel].with_parameters(m=m)
    approximate = fresnel_approximation(setup, fresnel)
    lobe = (materials()["white"].with_parameters(m=m) if approximate else preset).reference()
    return exact_row(estimator, setup, fresnel, m, preset, approximate or closure_bar(m), lobe=lobe)


def fresnel_approximation(setup: Setup, fresnel: str) -> float:
    """How far a native closure's Fresnel term may be off on this Blender, as a reflectance; 0 if it is exact."""
    return native_fresnel_error(fresnel, setup.backend)


def exact_row(
    estimator: str, setup: Setup, label: str, number: float, preset: Preset, bar: float, *,
    windows: tuple[float, ...] = (0.0, WINDOW), lobe: Model | None = None,
) -> Row:  # fmt: skip
    """An estimator without noise under a sun of zero size, at every theta_i; ``label`` and ``number`` name the row.

    There ``corrected`` and ``hybrid`` are the model itself. The bar is a share of the view's largest value, or of
    that of ``lobe``; for these two, where the model is next to 0 the mixture may not be, and what float32 rounds of it
    remains.
    """
    row = Row(estimator, setup, label, number)
    model, lobe = preset.reference(), lobe or preset.reference()
    native = estimator in NATIVE
    evaluate = rendered(model, estimator if native else "direct")
    scales = [rendered(lobe, estimator if native else "direct")]
    signed = estimator in {"corrected", "hybrid"}  # a difference of two equal numbers, which may round to below 0
    scales += [rendered(lobe, "fit")] if signed else []
    for theta_i in THETAS if setup is not SETUPS[1] else OSL_THETAS:
        for window in windows:
            geometry = gonio.Geometry(theta_i, window)
            wi, wo = geometry.wi(), geometry.wo()
            # Where the view holds less than 2^-64 of the lobe there is only what exp() leaves of its underflow.
            peak = float(np.max(scales[0](wi, wi * [-1.0, -1.0, 1.0])))
            scale = max(*(float(np.max(f(wi, wo))) for f in scales), 2.0**-64 * peak)
            image = measure(preset, setup, estimator, geometry)
            if signed and np.min(image) >= -bar * scale:
                image = np.maximum(image, 0.0)
            row.views.append(View(geometry, image, evaluate(wi, wo), bar, scale))
    return row


def sphere_row(fresnel: str, m: float) -> Row:
    """``direct`` as plain nodes on the point-cloud sphere, without any OSL."""
    preset = materials()[fresnel].with_parameters(m=m)
    F = preset.reference_fresnel()
    row = Row("direct, sphere", SETUPS[0], fresnel, m)
    for theta_i in (20.0, 70.0):
        with headless.quiet():
            radiance, normal = gonio.measure_sphere(preset, "nodes", "direct", theta_i)
        geometry = gonio.Geometry(theta_i)
        # The limb is left out: there a pixel's normal turns by 1/nz of what float32 rounds its place.
        seen = (normal[..., 2] > 0.2) & (normal @ geometry.wi() > 0.02)
        n = normal[seen]
        wi, wo = (
            to_local(np.broadcast_to(geometry.wi(), n.shape), n),
            to_local(np.broadcast_to([0.0, 0.0, 1.0], n.shape), n),
        )
        expected = cook_torrance(wi, wo, m, F) * wi[..., 2:]
        scale = float(np.max(expected))
        row.views.append(View(geometry, radiance[seen].astype(np.float64), expected, direct_bar(m), scale))
    return row


def to_local(w: NDArray[np.float64], n: NDArray[np.float64]) -> NDArray[np.float64]:
    """``w`` in a frame whose z axis is ``n``; any azimuth will do for an isotropic model."""
    x = _unit(np.cross(n, np.where(np.abs(n[..., :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])))
    return _unit(np.stack([dot(w, x), dot(w, np.cross(n, x)), dot(w, n)], axis=-1))


def furnace_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``mirror`` under a uniform white world: the directional albedo."""
    preset = materials()[fresnel].with_parameters(m=m)
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32))
    mean, square = furnace_moments(preset.reference_fresnel(), m)
    variance = np.maximum(square - mean**2, 0.0) / FURNACE_SAMPLES
    measured = measure(preset, setup, "mirror", geometry, samples=FURNACE_SAMPLES)
    return Row("mirror, furnace", setup, fresnel, m, [View(geometry, measured, mean, variance=variance)])


@cache
def furnace_moments(fresnel: Fresnel, m: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """E[w] and E[w^2] of ``mirror``'s weight for each pixel of a furnace, (32, 32, 3)."""
    column = gonio.Geometry(furnace=True, resolution=(32, 32)).wo()[:, :1]
    moments = albedo(CookTorrance(m, fresnel), column), vgroove_albedo(column, m, fresnel, moment=2)
    mean, square = (np.broadcast_to(image, (32, 32, 3)) for image in moments)
    return mean, square


def sun_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``mirror`` under a sun of 10 to 30 degrees: the mean of f over its disc, weighted by the cosine."""
    preset = materials()[fresnel].with_parameters(m=m)
    model = preset.reference()
    samples, angle = SUN_SAMPLES[m], SUN_ANGLES[m]
    row = Row("mirror, sun", setup, fresnel, m)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, window=20.0, resolution=(16, 16), sun_angle=angle)
        wo = geometry.wo()
        mean, square = np.zeros_like(wo), np.zeros_like(wo)
        directions, weights = disc(geometry)
        # The disc has the radiance that lights a facing plane with 1/cos(theta_i).
        radiance = 1.0 / np.cos(np.radians(theta_i)) / (np.pi * np.sin(np.radians(angle / 2)) ** 2)
        for wi, weight in zip(directions, weights, strict=True):
            f_cos = model.evaluate(wi, wo) * max(wi[2], 0.0)
            density = model.pdf(wi, wo)[..., None]
            mean += weight * radiance * f_cos
            square += weight * radiance**2 * f_cos**2 / np.where(density > 0, density, 1.0)
        measured = measure(preset, setup, "mirror", geometry, samples=samples)
        hits = samples * mean[..., 0] / radiance
        row.views.append(pooled_view(geometry, hits, measured, mean, square, samples))
    return row


def disc(
    geometry: gonio.Geometry, rings: int = 16, spokes: int = 48
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions (N, 3) over the sun's disc and their solid angles (N,)."""
    x, weight = gauss_legendre(rings)
    height = 1.0 - np.cos(np.radians(geometry.sun_angle / 2))  # solid angle is even in the cosine
    cos, phi = 1.0 - height * x, 2.0 * np.pi * (np.arange(spokes) + 0.5) / spokes
    sin = np.sqrt(1.0 - cos**2)
    axis, across = geometry.wi(), np.array([0.0, 1.0, 0.0])
    up = np.cross(axis, across)
    ring = np.cos(phi)[:, None] * across + np.sin(phi)[:, None] * up
    directions = cos[:, None, None] * axis + sin[:, None, None] * ring
    weights = np.repeat(weight * height * 2.0 * np.pi / spokes, spokes)
    return directions.reshape(-1, 3), weights


def pooled_view(
    geometry: gonio.Geometry, hits: NDArray[np.float64], measured: NDArray[np.float64],
    mean: NDArray[np.float64], square: NDArray[np.float64], samples: int,
) -> View:  # fmt: skip
    """``measured`` beside the moments of its samples.

    Below 25 expected hits a count is too skewed for a normal limit: such pixels are judged together.
    """
    variance = np.maximum(square - mean**2, 0.0) / samples
    measured, mean, variance = (pool(image, hits) for image in (measured, mean, variance))
    return View(geometry, measured, mean, variance=variance)


def pool(image: NDArray[np.float64], hits: NDArray[np.float64], enough: float = 25.0) -> NDArray[np.float64]:
    """Sums of pixels (N, 3), taken together in order of expected hits until each group expects ``enough``."""
    order = np.argsort(hits.ravel())
    groups = np.floor(np.cumsum(np.minimum(hits.ravel()[order], enough)) / enough).astype(int)
    groups = np.minimum(groups, max(groups.max() - 1, 0))  # the last may not be full
    sums = np.zeros((groups.max() + 1, 3))
    np.add.at(sums, groups, image.reshape(-1, 3)[order])
    return sums


def measure(
    preset: Preset, setup: Setup, estimator: str, geometry: gonio.Geometry, samples: int = 1, seed: int = 0
) -> NDArray[np.float64]:
    """The gonioreflectometer's image of a preset, without Blender's chatter."""
    with headless.quiet():
        image = gonio.measure_preset(
            preset, setup.backend, estimator, geometry, samples=samples, seed=seed, shading_osl=setup.shading_osl
        )
    return image.astype(np.float64)


def plan() -> list[tuple[Callable[..., Row], tuple[Any, ...]]]:
    """Every row of the table, as the function that measures it and its arguments."""
    rows: list[tuple[Callable[..., Row], tuple[Any, ...]]] = []
    for setup in SETUPS:
        for fresnel in ("schlick", "dielectric", "conductor"):
            few = setup is SETUPS[1]
            rows += [(direct_row, (setup, fresnel, m)) for m in (OSL_SLOPES if few else DIRECT_SLOPES)]
            slopes = OSL_SLOPES if few else CLOSURE_SLOPES
            rows += [(row, (setup, fresnel, m)) for row in (closure_row, fit_row) for m in slopes]
        rows += [(row, (setup, "f82", 0.3)) for row in (direct_row, closure_row, fit_row)]
        for m in MIRROR_SLOPES:
            rows += [(furnace_row, (setup, fresnel, m)) for fresnel in ("white", "schlick")]
        if setup is not SETUPS[1]:  # nodes run as OSL draw the very same facets: the furnace shows it
            rows += [(sun_row, (setup, "schlick", m)) for m in MIRROR_SLOPES]
    rows += [(sphere_row, (fresnel, m)) for fresnel in ("schlick", "dielectric", "conductor") for m in SPHERE_SLOPES]
    return side_by_side(rows)


def side_by_side(rows: list[Any]) -> list[Any]:
    """Rows of one material in all setups together, so that what the reference says of it is computed once."""
    first: dict[Any, int] = {}

    def place(row: Any) -> int:
        measure_row, arguments, *more = row
        what = measure_row, tuple(part for part in arguments if not isinstance(part, Setup)), str(more)
        return first.setdefault(what, len(first))

    return sorted(rows, key=place)


def run() -> Iterator[Row]:
    """Measure the whole plan, row by row."""
    for measure_row, arguments in plan():
        yield measure_row(*arguments)


def versions() -> dict[str, str]:
    """What measured: for tables and JSON."""
    return {"blender": ".".join(map(str, bpy.app.version)), "numpy": np.__version__}
