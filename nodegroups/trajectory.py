# SPDX-License-Identifier: GPL-3.0-or-later
"""The changing parameters of a material over age, for a clock that each point has for itself.

p(x, t) = p(rate(x) t - offset(x)): rate and offset may come from textures. Each parameter is a chain of ramps, a frame
each, and an artist can change every key in it. Source: Gu et al. 2006; ``local_age`` and ``Keys`` of the reference.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, TypeAlias

from . import osl_script, ramp
from ._tree import Tree, Value, clamp

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from bpy.types import Node, ShaderNodeTree, Text

NAME = "VGroove Trajectory"
REVISION = 2
AGE, RATE, OFFSET = "Age", "Rate", "Offset"
Key: TypeAlias = "tuple[float, float | tuple[float, float, float]]"  # age and value


def build(tree: Tree, keys: Mapping[str, Sequence[Key]]) -> None:
    """``keys``: of each parameter by the label of its input, the first at the age where its course begins."""
    age, rate, offset = interface(tree)
    with tree.frame("Clock of the point"):
        local = clamp(rate * age - offset)
    for name, course in keys.items():
        with tree.frame(name):
            value = _chain(tree, local, course)
        (tree.output_color if _is_color(course) else tree.output_float)(name, value, tip=f"{name} at this age")


def build_osl(tree: Tree, keys: Mapping[str, Sequence[Key]], title: str) -> None:
    """The same from one script a parameter; its keys stand at the top of the script's text."""
    age, rate, offset = interface(tree)
    for name, course in keys.items():
        variant = f"trajectory {title} {name}", {TABLE: table(course)}
        node = osl_script.script(tree, "trajectory", variant, Age=age, Rate=rate, Offset=offset)
        value = osl_script.output(tree, node, "Value")
        (tree.output_color if _is_color(course) else tree.output_float)(name, value, tip=f"{name} at this age")


def interface(tree: Tree) -> tuple[Value, Value, Value]:
    """The inputs Age, Rate and Offset."""
    tip = "0 at the start of the material's course, 1 at its end; key it to play the course"
    age = tree.input_float(AGE, 0.0, low=0.0, high=1.0, subtype="FACTOR", tip=tip)
    tip = "How fast a point's clock runs; link a texture for some places to age faster than others"
    rate = tree.input_float(RATE, 1.0, low=0.0, high=1e6, tip=tip)
    tip = "By how much of the course a point's clock is late; link a texture for a front that spreads"
    offset = tree.input_float(OFFSET, 0.0, low=-10.0, high=10.0, tip=tip)
    return age, rate, offset


def _is_color(course: Sequence[Key]) -> bool:
    return isinstance(course[0][1], tuple)


def _chain(tree: Tree, age: Value, course: Sequence[Key]) -> Value:
    group = ramp.group(color=_is_color(course))
    (start, before), *rest = course
    value: Value | float | tuple[float, float, float] = before
    if not rest:  # a parameter that stands still
        rest = [(1.0, before)]
    for end, after in rest:
        node = tree.group(group, Before=value, After=after, Age=age, Start=start, End=end)
        node.label = f"to age {end:.6g}"
        value, start = Value(tree, node.outputs["Value"]), end
    assert isinstance(value, Value)  # noqa: S101 - there is a ramp
    return value


# OSL

TABLE = "trajectory_keys.h"


def table(course: Sequence[Key]) -> str:
    """The keys as OSL text."""
    kind = "color" if _is_color(course) else "float"
    ages = ", ".join(f"{age:.9g}" for age, _ in course)
    values = ", ".join(
        "color({:.9g}, {:.9g}, {:.9g})".format(*of) if isinstance(of, tuple) else f"{of:.9g}" for _, of in course
    )
    return f"#define KIND {kind}\n#define KEYS {len(course)}\n#define AGES {{{ages}}}\n#define VALUES {{{values}}}\n"


# What a group holds, also after an artist's changes


def keys_of(group: ShaderNodeTree) -> dict[str, list[Key]]:
    """The keys of each parameter as the group's ramps, or its scripts' texts, have them now.

    A parameter whose nodes an artist replaced by others is left out.
    """
    output = next((node for node in group.nodes if node.bl_idname == "NodeGroupOutput"), None)
    found = {}
    for socket in output.inputs if output else ():
        if socket.is_linked:
            last = socket.links[0].from_node
            is_script = last.bl_idname == "ShaderNodeScript" and last.script is not None
            keys = _of_text(last.script) if is_script else _of_ramps(last) if _is_ramp(last) else []
            if keys:
                found[socket.name] = keys
    return found


def _is_ramp(node: Node) -> bool:
    return {"Before", "After", "Start", "End"} <= {socket.name for socket in node.inputs}


def set_values(group: ShaderNodeTree, name: str, values: Sequence[Sequence[float]]) -> None:
    """Give the keys of one colour, as ``keys_of`` finds them, other values at the same ages. Of ramps alone."""
    output = next(node for node in group.nodes if node.bl_idname == "NodeGroupOutput")
    last = output.inputs[name].links[0].from_node
    if not _is_ramp(last):
        return
    given = {age: tuple(value) for (age, _), value in zip(_of_ramps(last), values, strict=True)}
    ramps = _ramps(last)
    ramps[0].inputs["Before"].default_value = (*values[0], 1.0)
    for node in ramps:
        node.inputs["After"].default_value = (*given[node.inputs["End"].default_value], 1.0)


def _ramps(last: Node) -> list[Node]:
    """The ramps that end in ``last``, the first first; none if another node stands among them."""
    ramps = [last]
    while ramps[0].inputs["Before"].is_linked:
        ramps.insert(0, ramps[0].inputs["Before"].links[0].from_node)
        if not _is_ramp(ramps[0]):
            return []
    return ramps


def _of_ramps(last: Node) -> list[Key]:
    ramps = _ramps(last)
    if not ramps:
        return []
    course = [(ramps[0].inputs["Start"].default_value, _plain(ramps[0].inputs["Before"].default_value))]
    for node in ramps:
        start, after = node.inputs["Start"].default_value, _plain(node.inputs["After"].default_value)
        if start > course[-1][0]:  # a pause that an artist left between two ramps
            course.append((start, course[-1][1]))
        course.append((node.inputs["End"].default_value, after))
    return course


def _of_text(text: Text) -> list[Key]:
    content = text.as_string()
    number = r"-?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
    ages, values = (
        [float(one) for line in re.findall(rf"#define {name} {{(.*)}}", content) for one in re.findall(number, line)]
        for name in ("AGES", "VALUES")
    )
    if len(values) != len(ages) * (1 if "#define KIND float" in content else 3):
        return []
    if "#define KIND float" in content:
        return list(zip(ages, values, strict=True))
    colors = [(r, g, b) for r, g, b in zip(values[::3], values[1::3], values[2::3], strict=True)]
    return list(zip(ages, colors, strict=True))


def _plain(value: Any) -> float | tuple[float, float, float]:
    return value if isinstance(value, float) else (value[0], value[1], value[2])
