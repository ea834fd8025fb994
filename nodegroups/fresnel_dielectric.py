# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact Fresnel reflectance of a transparent medium, as ``fresnel_dielectric`` of the reference."""

from ..addon.models.fresnel import ETA
from ._tree import Tree, Value, clamp, maximum, sqrt
from .parameters import add_input

NAME = ".VGroove Fresnel Dielectric"
REVISION = 3


def interface(tree: Tree) -> dict[str, Value]:
    """The artist's inputs, by the reference's parameter names."""
    return {"eta": add_input(tree, ETA)}


def build(tree: Tree) -> None:
    eta = interface(tree)["eta"]
    cosine = tree.input_float("Cosine", 1.0, low=0.0, high=1.0, tip="wo . h, view against half vector")
    c = maximum(clamp(cosine), 1e-7)  # at 0 exactly, total reflection would read 0/0
    with tree.frame("g^2 = eta^2 + c^2 - 1 (0 in total reflection, which gives F = 1)"):
        beyond = (eta - 1.0) * (eta + 1.0)
        g = sqrt(c * c + beyond)
    with tree.frame("Cook & Torrance 1982: F = 1/2 s^2 (1 + p^2)"):
        s = (g - c) / (g + c)
        p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
        f = 0.5 * s * s * (1.0 + p * p)
    tree.output_float("F", f, tip="Fresnel reflectance")
