# SPDX-License-Identifier: GPL-3.0-or-later
"""The V-groove's shadowing and masking: G = min(1, 2 (n.h)(n.v)/(v.h), 2 (n.h)(n.l)/(v.h))."""

from ._tree import Tree, minimum

NAME = ".VGroove G"
REVISION = 2


def build(tree: Tree) -> None:
    nh = tree.input_float("n.h", 1.0, low=0.0, high=1.0, tip="Normal against half vector")
    nv = tree.input_float("n.v", 1.0, low=0.0, high=1.0, tip="Normal against view")
    nl = tree.input_float("n.l", 1.0, low=0.0, high=1.0, tip="Normal against light")
    vh = tree.input_float("v.h", 1.0, low=0.0, high=1.0, tip="View against half vector")
    with tree.frame("Cook & Torrance 1982"):
        G = minimum(2.0 * nh * minimum(nv, nl) / vh, 1.0)
    tree.output_float("G", G, tip="Share of a facet both seen and lit")
