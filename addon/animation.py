# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's course over time in Blender: F-curves on its inputs, or one keyed Age that drives its trajectory.

Both play the same keys, placed by error (``place_keys``). What this module makes it can reverse, retime, turn from one
into the other and remove, also after an artist changed it: nothing is kept but what can be seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ..nodegroups import REVISION_KEY
from ..nodegroups import trajectory as trajectory_group
from ..nodegroups._tree import Tree
from ..nodegroups.trajectory import AGE, OFFSET, RATE
from .preset_checks import M_RANGE, base_name
from .reference.keyframes import TOLERANCE, TOLERANCES, Keyframes, place_keys
from .reference.trajectory import Keys, Trajectory

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from bpy.types import ChannelBag, FCurve, Material, Node, NodeSocket, ShaderNodeTree
    from numpy.typing import ArrayLike, NDArray

    from ..nodegroups.trajectory import Key

DRIVINGS = ("curves", "age")
INTERPOLATIONS = ("linear", "shape")
LABEL = "Trajectory"  # of the node that holds a course driven by Age
PIECES = 1024  # straight ones, about, for a curve that an artist bent
CLOSEST = 1e-3  # frames: Blender takes keys within 1e-4 for one when it plays them
FRAMES = (-1e6, 1e6)
LENGTHS = (1e-6, 1e9)  # frames


class AnimationError(ValueError):
    """Bad input in one line: what, where, how to mend it."""


@dataclass(frozen=True)
class Play:
    """How a preset's course is played: from frame ``start`` for ``length`` frames; before and after it the ends hold.

    driving: "curves", F-curves on the inputs that change, or "age", the course within the material and one keyed Age.
    tolerance: by how much of a parameter's range the keys may miss its law. interpolation: straight, or with handles
    that follow the law's "shape", for fewer keys; of "curves" alone.
    """

    driving: str = "curves"
    start: float = 1.0
    length: float = 240.0
    tolerance: float = TOLERANCE
    interpolation: str = "linear"

    def __post_init__(self) -> None:
        known = (("driving", self.driving, DRIVINGS), ("interpolation", self.interpolation, INTERPOLATIONS))
        for what, value, allowed in known:
            if value not in allowed:
                message = f'unknown {what} "{value}"; use one of {", ".join(allowed)}'
                raise AnimationError(message)
        ranges = (("start", self.start, FRAMES), ("length", self.length, LENGTHS))
        for what, number, (low, high) in (*ranges, ("tolerance", self.tolerance, TOLERANCES)):
            if not low <= number <= high:  # NaN too
                message = f"{what} must be between {low:g} and {high:g}, got {number:g}"
                raise AnimationError(message)
        if self.driving == "age" and self.interpolation == "shape":
            message = 'a course driven by Age goes straight between keys; use interpolation "linear", or "curves"'
            raise AnimationError(message)


def keyframes(course: Trajectory, play: Play) -> dict[str, Keyframes]:
    """The keys of each parameter, by age."""
    of_age = Trajectory({name: _ByAge(course, name) for name in course.laws}, 0.0, 1.0)
    shape: Any = play.interpolation
    return {name: place_keys(of_age, name, play.tolerance, shape) for name in course.laws}


@dataclass(frozen=True)
class _ByAge:
    """A parameter's law over the course's age."""

    course: Trajectory
    name: str

    def __call__(self, t: ArrayLike) -> NDArray[np.float64]:
        return self.course.value(self.name, self.course.time(t))

    def events(self) -> NDArray[np.float64]:
        return self.course.age(self.course.laws[self.name].events())


def animate(
    material: Material, sockets: Mapping[str, NodeSocket], course: Trajectory, play: Play,
    title: str, backend: str,
) -> None:  # fmt: skip
    """Have ``material`` play ``course`` on the inputs ``sockets``, each by its parameter's name."""
    keys = keyframes(course, play)
    moving = {name: of for name, of in keys.items() if of.times.size > 1}
    if not moving:
        return
    tree = material.node_tree
    if play.driving == "curves":
        for name, of in moving.items():
            for channel, part in enumerate(_channels(of)):
                if np.ptp(part.values) > 0.0:
                    _keyed(tree, sockets[name], channel, _of_frames(part, play), play.interpolation)
        _name_action(material)
        return
    courses = {sockets[name].name: _course(name, of) for name, of in moving.items()}
    _add_trajectory(material, {sockets[name].name: sockets[name] for name in moving}, courses, title, backend)
    node = trajectory_node(material)
    ages = Keyframes(np.array([play.start, play.start + play.length]), np.array([0.0, 1.0]))
    assert node is not None  # noqa: S101 - it was made
    _keyed(tree, node.inputs[AGE], 0, ages, "linear")
    _name_action(material)


def _name_action(material: Material) -> None:
    data = material.node_tree.animation_data
    if data is not None and data.action is not None:
        data.action.name = f"{material.name} Course"


def _course(name: str, keys: Keyframes) -> list[Key]:
    values = _held(name, keys.values)
    plain = [tuple(value.tolist()) if value.ndim else float(value) for value in values]
    return list(zip(keys.times.tolist(), plain, strict=True))


def _held(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Slopes that the shaders can do."""
    return np.maximum(values, M_RANGE[0]) if base_name(name) == "m" else values


def _channels(keys: Keyframes) -> list[Keyframes]:
    if keys.values.ndim == 1:
        return [keys]

    def of(part: NDArray[np.float64] | None, channel: int) -> NDArray[np.float64] | None:
        return None if part is None else part[:, channel]

    return [Keyframes(keys.times, keys.values[:, k], of(keys.before, k), of(keys.after, k)) for k in range(3)]


def _of_frames(keys: Keyframes, play: Play) -> Keyframes:
    return Keyframes(play.start + keys.times * play.length, keys.values, keys.before, keys.after)


def _add_trajectory(
    material: Material, targets: Mapping[str, NodeSocket], courses: Mapping[str, Sequence[Key]], title: str,
    backend: str,
) -> None:  # fmt: skip
    """A node beside the model's that holds the courses and feeds its inputs; its group is the material's own."""
    if backend == "osl":
        build: Callable[[Tree], None] = partial(trajectory_group.build_osl, keys=courses, title=title)
    else:
        build = partial(trajectory_group.build, keys=courses)
    group = bpy.data.node_groups.new(f"{trajectory_group.NAME} {title}"[:60], "ShaderNodeTree")
    made = Tree(group)
    try:
        build(made)
    except Exception:
        bpy.data.node_groups.remove(group)
        raise
    made.arrange()
    group[REVISION_KEY] = 1
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.label, node.width, node.location = group, LABEL, 220, (-300, 320)
    for name, socket in targets.items():
        tree.links.new(node.outputs[name], socket)


def trajectory_node(material: Material) -> Node | None:
    """The node that holds the course of a material driven by Age; None of others."""
    nodes = material.node_tree.nodes
    return next((n for n in nodes if n.bl_idname == "ShaderNodeGroup" and AGE in n.inputs and RATE in n.inputs), None)


# F-curves


def _bag(tree: ShaderNodeTree, *, make: bool = False) -> ChannelBag | None:
    """Where the F-curves of a material's tree are."""
    data = tree.animation_data_create() if make else tree.animation_data
    if data is None:
        return None
    if data.action is None and make:
        data.action = bpy.data.actions.new(f"{tree.id_data.name} Course")
    action = data.action
    if action is None:
        return None
    if make:
        if data.action_slot is None:
            data.action_slot = (
                action.slots[0] if action.slots else action.slots.new(id_type="NODETREE", name=tree.id_data.name)
            )
        layer = action.layers[0] if action.layers else action.layers.new(name="Layer")
        strip = layer.strips[0] if layer.strips else layer.strips.new(type="KEYFRAME")
        return strip.channelbag(data.action_slot, ensure=True)
    if not action.layers or not action.layers[0].strips:
        return None
    return action.layers[0].strips[0].channelbag(data.action_slot)


def make_own(material: Material) -> None:
    """Give a material that was duplicated curves of its own; Blender has both share them."""
    data = material.node_tree.animation_data
    if data is None or data.action is None or data.action.users - data.action.use_fake_user < 2:
        return
    identifier = data.action_slot.identifier
    data.action = data.action.copy()
    data.action_slot = data.action.slots[identifier]


def _keyed(tree: ShaderNodeTree, socket: NodeSocket, channel: int, keys: Keyframes, interpolation: str) -> None:
    """Give an input an F-curve of these keys, by frame, but for keys that Blender could not tell apart."""
    keys = _apart(keys)
    bag, path = _bag(tree, make=True), socket.path_from_id("default_value")
    assert bag is not None  # noqa: S101 - it was made
    old = bag.fcurves.find(path, index=channel)
    if old is not None:
        bag.fcurves.remove(old)
    curve = bag.fcurves.new(path, index=channel)
    curve.extrapolation = "CONSTANT"
    name = socket.name.rsplit("Slope ", maxsplit=1)[-1]
    _write(curve, keys.times, _held(name, keys.values), interpolation)
    if interpolation == "shape" and keys.before is not None and keys.after is not None:
        _write_handles(curve, keys)
    if hasattr(socket.default_value, "__len__"):
        socket.default_value[channel] = keys.values[0]
    else:
        socket.default_value = keys.values[0]


def _apart(keys: Keyframes) -> Keyframes:
    """The first and the last key, and of those between what is CLOSEST to no other that is kept."""
    kept = [0]
    for k, frame in enumerate(keys.times):
        if frame - keys.times[kept[-1]] >= CLOSEST:
            kept.append(k)
    last = keys.times.size - 1
    if kept[-1] != last:
        kept = [*kept[: max(len(kept) - 1, 1)], last]
    parts = (None if part is None else part[kept] for part in (keys.before, keys.after))
    return Keyframes(keys.times[kept], keys.values[kept], *parts)


def _write(curve: FCurve, frames: NDArray[np.float64], values: NDArray[np.float64], interpolation: str) -> None:
    points = curve.keyframe_points
    points.clear()
    points.add(len(frames))
    # No curve.update() after this: it would merge keys that are nearer than 1/100 of a frame.
    points.foreach_set("co", np.stack([frames, values], axis=-1).astype(np.float32).ravel())
    kinds = bpy.types.Keyframe.bl_rna.properties
    mode = "LINEAR" if interpolation == "linear" else "BEZIER"
    points.foreach_set("interpolation", np.full(len(frames), kinds["interpolation"].enum_items[mode].value, np.int32))
    kind = kinds["handle_left_type"].enum_items["VECTOR" if interpolation == "linear" else "FREE"].value
    for side in ("left", "right"):
        points.foreach_set(f"handle_{side}_type", np.full(len(frames), kind, np.int32))
    if interpolation == "linear":  # handles along the lines, for who changes the interpolation later
        _write_handles(curve, Keyframes(frames, values, *_along(values)))


def _along(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    rise = np.diff(values) / 3.0
    return np.concatenate([values[:1], values[1:] - rise]), np.concatenate([values[:-1] + rise, values[-1:]])


def _write_handles(curve: FCurve, keys: Keyframes) -> None:
    """Handles a third of the way, so that time goes evenly along the curve."""
    widths = np.diff(keys.times) / 3.0
    first, last = (widths[0], widths[-1]) if widths.size else (1.0, 1.0)
    left = np.stack([keys.times - np.concatenate([[first], widths]), keys.before], axis=-1)
    right = np.stack([keys.times + np.concatenate([widths, [last]]), keys.after], axis=-1)
    curve.keyframe_points.foreach_set("handle_left", left.astype(np.float32).ravel())
    curve.keyframe_points.foreach_set("handle_right", right.astype(np.float32).ravel())


def curves_of(material: Material, sockets: Iterable[NodeSocket]) -> list[FCurve]:
    """The F-curves on these inputs of a material, and on its Age."""
    bag = _bag(material.node_tree)
    if bag is None:
        return []
    node = trajectory_node(material)
    found = [*sockets, *([node.inputs[AGE]] if node else [])]
    paths = {socket.path_from_id("default_value") for socket in found}
    return [curve for curve in bag.fcurves if curve.data_path in paths]


def span_of(curves: Iterable[FCurve]) -> tuple[float, float]:
    """First and last frame of all keys."""
    frames = [point.co.x for curve in curves for point in curve.keyframe_points]
    if not frames:
        message = "this material has no keys; add its course first"
        raise AnimationError(message)
    return min(frames), max(frames)


def retime(curves: Sequence[FCurve], start: float, length: float) -> None:
    """Move and stretch all keys so that they go from frame ``start`` for ``length`` frames."""
    Play(start=start, length=length)  # refuses what is out of range
    first, last = span_of(curves)
    factor = length / (last - first) if last > first else 1.0
    _map(curves, lambda frame: start + (frame - first) * factor, backwards=False)


def reverse(curves: Sequence[FCurve]) -> None:
    """Play the course from its end to its start, over the same frames."""
    first, last = span_of(curves)
    _map(curves, lambda frame: first + last - frame, backwards=True)


def _map(curves: Sequence[FCurve], moved: Callable[[Any], Any], *, backwards: bool) -> None:
    for curve in curves:
        points = curve.keyframe_points
        parts = {}
        for name in ("co", "handle_left", "handle_right"):
            flat = np.empty(2 * len(points), np.float32)
            points.foreach_get(name, flat)
            pairs = flat.reshape(-1, 2).astype(np.float64)
            pairs[:, 0] = moved(pairs[:, 0])
            parts[name] = pairs[::-1] if backwards else pairs
        kinds = {}
        for name in ("interpolation", "handle_left_type", "handle_right_type"):
            values = np.empty(len(points), np.int32)
            points.foreach_get(name, values)
            kinds[name] = values[::-1] if backwards else values
        if backwards:  # a key's way of leaving it is the way of reaching it
            parts["handle_left"], parts["handle_right"] = parts["handle_right"], parts["handle_left"]
            both = kinds["handle_left_type"], kinds["handle_right_type"]
            kinds["handle_right_type"], kinds["handle_left_type"] = both
            kinds["interpolation"] = np.concatenate([kinds["interpolation"][1:], kinds["interpolation"][:1]])
        for name, pairs in parts.items():
            points.foreach_set(name, pairs.astype(np.float32).ravel())
        for name, values in kinds.items():
            points.foreach_set(name, np.ascontiguousarray(values))


# From one way of driving to the other, and back to none


def bake(material: Material, sockets: Mapping[str, NodeSocket]) -> None:
    """Turn a course that Age drives into F-curves on the inputs; the node that held it goes.

    A clock that differs from point to point cannot be baked: AnimationError if Rate or Offset is linked.
    """
    make_own(material)
    node = trajectory_node(material)
    if node is None:
        message = f"{material.name} is not driven by Age; its inputs have their own curves already, or none"
        raise AnimationError(message)
    linked = [name for name in (RATE, OFFSET) if node.inputs[name].is_linked]
    if linked:
        message = (
            f"{' and '.join(linked)} of {material.name} come from a texture, which no curve can follow; unlink them"
        )
        raise AnimationError(message)
    by_label = {socket.name: (name, socket) for name, socket in sockets.items()}
    held = trajectory_group.keys_of(node.node_tree)
    courses = {by_label[label]: of for label, of in held.items() if label in by_label}
    frames = _frames_of_ages(material, node)
    played = [(socket, frames(name, course)) for (name, socket), course in courses.items()]
    _drop_trajectory(material, node)  # takes the curve of Age along
    for socket, keys in played:
        for channel, part in enumerate(_channels(keys)):
            if np.ptp(part.values) > 0.0:
                _keyed(material.node_tree, socket, channel, part, "linear")
            elif keys.values.ndim == 2:
                socket.default_value[channel] = part.values[0]
            else:
                socket.default_value = part.values[0]
    _name_action(material)


def _frames_of_ages(material: Material, node: Node) -> Callable[[str, Sequence[Key]], Keyframes]:
    """A function that plays a course by frame as the material's Age does."""
    curves = curves_of(material, ())
    rate, offset = node.inputs[RATE].default_value, node.inputs[OFFSET].default_value
    if curves:
        first, last = span_of(curves)
        straight = all(point.interpolation == "LINEAR" for point in curves[0].keyframe_points)
        knots = np.array([point.co.x for point in curves[0].keyframe_points])
    else:
        first, last, straight, knots = 0.0, 0.0, True, np.array([0.0])

    def local(frames: NDArray[np.float64]) -> NDArray[np.float64]:
        ages = [curves[0].evaluate(frame) for frame in frames] if curves else [node.inputs[AGE].default_value]
        return np.clip(rate * np.clip(ages, 0.0, 1.0) - offset, 0.0, 1.0)

    def frames(name: str, course: Sequence[Key]) -> Keyframes:
        ages, values = (np.array(part) for part in zip(*course, strict=True))
        ages, index = np.unique(ages, return_index=True)
        law = Keys(ages, values[index])
        if last == first:
            return Keyframes(np.array([first]), law(local(np.array([first]))))
        if straight:
            at = local(knots)
            times = [knots]
            for a, b, x, y in zip(at[:-1], at[1:], knots[:-1], knots[1:], strict=True):
                passed = ages[(ages > min(a, b)) & (ages < max(a, b))]
                times.append(x + (passed - a) / (b - a) * (y - x) if a != b else np.empty(0))
            all_times = np.unique(np.concatenate(times))
            return Keyframes(all_times, law(np.interp(all_times, knots, at)))
        shaped = _tabulated(knots, lambda frames: law(local(frames)))
        return place_keys(Trajectory({name: shaped}, first, last), name)

    return frames


def _tabulated(knots: NDArray[np.float64], evaluate: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Keys:
    """What is played from key frame to key frame, in PIECES straight ones, as an artist may have bent it."""
    each = max(PIECES // (knots.size - 1), 4)
    parts = np.arange(each) / each
    between = (knots[:-1, None] + parts * np.diff(knots)[:, None]).ravel()
    frames = np.unique(np.append(between, knots[-1]))
    return Keys(frames, evaluate(frames))


def courses(material: Material, sockets: Mapping[str, NodeSocket]) -> dict[str, Keyframes]:
    """The course of each parameter that changes, by age, as a material's curves or ramps have it now."""
    node = trajectory_node(material)
    if node is not None:
        names = {socket.name: name for name, socket in sockets.items()}
        held = trajectory_group.keys_of(node.node_tree)
        return {names[label]: _distinct(course) for label, course in held.items() if label in names}
    found: dict[str, Keyframes] = {}
    moving = curves_of(material, sockets.values())
    first, last = span_of(moving) if moving else (0.0, 1.0)
    for name, socket in sockets.items():
        path = socket.path_from_id("default_value")
        of_socket = {curve.array_index: curve for curve in moving if curve.data_path == path}
        if of_socket:
            frames = np.unique([point.co.x for curve in of_socket.values() for point in curve.keyframe_points])
            if any(point.interpolation != "LINEAR" for of in of_socket.values() for point in of.keyframe_points):
                law = _tabulated(frames, partial(_values, socket.default_value, of_socket))
                played = place_keys(Trajectory({name: law}, first, last), name)
                found[name] = Keyframes((played.times - first) / (last - first), played.values)
            else:
                values = _values(socket.default_value, of_socket, frames)
                found[name] = Keyframes((frames - first) / max(last - first, CLOSEST), values)
    return found


def _values(value: Any, curves: Mapping[int, FCurve], frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the F-curves of one input make of it at each frame; channels without a curve stand still."""
    single = not hasattr(value, "__len__")
    channels = [
        [curves[k].evaluate(frame) if k in curves else (value if single else value[k]) for frame in frames]
        for k in range(1 if single else 3)
    ]
    return np.array(channels[0]) if single else np.array(channels).T


def _distinct(course: Sequence[Key]) -> Keyframes:
    """Keys of ages that ascend, of two of one age the later one: a step."""
    ages, values = (np.array(part) for part in zip(*course, strict=True))
    last = np.append(np.diff(ages) > 0.0, [True])
    return Keyframes(ages[last], values[last])


def remove(material: Material, sockets: Mapping[str, NodeSocket]) -> None:
    """Take the course away; the material stays as the current frame shows it."""
    make_own(material)
    frame = bpy.context.scene.frame_current_final
    for curve in curves_of(material, sockets.values()):  # an unused material's inputs do not follow the frame
        _hold(material, curve, curve.evaluate(frame))
    node = trajectory_node(material)
    if node is not None:
        age = node.inputs[AGE].default_value
        local = float(np.clip(node.inputs[RATE].default_value * age - node.inputs[OFFSET].default_value, 0.0, 1.0))
        courses = trajectory_group.keys_of(node.node_tree)
        for curve in curves_of(material, ()):
            _remove_curve(material, curve)
        _drop_trajectory(material, node)
        for socket in sockets.values():
            if socket.name in courses:
                ages, values = (np.array(part) for part in zip(*courses[socket.name], strict=True))
                ages, index = np.unique(ages, return_index=True)
                value = Keys(ages, values[index])(local)
                socket.default_value = (*value, 1.0) if value.ndim and len(socket.default_value) == 4 else value
    for curve in curves_of(material, sockets.values()):
        _remove_curve(material, curve)
    _drop_action(material.node_tree)


def _hold(material: Material, curve: FCurve, value: float) -> None:
    """Set what a curve moves to a value."""
    path, _, name = curve.data_path.rpartition(".")
    socket = material.node_tree.path_resolve(path)
    if hasattr(socket.default_value, "__len__"):
        getattr(socket, name)[curve.array_index] = value
    else:
        setattr(socket, name, value)


def _remove_curve(material: Material, curve: FCurve) -> None:
    bag = _bag(material.node_tree)
    assert bag is not None  # noqa: S101 - it holds the curve
    bag.fcurves.remove(curve)


def _drop_trajectory(material: Material, node: Node) -> None:
    group, texts = node.node_tree, []
    for curve in curves_of(material, ()):
        _remove_curve(material, curve)
    material.node_tree.nodes.remove(node)
    if group.users == 0:
        texts = [one.script for one in group.nodes if one.bl_idname == "ShaderNodeScript"]
        bpy.data.node_groups.remove(group)
    for text in texts:
        if text is not None and text.users <= text.use_fake_user:
            bpy.data.texts.remove(text)
    _drop_action(material.node_tree)


def _drop_action(tree: ShaderNodeTree) -> None:
    """No action stays behind without a curve, unless something else uses it."""
    bag, data = _bag(tree), tree.animation_data
    if data is None or (bag is not None and len(bag.fcurves)):
        return
    action = data.action
    data.action = None
    if not len(data.drivers) and not len(data.nla_tracks):  # bound lamps have theirs there
        tree.animation_data_clear()
    if action is not None and action.users == 0:
        bpy.data.actions.remove(action)
