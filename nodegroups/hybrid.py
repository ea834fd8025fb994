# SPDX-License-Identifier: GPL-3.0-or-later
"""What the ``hybrid`` of every model asks for: how much of it may be wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.reference.hybrid import BOUNDS, DEFAULT_BOUND

if TYPE_CHECKING:
    from ._tree import Tree, Value


def bound_input(tree: Tree) -> Value:
    tip = "How much of the reflected light may be wrong; less is noisier"
    low, high = BOUNDS
    return tree.input_float("Bound", DEFAULT_BOUND, low=low, high=high, subtype="FACTOR", tip=tip, held=True)
