# SPDX-License-Identifier: GPL-3.0-or-later
"""What each estimator renders of a model, bias and all; that of an unbiased one is the model itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .car_paint import CarPaint
from .cook_torrance import CookTorrance, Smooth, cook_torrance
from .cook_torrance_albedo import quick_albedo
from .cook_torrance_fit import cook_torrance_fit, cook_torrance_hybrid
from .distributions import smith_g
from .hybrid import DEFAULT_BOUND
from .oren_nayar import OrenNayar
from .oren_nayar_fit import closure_roughness, cycles_diffuse, oren_nayar_fit, oren_nayar_hybrid
from .sum import Sum

if TYPE_CHECKING:
    from collections.abc import Callable

    from .directions import Floats
    from .model import Model

    Brdf = Callable[[Any, Any], Floats]


def rendered(model: Model, estimator: str, bound: float = DEFAULT_BOUND) -> Brdf:
    """f(wi, wo) in 1/sr, (..., 3), as ``estimator`` has it; ``bound`` is that of ``hybrid``.

    ``fit``: the mixture. ``closure``: Cycles' own model. ``hybrid``: max(f, c f_fit). Others: f.
    A coupled ``Sum`` has E_s from three facets, as shaders do (``quick_albedo``).
    """
    if isinstance(model, Sum):
        return _sum(model, *(rendered(part, estimator, bound) for part in (model.diffuse, model.specular)))
    if isinstance(model, CarPaint):
        base, *lobes = (rendered(part, estimator, bound) for part in (model.base, *model.lobes))
        return lambda wi, wo: base(wi, wo) + sum(s * lobe(wi, wo) for s, lobe in zip(model.s, lobes, strict=True))
    if isinstance(model, CookTorrance):
        return _cook_torrance(model, estimator, bound)
    if isinstance(model, OrenNayar):
        return _oren_nayar(model, estimator, bound)
    return model.evaluate


def _cook_torrance(model: CookTorrance, estimator: str, bound: float) -> Brdf:
    m, F = model.m, model.fresnel
    if estimator == "fit":
        return lambda wi, wo: cook_torrance_fit(wi, wo, m, F)
    if estimator == "closure":
        return lambda wi, wo: cook_torrance(wi, wo, m, F, smith_g(wi, wo, m))
    if estimator == "hybrid":
        return lambda wi, wo: cook_torrance_hybrid(wi, wo, m, F, bound)
    return model.evaluate


def _oren_nayar(model: OrenNayar, estimator: str, bound: float) -> Brdf:
    rho, sigma, qualitative = model.albedo, model.sigma, model.qualitative
    if estimator == "fit":
        return lambda wi, wo: oren_nayar_fit(wi, wo, rho, sigma, qualitative=qualitative)
    if estimator == "closure":
        roughness = closure_roughness(sigma, qualitative=qualitative)
        return lambda wi, wo: cycles_diffuse(wi, wo, rho, roughness)
    if estimator == "hybrid":
        return lambda wi, wo: oren_nayar_hybrid(wi, wo, rho, sigma, bound, qualitative=qualitative)
    return model.evaluate


def _sum(model: Sum, diffuse: Brdf, specular: Brdf) -> Brdf:
    return lambda wi, wo: quick_diffuse_share(model, wo) * diffuse(wi, wo) + model.s * specular(wi, wo)


def quick_diffuse_share(model: Sum, wo: Any) -> Floats:
    """The diffuse part's weight as shaders have it, (..., 1): d, or d (1 - s E_s), E_s that of the strongest channel.

    Raises TypeError for a coupled sum whose specular part is not Cook-Torrance or smooth.
    """
    if not model.coupled:
        return np.full(1, model.d)
    specular = model.specular
    if not isinstance(specular, CookTorrance | Smooth):
        message = f"a coupled Sum needs a CookTorrance or Smooth specular part, got {type(specular).__name__}"
        raise TypeError(message)
    m = specular.m if isinstance(specular, CookTorrance) else 0.0
    return model.d * (1.0 - model.s * np.max(quick_albedo(wo, m, specular.fresnel), axis=-1, keepdims=True))
