# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact Fresnel reflectance of an absorbing medium, per colour channel, as ``fresnel_conductor`` of the reference.

Nodes have no complex numbers: with a the real part of g, A = |g|^2, the square roots are written out.
"""

from ..addon.models.fresnel import K, N
from ._tree import Tree, Value, clamp, sqrt
from .parameters import add_input

NAME = ".VGroove Fresnel Conductor"
REVISION = 4


def interface(tree: Tree) -> dict[str, Value]:
    """The artist's inputs, by the reference's parameter names."""
    return {"n": add_input(tree, N), "k": add_input(tree, K)}


def build(tree: Tree) -> None:
    n, k = interface(tree).values()
    cosine = clamp(tree.input_float("Cosine", 1.0, low=0.0, high=1.0, tip="wo . h, view against half vector"))
    with tree.frame("g^2 = (n + ik)^2 - sin^2; A = |g|^2, a = Re g"):
        c2 = cosine * cosine
        s2 = 1.0 - c2
        real = (n - k) * (n + k) - s2
        nk = n * k
        A = sqrt(real * real + 4.0 * nk * nk)
        ac = sqrt(0.5 * (A + real)) * cosine
    with tree.frame("r_s^2, r_p^2 (Born & Wolf 14.2)"):
        rs = (A + c2 - 2.0 * ac) / (A + c2 + 2.0 * ac)
        Ac2, s4, acs2 = A * c2, s2 * s2, 2.0 * ac * s2
        rp = rs * (Ac2 + s4 - acs2) / (Ac2 + s4 + acs2)
    tree.output_color("F", 0.5 * (rs + rp), tip="Fresnel reflectance")
