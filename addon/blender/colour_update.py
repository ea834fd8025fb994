# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps materials right when the working space of the file changes, or when they come from a file of another one.

Blender then converts what it knows to be a colour, by the matrix: colour inputs, ramps and Viewport Display. It
converts no F-curves, vectors (n, k, mean free paths) or text, and clips to 0..1 what may leave the new space's gamut,
absorption too. So what nobody edited is written again from its numbers, and edits are converted as ``colour_space``
says.
"""

from __future__ import annotations

import ast
import json
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ...nodegroups import trajectory
from ..models import parameter
from ..reference.keyframes import Keyframes
from . import colour_space, course, origin
from .inputs import give
from .material import CURVE, TRAJECTORY, animate, is_ours, parameter_sockets, preset_of, state_of, upgrade, values_of

if TYPE_CHECKING:
    from bpy.types import Material

    from .colour_space import Floats

_registered = ExitStack()
_seen: list[Floats] = []  # the matrix of the space that all materials were last brought to


def stale() -> list[Material]:
    """The materials that came from presets whose numbers are in another space than the file's."""
    return [one for one in bpy.data.materials if is_ours(one) and colour_space.is_stale(one)]


def refresh_all() -> list[Material]:
    """Bring every material that can be edited to the file's space; returns those that were not in it."""
    found = [one for one in stale() if one.library is None and one.override_library is None]
    for one in found:
        refresh(one)
    return found


def refresh(made: Material) -> None:
    """Bring a material's numbers, and its course, from the space that they are in to the file's."""
    record = upgrade(made)
    before, after = colour_space.of(made), colour_space.matrix()
    T = after @ np.linalg.inv(before)
    sockets = parameter_sockets(made)
    course_kept = _is_course_kept(record.state, state_of(made), T)
    values, converted = _values_before(made, before, T)
    rec709 = colour_space.read(values, record.preset.parameters, before)
    numbers = colour_space.to_space(rec709, after)
    if not converted:
        r, g, b, alpha = made.diffuse_color
        made.diffuse_color = (*np.clip(T @ (r, g, b), 0.0, 1.0).tolist(), alpha)
    played = course_kept and record.play is not None
    if played:
        course.remove(made, sockets)
    for name, socket in sockets.items():
        if parameter(name).is_rgb or played:  # as taking a course away sets what it moves
            give(name, socket, numbers[name])
    if not played:
        _convert_course(made, values, before, after, T if converted else None)
    colour_space.mark(made)
    if played:
        animate(made, record)
    if course_kept:  # it still counts as it was built, with its new keys
        rest = [entry for entry in json.loads(record.state or "[]") if not _is_of_course(entry)]
        now = [entry for entry in json.loads(state_of(made)) if _is_of_course(entry)]
        origin.write(made, replace(record, state=json.dumps(sorted([*now, *rest]))))


def _values_before(made: Material, before: Floats, T: Floats) -> tuple[dict[str, Any], bool]:
    """A material's numbers in the space that they were in, and whether Blender has converted its colours since.

    A colour that is as it was written, or as Blender converts that, tells; where all were edited, Blender did.
    """
    sockets, values = parameter_sockets(made), values_of(made)
    written = colour_space.to_space(preset_of(made).parameters, before)
    colours = {name for name, socket in sockets.items() if socket.type == "RGBA"}
    pairs = [(values[name], written[name]) for name in colours]
    untouched = any(_is(value, of) and not _is(value, colour_space.as_blender(of, T)) for value, of in pairs)
    converted = not untouched
    if converted:
        back = np.linalg.inv(T)
        for name in colours:
            known = _is(values[name], colour_space.as_blender(written[name], T))
            values[name] = written[name] if known else tuple((back @ values[name]).tolist())
    return values, converted


def _is(value: Any, written: Any) -> bool:
    return colour_space.is_unchanged(value, written)


# Courses


def _is_of_course(entry: str) -> bool:
    """Whether an entry of a state tells of a course: see ``state_of``."""
    return json.loads(entry)[0] in {CURVE, TRAJECTORY}


def _is_course_kept(built: str, now: str, T: Floats) -> bool:
    """Whether a material's course is as it was built, but for what Blender converted in its ramps."""
    was, found = ([e for e in map(json.loads, json.loads(state or "[]")) if e[0] in {CURVE, TRAJECTORY}]
                  for state in (built, now))  # fmt: skip
    if was == found:
        return True
    curves = [[one for one in entries if one[0] == CURVE] for entries in (was, found)]
    ramps = [[one[1] for one in entries if one[0] == TRAJECTORY] for entries in (was, found)]
    if curves[0] != curves[1] or [len(one) for one in ramps] != [1, 1]:
        return False
    before, after = (ast.literal_eval(of) for (of,) in ramps)
    return before.keys() == after.keys() and all(
        len(before[name]) == len(after[name])
        and all(
            a == b and (_is(new, old) or (np.ndim(old) and _is(new, colour_space.as_blender(old, T))))
            for (a, old), (b, new) in zip(before[name], after[name], strict=True)
        )
        for name in before
    )


def _convert_course(made: Material, still: dict[str, Any], before: Floats, after: Floats, T: Floats | None) -> None:
    """Convert keys that an artist made or changed. ``T``: what Blender applied to colours of ramps already."""

    def convert(values: dict[str, Any]) -> dict[str, Any]:
        return colour_space.to_space(colour_space.from_space(values, before), after)

    sockets = parameter_sockets(made)
    keys = course.courses(made, sockets)
    colours = [name for name in keys if parameter(name).is_rgb]
    node = course.trajectory_node(made)
    if node is not None:
        if T is not None:
            back = np.linalg.inv(T).T
            keys |= {name: Keyframes(keys[name].times, keys[name].values @ back) for name in colours}
        for name in colours:
            new = colour_space.convert_keys(name, keys, still, convert)
            trajectory.set_values(node.node_tree, sockets[name].name, new.values.tolist())
        return
    if colours:
        course.replace_curves(
            made, sockets, {name: colour_space.convert_keys(name, keys, still, convert) for name in colours}
        )


# Handlers


@bpy.app.handlers.persistent
def _after_change(*_arguments: object) -> None:
    """Files that were opened, appended from, or taken back to where they were."""
    refresh_all()
    _seen[:] = [colour_space.matrix()]


@bpy.app.handlers.persistent
def _after_update(*_arguments: object) -> None:
    """Changing the space has no event of its own but an update of everything."""
    if not _seen or not colour_space.is_same(_seen[0], colour_space.matrix()):
        _after_change()


def register() -> None:
    """Follow the open file from now on."""
    events = bpy.app.handlers
    with ExitStack() as undo:
        for listeners in (events.load_post, events.blend_import_post, events.undo_post, events.redo_post):
            listeners.append(_after_change)
            undo.callback(listeners.remove, _after_change)
        for listeners in (events.depsgraph_update_post, events.render_init):  # without conversion nothing is updated
            listeners.append(_after_update)
            undo.callback(listeners.remove, _after_update)
        undo.callback(_seen.clear)
        _registered.enter_context(undo.pop_all())


def unregister() -> None:
    """No longer."""
    _registered.close()
