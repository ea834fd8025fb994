# SPDX-License-Identifier: GPL-3.0-or-later
"""The fit's numbers, as the reference reads them, for node groups and as an OSL header."""

from __future__ import annotations

from dataclasses import asdict

from ..addon.reference import cycles, oren_nayar_fit
from ..addon.reference.oren_nayar_fit import LAMBERT, MEAN, table
from .polynomial import horner_text, share_text

__all__ = ["LAMBERT", "MEAN", "header", "table"]


def header() -> str:
    """What OSL shaders include.

    ``fit_NAME(kind, x)``; ``fit_roughness(kind, i)``, k and c; ``fit_share_at(kind, y, n, bound)``; ``FIT_MEAN``,
    ``FIT_LAMBERT`` and ``FIT_POWER(c)``, c as light has it that bounced more than once.
    """
    functions = ["// Written from addon/reference/oren_nayar_fit.toml; kind: 0 full, 1 qualitative"]
    power = " * ".join(["(c)"] * cycles.oren_nayar_power())
    functions += [f"#define FIT_MEAN {MEAN}", f"#define FIT_LAMBERT {LAMBERT}", f"#define FIT_POWER(c) ({power})"]
    full, qualitative = (asdict(table(kind)) for kind in oren_nayar_fit.KINDS)
    functions += [
        _by_kind(f"fit_{name}", "float x", _horner(full[name]), _horner(qualitative[name]))
        for name in ("albedo", "retro", "native")
    ]
    k = (f"i == 0 ? {first} : {second}" for first, second in (full["roughness"], qualitative["roughness"]))
    functions.append(_by_kind("fit_roughness", "int i", *k))
    functions += [share_text(f"fit_share_{kind}", table(kind).share) for kind in oren_nayar_fit.KINDS]
    both = (f"fit_share_{kind}(y, n, bound)" for kind in oren_nayar_fit.KINDS)
    functions.append(_by_kind("fit_share_at", "float y, float n, float bound", *both))
    return "\n".join(functions) + "\n"


def _by_kind(name: str, arguments: str, full: str, qualitative: str) -> str:
    return f"float {name}(int kind, {arguments})\n{{\n    if (kind == 0) return {full};\n    return {qualitative};\n}}"


def _horner(coefficients: tuple[float, ...]) -> str:
    return horner_text([str(c) for c in coefficients], "x")
