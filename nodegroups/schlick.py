# SPDX-License-Identifier: GPL-3.0-or-later
"""Fresnel reflectance after Schlick 1994: F = F0 + (1 - F0) (1 - cos)^5, per colour channel."""

from ..addon.models.fresnel import F0
from ._tree import Tree, Value, clamp
from .parameters import add_input

NAME = ".VGroove Schlick"
REVISION = 4


def interface(tree: Tree) -> dict[str, Value]:
    """The artist's inputs, by the reference's parameter names."""
    return {"f0": add_input(tree, F0)}


def build(tree: Tree) -> None:
    f0 = interface(tree)["f0"]
    cosine = tree.input_float("Cosine", 1.0, low=0.0, high=1.0, tip="wo . h, view against half vector")
    with tree.frame("Schlick 1994"):
        f = f0 + (1.0 - f0) * (1.0 - clamp(cosine)) ** 5
    tree.output_color("F", f, tip="Fresnel reflectance")
