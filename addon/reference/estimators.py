# SPDX-License-Identifier: GPL-3.0-or-later
"""What each estimator renders of a model, bias and all; that of an unbiased one is the model itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .hybrid import DEFAULT_BOUND

if TYPE_CHECKING:
    from .model import Brdf, Model


def rendered(model: Model, estimator: str, bound: float = DEFAULT_BOUND) -> Brdf:
    """f(wi, wo) in 1/sr, (..., 3), as ``estimator`` has it; ``bound`` is that of ``hybrid``.

    ``fit``: the mixture. ``closure``: Cycles' own model. ``hybrid``: max(f, c f_fit). Others: f.
    A model whose estimators have a bias says what they render by a method ``rendered(estimator, bound)``.
    """
    biased = getattr(model, "rendered", None)
    return biased(estimator, bound) if biased else model.evaluate
