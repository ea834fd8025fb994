# SPDX-License-Identifier: GPL-3.0-or-later
"""One step of a trajectory: from what was before to the next key's value, between two ages.

A chain of them is a polyline over age: ``Keys`` of the reference. Weights are 0 or 1 outside a ramp's own ages, so that
there a chain gives a key's value to the last digit.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from . import ensure
from ._tree import Tree, Value, clamp, maximum, select

if TYPE_CHECKING:
    import bpy

NAME = ".VGroove Ramp"
REVISION = 2
NARROWEST = 1e-30  # so that a ramp whose ages coincide is a step


def build(tree: Tree, *, color: bool) -> None:
    def value_input(name: str, tip: str) -> Value:
        if color:
            return tree.input_color(name, (0.0, 0.0, 0.0), tip=tip)
        return tree.input_float(name, 0.0, low=-1e30, high=1e30, tip=tip)

    before = value_input("Before", "Value until the start")
    after = value_input("After", "The key: value from the end on")
    age = tree.input_float("Age", 0.0, low=0.0, high=1.0, tip="Of the point, by its own clock")
    start = tree.input_float("Start", 0.0, low=0.0, high=1.0, tip="Age at which the value begins to change")
    end = tree.input_float("End", 1.0, low=0.0, high=1.0, tip="Age at which the key's value is reached")
    with tree.frame("Straight from start to end"):
        part = clamp((age - start) / maximum(end - start, NARROWEST))
        value = select(part, after, before)
    (tree.output_color if color else tree.output_float)("Value", value, tip="At this age")


def group(*, color: bool) -> bpy.types.ShaderNodeTree:
    """The ramp of numbers or of colours."""
    return ensure(f"{NAME}{' Color' * color}", REVISION, partial(build, color=color))
