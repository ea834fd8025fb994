# SPDX-License-Identifier: GPL-3.0-or-later
"""What all groups of Phong and Blinn-Phong share: the artist's inputs, and a lobe as their builders need it.

Sources: as ``addon/reference/phong.py``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, Any

from ..addon.models.phong import MODEL
from ..addon.reference import phong_fit
from . import phong_table, shading_normal
from ._tree import cos, dot, exp, log, maximum, normalize, scale, sin, sqrt, tangents
from .cosine_power import cosine_power
from .osl_script import script as osl_script
from .parameters import add_input
from .random_numbers import random_numbers, stream

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Node

    from ..addon.models import Form, Model
    from ._tree import Number, Tree, Value


@dataclass(frozen=True)
class Lobe:
    """A cosine lobe.

    value: (tree, N, wi, wo, n) -> the lobe in 1/sr, of albedo 1 head-on; without asking whether both are above.
    draw: (tree, N, wo, n) -> a facet for each sample, and the weight lobe cos / density of the wi that it mirrors to.
    """

    model: Model
    value: Callable[[Tree, Value, Value, Value, Value], Value]
    draw: Callable[[Tree, Value, Value, Value], tuple[Value, Value]]

    @property
    def table(self) -> phong_fit.Table:
        """The numbers of ``closure``."""
        return phong_fit.tables()[self.model.name]

    def slope(self, n: Value) -> Value:
        """m of the Beckmann lobe that is as wide: Blender's Roughness, squared."""
        return self.model.parameters[-1].scale.to_input(n) ** 2


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs: both colours, the exponent n, and the normal as linked (or not)."""

    albedo: Value
    specular: Value
    n: Value
    normal: Value


def interface(tree: Tree, of: Lobe) -> Inputs:
    """Base Color; Specular Color; Roughness; Normal. The same for every estimator and backend."""
    albedo, specular, n = (add_input(tree, one) for one in of.model.parameters)
    return Inputs(albedo, specular, n, shading_normal.interface(tree))


def script(tree: Tree, estimator: str, of: Lobe, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``phong_ESTIMATOR`` of this lobe, fed by these inputs."""
    variant = f"phong_{estimator} {of.model.name}", {phong_table.NAME: phong_table.header(of.model.name)}
    given = {"albedo": inputs.albedo, "specular": inputs.specular, "exponent": inputs.n, "Normal": inputs.normal}
    return osl_script(tree, f"phong_{estimator}", variant, **given, **more)


def variant(_form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    return "", {"of": PHONG}


def steep(u: Value, power: Value) -> Value:
    """tan of the angle whose density over solid angle is cos^(power - 1): cos = (1 - u)^(1/power).

    tan^2 = e^x - 1 = 2 sinh(x/2) e^(x/2), x = -2 log(1 - u) / power, which keeps its digits where x is small.
    """
    half = -log(maximum(1.0 - u, 1e-7)) / power  # u may round to 1
    return sqrt(2.0 * u.tree.math("SINH", half) * exp(half))


def _value(tree: Tree, N: Value, wi: Value, wo: Value, n: Value) -> Value:
    """(n + 2)/(2 pi) cos^n a."""
    return (n + 2.0) / (2.0 * pi) * cosine_power(tree, wi, _mirrored(N, wo), n)


def _draw(tree: Tree, N: Value, wo: Value, n: Value) -> tuple[Value, Value]:
    """wi by (n + 1)/(2 pi) cos^n a about the mirror direction; weight (n + 2)/(n + 1) n.l."""
    u1, u2, _ = random_numbers(tree, stream("DIRECTION"))
    with tree.frame("wi about the mirror direction"):
        R = _mirrored(N, wo)
        T, B = tangents(R)
        tan, phi = steep(u1, n + 1.0), 2.0 * pi * u2
        wi = normalize(R + scale(T, tan * cos(phi)) + scale(B, tan * sin(phi)))
    with tree.frame("Weight"):
        return normalize(wi + wo), (n + 2.0) / (n + 1.0) * maximum(dot(N, wi), 0.0)


def _mirrored(N: Value, wo: Value) -> Value:
    return scale(N, 2.0 * dot(N, wo)) - wo


PHONG = Lobe(MODEL, _value, _draw)
