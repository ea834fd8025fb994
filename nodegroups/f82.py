# SPDX-License-Identifier: GPL-3.0-or-later
"""Fresnel reflectance in the F82-tint form: Schlick's formula, multiplied by a tint at 82 degrees, per colour channel.

F = S(cos) - b cos (1 - cos)^6, b = S(1/7) (1 - tint) / (1/7 (1 - 1/7)^6). Source: Kutz, Hasan & Edmondson 2021.
"""

from ..addon.models.fresnel import F82_TINT
from ..addon.reference.fresnel import F82_COSINE
from . import ensure, schlick
from ._tree import Tree, Value, clamp, maximum
from .parameters import add_input

NAME = ".VGroove F82"
REVISION = 4


def interface(tree: Tree) -> dict[str, Value]:
    """The artist's inputs, by the reference's parameter names."""
    return {**schlick.interface(tree), "f82_tint": add_input(tree, F82_TINT)}


def build(tree: Tree) -> None:
    f0, tint = interface(tree).values()
    cosine = clamp(tree.input_float("Cosine", 1.0, low=0.0, high=1.0, tip="wo . h, view against half vector"))
    with tree.frame("b cos (1 - cos)^6"):
        b = _schlick(tree, f0, F82_COSINE) * (1.0 - tint) / (F82_COSINE * (1.0 - F82_COSINE) ** 6)
        dip = b * (cosine * (1.0 - cosine) ** 6)
    tree.output_color("F", maximum(_schlick(tree, f0, cosine) - dip, 0.0), tip="Fresnel reflectance")


def _schlick(tree: Tree, f0: Value, cosine: Value | float) -> Value:
    node = tree.group(ensure(schlick.NAME, schlick.REVISION, schlick.build), Base_Color=f0, Cosine=cosine)
    return Value(tree, node.outputs["F"])
