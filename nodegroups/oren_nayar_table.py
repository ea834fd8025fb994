# SPDX-License-Identifier: GPL-3.0-or-later
"""The fit's numbers, as the reference reads them, for node groups and as an OSL header."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from ..addon.reference import oren_nayar_fit
from ..addon.reference.oren_nayar_fit import MEAN, TABLES

if TYPE_CHECKING:
    from ._tree import Value

__all__ = ["MEAN", "TABLES", "header", "polynomial"]


def polynomial(coefficients: tuple[float, ...], x: Value) -> Value:
    """Lowest power first, by Horner's rule."""
    *rest, last = coefficients
    value = last * x + rest.pop()
    for coefficient in reversed(rest):
        value = value * x + coefficient
    return value


def header() -> str:
    """``fit_NAME(kind, x)`` for each polynomial, ``fit_roughness(kind, i)`` for k and c, and ``FIT_MEAN``."""
    functions = ["// Written from addon/reference/oren_nayar_fit.toml; kind: 0 full, 1 qualitative"]
    functions.append(f"#define FIT_MEAN {MEAN}")
    full, qualitative = (asdict(TABLES[kind]) for kind in oren_nayar_fit.KINDS)
    for name in full:
        written = _choice if name == "roughness" else _horner
        signature = f"float fit_{name}(int kind, {'int i' if name == 'roughness' else 'float x'})"
        functions.append(f"{signature}\n{{\n    if (kind == 0) return {written(full[name])};")
        functions.append(f"    return {written(qualitative[name])};\n}}")
    return "\n".join(functions) + "\n"


def _choice(pair: tuple[float, float]) -> str:
    return f"i == 0 ? {pair[0]} : {pair[1]}"


def _horner(coefficients: tuple[float, ...]) -> str:
    *rest, text = map(str, coefficients)
    for coefficient in reversed(rest):
        text = f"({text}) * x + {coefficient}"
    return text
