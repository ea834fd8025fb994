# SPDX-License-Identifier: GPL-3.0-or-later
"""What OSL shaders have to know of a cosine lobe, as a header: which it is, and the numbers of its ``closure``."""

from __future__ import annotations

from ..addon.reference import phong_fit
from .polynomial import function_text

NAME = "phong_table.h"


def header(model: str) -> str:
    """``ROUND``, ``NARROWER``, ``LAMBERT``, ``KNEE``; ``fit_weight(q, m)`` and ``fit_energy(q, m)``."""
    of = phong_fit.tables()[model]
    lines = [f"#define ROUND {int(of.round)}  // about the mirror direction; else about the normal"]
    lines += [f"#define NARROWER {of.narrower}", f"#define LAMBERT {of.lambert}", f"#define KNEE {phong_fit.KNEE}"]
    for name, rows in (("weight", of.weight), ("energy", of.energy)):
        written = [[f"{number:.9g}" for number in row] for row in rows]
        lines.append(function_text("float", f"fit_{name}", "float q, float m", written, "float y = q, n = m;"))
    return "\n".join(lines)
