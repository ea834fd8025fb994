# SPDX-License-Identifier: GPL-3.0-or-later
"""Blinn-Phong's lobe, for the builders that it shares with Phong (``phong_closure`` and so on)."""

from __future__ import annotations

from math import log, pi
from typing import TYPE_CHECKING, Any

from ..addon.models.blinn_phong import MODEL
from . import phong
from ._tree import dot, exp, maximum, normalize, scale
from .cosine_power import cosine_power
from .visible_facet import visible_facet

if TYPE_CHECKING:
    from ..addon.models import Form
    from ._tree import Tree, Value


def variant(_form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    return "", {"of": BLINN_PHONG}


def _over(n: Value) -> Value:
    """2^(-n/2) + n."""
    return exp(n * (-0.5 * log(2.0))) + n


def _value(tree: Tree, N: Value, wi: Value, wo: Value, n: Value) -> Value:
    """(n + 2)(n + 4)/(8 pi (2^(-n/2) + n)) (n.h)^n."""
    scaled = (n + 2.0) * (n + 4.0) / (8.0 * pi * _over(n))
    return scaled * cosine_power(tree, normalize(wi + wo), N, n)


def _draw(tree: Tree, N: Value, wo: Value, n: Value) -> tuple[Value, Value]:
    """h by (n + 2)/(2 pi) (n.h)^(n + 1), as the view sees it; weight (n + 4)/(2^(-n/2) + n) (n.l)(n.v)/G1."""
    h = visible_facet(tree, N, wo, n + 2.0, phong.steep)
    with tree.frame("Weight, (n.v)/G1 = max(n.v, (v.h)/(2 n.h))"):
        vh, no = maximum(dot(wo, h), 0.0), maximum(dot(N, wo), 0.0)
        wi = scale(h, 2.0 * vh) - wo
        seen = maximum(no, vh / (2.0 * dot(N, h)))
        return h, (n + 4.0) / _over(n) * maximum(dot(N, wi), 0.0) * seen


BLINN_PHONG = phong.Lobe(MODEL, _value, _draw)
