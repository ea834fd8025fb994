# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface normal, or what the artist links in its place: an unlinked group input reads (0, 0, 0)."""

from . import ensure
from ._tree import Tree, Value, dot, less, normalize, select

NAME = "VGroove Normal"
REVISION = 1


def build(tree: Tree) -> None:
    given = tree.input_vector("Normal", hide_value=True, tip="A bump or normal map; the surface's own if unlinked")
    N = select(less(dot(given, given), 1e-12), tree.geometry("Normal"), normalize(given))
    tree.output_vector("N", N, tip="Unit normal")


def interface(tree: Tree) -> Value:
    """The input "Normal", hidden value."""
    return tree.input_vector("Normal", hide_value=True, tip="A bump or normal map; the surface's own if unlinked")


def shading_normal(tree: Tree, given: Value) -> Value:
    """N for a group whose input ``given`` may be unlinked."""
    return Value(tree, tree.group(ensure(NAME, REVISION, build), Normal=given).outputs["N"])
