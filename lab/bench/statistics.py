# SPDX-License-Identifier: GPL-3.0-or-later
"""Bias and noise of a render, separated by independent seeds. Imports NumPy alone.

I_s are S pictures of one estimator by seeds s, T_a are A independent pictures of the truth; the mean is over P pixels
and three channels, and all is a share of the truth's root mean square.

    bias^2  = mean of (I_s - T_a)(I_t - T_b) over all s != t, a != b: no picture is multiplied with itself, so that the
              noise of neither is counted, and the figure is unbiased; it falls below 0 where there is no bias to tell
    noise^2 = variance of I_s between seeds
    rmse^2  = bias^2 + noise^2, of one picture
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray


@dataclass(frozen=True)
class Error:
    """Bias and noise of a picture. bias2 may be negative; bias2_error is its standard error."""

    bias2: float
    bias2_error: float
    noise: float


def error(pictures: NDArray[np.floating], truths: NDArray[np.floating]) -> Error:
    """Of S pictures (S, P, 3) against A truths (A, P, 3). A single truth is taken to be without noise.

    The standard error of bias^2, where v is the variance, in each pixel, of the mean difference (by S seeds and A
    truths) and b that difference: var = (2 v^2 + 4 b^2 v) / P^2, summed over pixels. Pairs of S normal pictures have
    S / (S - 1) times the first term, and the square of an estimated v is (S + 1) / (S - 1) times its own: that makes up
    for it. Channels see the same samples and are taken to be wholly correlated. ValueError if there are fewer than two
    pictures.
    """
    seen, exact = np.asarray(pictures, np.float64), np.asarray(truths, np.float64)
    s, a = len(seen), len(exact)
    if s < 2:
        message = f"bias and noise need two pictures to be separated, got {s}"
        raise ValueError(message)
    scale2 = scale(exact) ** 2
    variance = np.var(seen, axis=0, ddof=1)
    doubt = variance / s
    off = seen[:, None] - exact[None]  # (S, A, P, 3)
    total = off.sum(axis=(0, 1))
    if a == 1:
        products = total**2 - np.sum(off[:, 0] ** 2, axis=0)
        pairs = s * (s - 1)
    else:
        doubt = doubt + np.var(exact, axis=0, ddof=1) / a
        same_picture = np.sum(off.sum(axis=1) ** 2, axis=0)
        same_truth = np.sum(off.sum(axis=0) ** 2, axis=0)
        products = total**2 - same_picture - same_truth + np.sum(off**2, axis=(0, 1))
        pairs = s * (s - 1) * a * (a - 1)
    bias2 = products / pairs
    spread = np.sqrt(np.sum(2.0 * doubt**2 + 4.0 * np.maximum(bias2, 0.0) * doubt, axis=0)).mean() / len(bias2)
    return Error(float(np.mean(bias2) / scale2), float(spread / scale2), float(np.sqrt(np.mean(variance) / scale2)))


def scale(truths: NDArray[np.floating]) -> float:
    """Root mean square of the truth, without the noise of its A pictures (A, P, 3)."""
    exact = np.asarray(truths, np.float64)
    a = len(exact)
    if a == 1:
        return float(np.sqrt(np.mean(exact**2)))
    products = (exact.sum(axis=0) ** 2 - np.sum(exact**2, axis=0)) / (a * (a - 1))
    return float(np.sqrt(np.mean(products)))


def slope(pictures: Mapping[int, NDArray[np.floating]]) -> tuple[float, float]:
    """Of log noise over log samples by least squares, and its standard error; pictures: (S, P, 3) by sample count.

    The error is a jackknife's over groups of seeds, as many as the fewest seeds of a count. So it needs no law of what
    a sample is worth: rare events, and pixels that are alike, are in it. ValueError if there are fewer than two counts.
    """
    if len(pictures) < 2:
        message = f"a slope needs two sample counts, got {len(pictures)}"
        raise ValueError(message)
    x = np.log(list(pictures))
    x = (x - x.mean()) / np.sum((x - x.mean()) ** 2)
    groups = min(map(len, pictures.values()))
    group = {samples: np.arange(len(of)) % groups for samples, of in pictures.items()}

    def without(left: int) -> float:
        kept = (of[group[samples] != left] for samples, of in pictures.items())
        return float(x @ [0.5 * np.log(np.mean(np.var(one, axis=0, ddof=1))) for one in kept])

    others = np.array([without(left) for left in range(groups)])
    return without(-1), float(np.sqrt((groups - 1) / groups * np.sum((others - others.mean()) ** 2)))


RARE = 0.25  # of a sample's variance, as later counts have it: what scatters of four pictures is far less


def resolved(noise: Sequence[float], samples: Sequence[int]) -> list[bool]:
    """Whether the noise at each count includes the rare events, for contenders whose rays rarely hit a light.

    N noise^2, the variance of one sample, does not grow with N. Where it is under ``RARE`` of what a later count has,
    no picture has met yet what most of the light comes from: the noise is not to be seen, and looks like bias.
    """
    one = np.asarray(samples) * np.square(noise)
    later = np.maximum.accumulate(one[::-1])[::-1]
    return [bool(own >= RARE * most) for own, most in zip(one, later, strict=True)]
