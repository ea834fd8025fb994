# SPDX-License-Identifier: GPL-3.0-or-later
"""What ``vgroove check`` measures and how it judges: rows of views, Cycles' image beside the NumPy reference.

Estimators without noise (``closure``, ``direct``) are compared by their largest difference, as a share of the
reference's maximum in the same view. ``mirror`` is noisy and is judged by Z-tests whose variances come from the
reference, so nothing is tuned. docs/testing.md derives every bar.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from scipy.stats import norm
from scipy.stats import t as student

from ..sidak import limit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from ...addon.blender import gonio

NOISY_ROWS = 32  # rows judged by Z-tests in a plan that does not say how many it has
MAX_PER_PIXEL_DOF = 100  # degrees of freedom; a variance that has more was pooled over many pixels
ROUNDING = 2.0**-24  # float32 rounds a number near 1 by up to this much
# A sum of N float32 samples rounds by sqrt(N) 2^-24 of the mean at random; N <= 2^17 gives this.
FLOAT_SUM = 2.0**-15.5


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
    """A measured image beside the reference for each of its pixels.

    measured, expected: f in 1/sr, or the albedo under a white sky, (..., 3): (H, W, 3), or the pixels that are compared
    (N, 3), or sums over groups of them.
    bar: the largest difference allowed, as a share of ``scale``, which has the unit of the images; without noise.
    variance: of ``measured``, in the square of its unit and of its shape; None where there is no noise.
    degrees: of freedom, of a variance that is itself estimated from images; infinite where the reference gives it.
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
        error = np.sqrt(self.variance + np.square(self.expected * FLOAT_SUM))
        difference = self.measured - self.expected
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(difference == 0, 0.0, difference / error)
        if np.isinf(self.degrees):
            return ratio
        return np.sign(ratio) * norm.isf(student.sf(np.abs(ratio), self.degrees))


@dataclass
class Row:
    """One line of the table: an estimator in one setup, of one material, over all its views.

    test: the estimator, and what lights it. model: its name. variant: its Fresnel term or kind; "" if it has one only.
    at: the numbers that the row is measured at, by the model's names of them (m, sigma in radians, eta, ...).
    noisy_rows: how many rows of its plan are judged by Z-tests, for Sidak's correction.
    """

    test: str
    setup: Setup
    model: str = ""
    variant: str = ""
    at: Mapping[str, float] = field(default_factory=dict)
    views: list[View] = field(default_factory=list)
    noisy_rows: int = NOISY_ROWS

    @property
    def is_noisy(self) -> bool:
        return self.views[0].variance is not None

    @property
    def error(self) -> float:
        """What is held to ``bar``, of the worst view: the largest difference as a share of the view's ``scale``.

        Of noisy rows the share of pixel-channels, 0 to 1, that are within the limit of chance.
        """
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
        """Z of the one number that scales all pixels together: finds a 1 % error that single pixels hide in noise.

        0 where no pixel carries noise: each alone is then held to its rounding.
        """
        return float(self._score() * np.sqrt(self._information())) if self._information() else 0.0

    @property
    def resolves(self) -> float:
        """The smallest common scale error that the row would turn red on, or its bar if it is free of noise."""
        if not self.is_noisy:
            return self.bar
        information = self._information()
        return float(limit(self.noisy_rows) / np.sqrt(information)) if information else FLOAT_SUM

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
            "test": self.test, "setup": str(self.setup), "model": self.model, "variant": self.variant,
            "at": dict(self.at), "error": self.error, "bar": self.bar, "resolves": self.resolves,
            "passed": self.passed, "views": len(self.views),
        }  # fmt: skip


Plan: TypeAlias = list[partial[Row]]  # each call measures a row


def _noisy(view: View) -> tuple[NDArray[np.float64], ...]:
    """Measured, expected and variance of the pixels that carry noise; where the weight is constant there is none.

    One channel: the random facet is common to all three, so they are no independent evidence. Where the variance is an
    estimate from a pixel's own few seeds, those that came out dark by chance have a small one too and would count for
    more: there all are summed.
    """
    assert view.variance is not None
    measured, expected, variance = (image[..., 0] for image in (view.measured, view.expected, view.variance))
    rounding = np.square(expected * FLOAT_SUM)
    if view.degrees > MAX_PER_PIXEL_DOF:
        live = variance > rounding
        return measured[live], expected[live], variance[live]
    return tuple(np.sum(column, keepdims=True) for column in (measured, expected, variance + rounding))


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


def side_by_side(plan: Plan) -> Plan:
    """The plan with the rows of one material in all setups together: the reference computes what they share once."""
    first: dict[Any, int] = {}

    def place(row: partial[Row]) -> int:
        material = tuple(part for part in row.args if not isinstance(part, Setup))
        return first.setdefault((row.func, material, str(row.keywords)), len(first))

    return sorted(plan, key=place)
