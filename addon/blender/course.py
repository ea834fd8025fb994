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

from ... import nodegroups
from ...nodegroups import trajectory as trajectory_group
from ...nodegroups.parameters import TO_INPUT
from ...nodegroups.trajectory import AGE, OFFSET, RATE
from ..library.errors import InputError
from ..library.timeline import plain
from ..models import PLAIN, parameter, symbol
from ..reference.keyframes import TOLERANCE, TOLERANCES, Keyframes, place_keys
from ..reference.trajectory import Keys, Trajectory, local_age
from . import fcurves, roles
from .inputs import Converted, converted_keys, scale_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from bpy.types import FCurve, Material, Node, NodeSocket
    from numpy.typing import ArrayLike, NDArray

    from ...nodegroups._tree import Tree
    from ...nodegroups.trajectory import Key
    from ..models import Scale
    from ..reference.trajectory import Law

DRIVINGS = ("curves", "age")
INTERPOLATIONS = ("linear", "shape")
PIECES = 1024  # straight ones, about, for a curve that an artist bent
FRAMES = (-1e6, 1e6)
LENGTHS = (1e-6, 1e9)  # frames
LONGEST_NAME = 55  # Blender keeps 63 bytes of a name, and may add a number


class AnimationError(InputError):
    """A course that cannot be played, or changed as asked."""


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


def keyframes(course: Trajectory, play: Play, scales: Mapping[str, Scale] | None = None) -> dict[str, Keyframes]:
    """The keys of each parameter's input, by age; ``scales``: of inputs that hold theirs in another way than usual."""
    usual = {name: parameter(name).scale for name in course.laws} | dict(scales or {})
    laws: dict[str, Law] = {name: Converted(_ByAge(course, name), usual[name].to_input) for name in course.laws}
    of_age = Trajectory(laws, 0.0, 1.0)
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
    """Have ``material`` play ``course`` on the inputs ``sockets``, each by its parameter's name.

    What an artist linked something to, or took away, is left as it is.
    """
    keys = keyframes(course, play, {name: scale_of(name, socket) for name, socket in sockets.items()})
    free = {name for name, socket in sockets.items() if not socket.is_linked}
    moving = {name: of for name, of in keys.items() if of.times.size > 1 and name in free}
    if not moving:
        return
    if play.driving == "curves":
        for name, of in moving.items():
            frames = Keyframes(play.start + of.times * play.length, of.values, of.before, of.after)
            fcurves.write_keys(material, sockets[name], frames, play.interpolation)
        return
    node = _add_trajectory(material, {sockets[name]: of for name, of in moving.items()}, title, backend)
    ages = Keyframes(np.array([play.start, play.start + play.length]), np.array([0.0, 1.0]))
    fcurves.write_keys(material, clock(node)[0], ages, "linear")


def _add_trajectory(
    material: Material, moving: Mapping[NodeSocket, Keyframes], title: str, backend: str
) -> Node:  # fmt: skip
    """A node beside the model's that holds the courses and feeds its inputs; its group is the material's own."""
    courses: dict[str, list[Key]] = {
        nodegroups.name_of(socket): [(float(age), plain(value)) for age, value in zip(of.times, of.values, strict=True)]
        for socket, of in moving.items()
    }
    build: Callable[[Tree], None] = partial(trajectory_group.build, keys=courses)
    if backend == "osl":
        build = partial(trajectory_group.build_osl, keys=courses, title=title)
    tree, name = material.node_tree, f"{trajectory_group.NAME} {title}"[:LONGEST_NAME]
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = nodegroups.make(name, trajectory_group.REVISION, build)
    node.label, node.width, node.location = "Trajectory", 220, (-300, 320)
    node[roles.KEY] = roles.TRAJECTORY
    for socket in moving:
        tree.links.new(node.outputs[nodegroups.name_of(socket)], socket)
    return node


def trajectory_node(material: Material) -> Node | None:
    """The node that holds the course of a material driven by Age; None of others, and where its clock was taken out."""
    node = roles.node(material, roles.TRAJECTORY)
    return node if node is not None and {AGE, RATE, OFFSET} <= set(nodegroups.inputs(node)) else None


def clock(node: Node) -> tuple[NodeSocket, NodeSocket, NodeSocket]:
    """The inputs Age, Rate and Offset of a trajectory's node."""
    inputs = nodegroups.inputs(node)
    return inputs[AGE], inputs[RATE], inputs[OFFSET]


def curves_of(material: Material, sockets: Iterable[NodeSocket]) -> list[FCurve]:
    """The F-curves on these inputs of a material, and on its Age."""
    bag = fcurves.channelbag(material)
    if bag is None:
        return []
    node = trajectory_node(material)
    found = [*sockets, *([clock(node)[0]] if node else [])]
    paths = {socket.path_from_id("default_value") for socket in found}
    return [curve for curve in bag.fcurves if curve.data_path in paths]


def span_of(curves: Iterable[FCurve]) -> tuple[float, float]:
    """First and last frame of all keys."""
    frames = [point.co.x for curve in curves for point in curve.keyframe_points]
    if not frames:
        message = "this material has no keys; add its animation first"
        raise AnimationError(message)
    return min(frames), max(frames)


def retime(curves: Sequence[FCurve], start: float, length: float) -> None:
    """Move and stretch all keys so that they go from frame ``start`` for ``length`` frames."""
    Play(start=start, length=length)  # refuses what is out of range
    first, last = span_of(curves)
    factor = length / (last - first) if last > first else 1.0
    fcurves.move_keys(curves, lambda frame: start + (frame - first) * factor, backwards=False)


def reverse(curves: Sequence[FCurve]) -> None:
    """Play the course from its end to its start, over the same frames."""
    first, last = span_of(curves)
    fcurves.move_keys(curves, lambda frame: first + last - frame, backwards=True)


# From one way of driving to the other, and back to none


def bake(material: Material, sockets: Mapping[str, NodeSocket]) -> None:
    """Turn a course that Age drives into F-curves on the inputs; the node that held it goes.

    A clock that differs from point to point cannot be baked: AnimationError if Rate or Offset is linked.
    """
    fcurves.make_own(material)
    node = trajectory_node(material)
    if node is None:
        message = f"{material.name} is not driven by Age; its inputs have their own curves already, or none"
        raise AnimationError(message)
    linked = [name for name, socket in zip((AGE, RATE, OFFSET), clock(node), strict=True) if socket.is_linked]
    if linked:
        message = (
            f"{' and '.join(linked)} of {material.name} come from a texture, which no curve can follow; unlink them"
        )
        raise AnimationError(message)
    held = _read_keys(node, sockets)
    fed = {name for name, one in sockets.items() if _feeds(node, one)}
    if missing := fed - set(held):
        what = ", ".join(sorted(missing))
        message = (
            f"{material.name}: {what} in its Trajectory group was changed and cannot be read; remove the animation"
        )
        raise AnimationError(message)
    held = {name: keys for name, keys in held.items() if name in fed}
    played = _by_frame(material, node, held, sockets)
    _drop_trajectory(material, node)  # takes the curve of Age along
    for socket, keys in played.items():
        fcurves.write_keys(material, socket, keys, "linear")


def _read_keys(node: Node, sockets: Mapping[str, NodeSocket]) -> dict[str, Keyframes]:
    """The course of each parameter, by age, as ramps or texts have it now; of two keys of one age the later one."""
    found = {}
    by_label = trajectory_group.keys_of(node.node_tree)
    for name, socket in sockets.items():
        label, old = nodegroups.name_of(socket), symbol(name)  # of older files, which hold the parameter itself
        if label in by_label or old in by_label:
            played = by_label.get(label) or by_label[old]
            ages, values = (np.array(part) for part in zip(*played, strict=True))
            last = np.append(np.diff(ages) > 0.0, [True])
            found[name] = Keyframes(ages[last], values[last])
            if label not in by_label and scale_of(name, socket) is not PLAIN:
                found[name] = converted_keys(name, found[name], scale_of(name, socket).to_input)
    return found


def _feeds(node: Node, socket: NodeSocket) -> bool:
    """Whether a trajectory's node feeds an input, of older files through a converter."""
    sources = [link.from_node for link in socket.links]
    return node in sources or any(node == link.from_node for of in sources if _converts(of)
                                  for link in of.inputs[0].links)  # fmt: skip


def _converts(node: Node) -> bool:
    return node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None and TO_INPUT in node.node_tree


def _clock(node: Node, age: ArrayLike) -> NDArray[np.float64]:
    """The age of all points where neither Rate nor Offset comes from a texture."""
    _, rate, offset = clock(node)
    return local_age(np.clip(age, 0.0, 1.0), rate.default_value, offset.default_value)


def _by_frame(
    material: Material, node: Node, held: Mapping[str, Keyframes], sockets: Mapping[str, NodeSocket]
) -> dict[NodeSocket, Keyframes]:
    """The keys of each input, by frame, that play what the material's Age plays."""
    curve = next((one for one in curves_of(material, ()) if len(one.keyframe_points)), None)
    if curve is None:
        now = _clock(node, [clock(node)[0].default_value])
        return {sockets[name]: Keyframes(np.zeros(1), keys.law()(now)) for name, keys in held.items()}
    knots = np.array([point.co.x for point in curve.keyframe_points])
    straight = knots.size == 1 or all(point.interpolation == "LINEAR" for point in curve.keyframe_points)

    def local(frames: NDArray[np.float64]) -> NDArray[np.float64]:
        return _clock(node, [curve.evaluate(frame) for frame in frames])

    found = {}
    for name, keys in held.items():
        law = keys.law()
        if straight:
            frames = _passing(knots, local(knots), keys.times)
            found[sockets[name]] = Keyframes(frames, law(np.interp(frames, knots, local(knots))))
        else:
            shaped = _tabulated(knots, lambda frames, law=law: law(local(frames)))  # type: ignore[misc]
            found[sockets[name]] = place_keys(Trajectory({name: shaped}, knots[0], knots[-1]), name)
    return found


def _passing(
    knots: NDArray[np.float64], at: NDArray[np.float64], ages: NDArray[np.float64]
) -> NDArray[np.float64]:  # fmt: skip
    """The frames ``knots``, where a clock that goes straight between them is ``at``, and those where it passes ages."""
    times = [knots]
    for a, b, x, y in zip(at[:-1], at[1:], knots[:-1], knots[1:], strict=True):
        passed = ages[(ages > min(a, b)) & (ages < max(a, b))]
        times.append(x + (passed - a) / (b - a) * (y - x) if passed.size else passed)
    return np.unique(np.concatenate(times))


def _tabulated(knots: NDArray[np.float64], evaluate: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> Keys:
    """What is played from key frame to key frame, in PIECES straight ones, as an artist may have bent it."""
    each = max(PIECES // (knots.size - 1), 4)
    parts = np.arange(each) / each
    between = (knots[:-1, None] + parts * np.diff(knots)[:, None]).ravel()
    frames = np.unique(np.append(between, knots[-1]))
    return Keys(frames, evaluate(frames))


def courses(material: Material, sockets: Mapping[str, NodeSocket]) -> dict[str, Keyframes]:
    """The course of each input that changes, by its parameter and age, as a material's curves or ramps have it now."""
    node = trajectory_node(material)
    if node is not None:
        return _read_keys(node, sockets)
    found: dict[str, Keyframes] = {}
    moving = [curve for curve in curves_of(material, sockets.values()) if len(curve.keyframe_points)]
    first, last = span_of(moving) if moving else (0.0, 1.0)
    for name, socket in sockets.items():
        path = socket.path_from_id("default_value")
        of_socket = {curve.array_index: curve for curve in moving if curve.data_path == path}
        if of_socket:
            frames = np.unique([point.co.x for curve in of_socket.values() for point in curve.keyframe_points])
            if frames.size == 1:
                found[name] = Keyframes(np.zeros(1), fcurves.evaluate(socket.default_value, of_socket, frames))
            elif any(point.interpolation != "LINEAR" for of in of_socket.values() for point in of.keyframe_points):
                law = _tabulated(frames, partial(fcurves.evaluate, socket.default_value, of_socket))
                played = place_keys(Trajectory({name: law}, first, last), name)
                found[name] = Keyframes((played.times - first) / (last - first), played.values)
            else:
                values = fcurves.evaluate(socket.default_value, of_socket, frames)
                found[name] = Keyframes((frames - first) / max(last - first, fcurves.CLOSEST), values)
    return found


def remove(material: Material, sockets: Mapping[str, NodeSocket]) -> None:
    """Take the course away; the material stays as the current frame shows it."""
    fcurves.make_own(material)
    frame = bpy.context.scene.frame_current_final
    for curve in curves_of(material, sockets.values()):  # an unused material's inputs do not follow the frame
        socket = material.node_tree.path_resolve(curve.data_path.rpartition(".")[0])
        fcurves.set_channel(socket, curve.array_index, curve.evaluate(frame))
    node = trajectory_node(material)
    if node is not None:
        held, now = _read_keys(node, sockets), _clock(node, clock(node)[0].default_value)
        _drop_trajectory(material, node)
        for name, keys in held.items():
            for channel, value in enumerate(np.atleast_1d(keys.law()(now))):
                fcurves.set_channel(sockets[name], channel, float(value))
    fcurves.remove_curves(material, curves_of(material, sockets.values()))


def replace_curves(material: Material, sockets: Mapping[str, NodeSocket], keys: Mapping[str, Keyframes]) -> None:
    """Give inputs that have F-curves straight ones of these keys instead, by age over the same frames."""
    fcurves.make_own(material)
    first, last = span_of(curves_of(material, sockets.values()))
    for name, of in keys.items():
        fcurves.remove_curves(material, curves_of(material, [sockets[name]]))
        frames = Keyframes(first + of.times * (last - first), of.values)
        fcurves.write_keys(material, sockets[name], frames, "linear")


def _drop_trajectory(material: Material, node: Node) -> None:
    """The node and the curve of its Age, and its group and texts where nothing else uses them."""
    group = node.node_tree
    fcurves.remove_curves(material, curves_of(material, ()))
    for one in {link.to_node for socket in node.outputs for link in socket.links}:
        if _converts(one):
            material.node_tree.nodes.remove(one)
    material.node_tree.nodes.remove(node)
    nodegroups.remove_unused(group)
