# SPDX-License-Identifier: GPL-3.0-or-later
"""F-curves on the inputs of a material's nodes: write, move, evaluate and remove them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ..reference.keyframes import Keyframes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from bpy.types import ChannelBag, FCurve, Material, NodeSocket
    from numpy.typing import NDArray

CLOSEST = 1e-3  # frames: Blender takes keys within 1e-4 for one when it plays them


def channelbag(material: Material, *, make: bool = False) -> ChannelBag | None:
    """The F-curves of a material's node tree; None if it has none and they are not to be made."""
    tree = material.node_tree
    data = tree.animation_data_create() if make else tree.animation_data
    if data is None:
        return None
    if make and data.action is None:
        data.action = bpy.data.actions.new(f"{material.name} Course")
    action = data.action
    if make and data.action_slot is None:
        data.action_slot = action.slots.new(id_type="NODETREE", name=material.name)
    if make and not action.layers:
        action.layers.new(name="Layer")
    if make and not action.layers[0].strips:
        action.layers[0].strips.new(type="KEYFRAME")
    if action is None or data.action_slot is None or not action.layers or not action.layers[0].strips:
        return None
    return action.layers[0].strips[0].channelbag(data.action_slot, ensure=make)


def make_own(material: Material) -> None:
    """Copy the curves of a duplicated material, which Blender lets it share with the original."""
    data = material.node_tree.animation_data
    if data is None or data.action is None or data.action.users - data.action.use_fake_user < 2:
        return
    identifier = data.action_slot.identifier
    data.action = data.action.copy()
    data.action_slot = data.action.slots[identifier]


def write_keys(material: Material, socket: NodeSocket, keys: Keyframes, interpolation: str) -> None:
    """Give an input F-curves of these keys, by frame; a channel that stands still gets its value and no curve."""
    for channel, part in enumerate(_channels(keys)):
        set_channel(socket, channel, part.values[0])
        if np.ptp(part.values) > 0.0:
            bag = channelbag(material, make=True)
            assert bag is not None  # noqa: S101 - it was made
            path = socket.path_from_id("default_value")
            if (own := bag.fcurves.find(path, index=channel)) is not None:  # of an artist, on what was linked
                bag.fcurves.remove(own)
            curve = bag.fcurves.new(path, index=channel)
            _write(curve, apart(part), interpolation)


def _channels(keys: Keyframes) -> list[Keyframes]:
    if keys.values.ndim == 1:
        return [keys]

    def of(part: NDArray[np.float64] | None, channel: int) -> NDArray[np.float64] | None:
        return None if part is None else part[:, channel]

    return [Keyframes(keys.times, keys.values[:, k], of(keys.before, k), of(keys.after, k)) for k in range(3)]


def set_channel(socket: NodeSocket, channel: int, value: float) -> None:
    """Set one channel of an input, which may have only one."""
    if hasattr(socket.default_value, "__len__"):
        socket.default_value[channel] = value
    else:
        socket.default_value = value


def apart(keys: Keyframes) -> Keyframes:
    """The first and the last key, and of those between what is CLOSEST to no other that is kept.

    A crowd's first and last key are both kept, if need be moved by up to CLOSEST: before a step the value has come to
    the one, and goes on from the other, for long.
    """
    times, kept, last = keys.times.copy(), [0], keys.times.size - 1
    for k, frame in enumerate(keys.times):
        if 0 < k < last and keys.times[k + 1] - frame >= 2.0 * CLOSEST:
            times[k] = max(frame, times[kept[-1]] + CLOSEST)
            kept.append(k)
        elif frame - times[kept[-1]] >= CLOSEST:
            kept.append(k)
    if kept[-1] != last:
        before = times[last] - CLOSEST
        if len(kept) > 1 and before - times[kept[-2]] >= CLOSEST:
            times[kept[-1]] = before
        elif len(kept) > 1:
            kept.pop()
        kept.append(last)
    parts = (None if part is None else part[kept] for part in (keys.before, keys.after))
    return Keyframes(times[kept], keys.values[kept], *parts)


def _write(curve: FCurve, keys: Keyframes, interpolation: str) -> None:
    points, count = curve.keyframe_points, keys.times.size
    curve.extrapolation = "CONSTANT"
    points.add(count)
    # No curve.update() after this: it would merge keys that are nearer than 1/100 of a frame.
    points.foreach_set("co", np.stack([keys.times, keys.values], axis=-1).astype(np.float32).ravel())
    mode, handle = ("LINEAR", "VECTOR") if interpolation == "linear" else ("BEZIER", "FREE")
    kinds = bpy.types.Keyframe.bl_rna.properties
    for name, kind in (("interpolation", mode), ("handle_left_type", handle), ("handle_right_type", handle)):
        points.foreach_set(name, np.full(count, kinds[name].enum_items[kind].value, np.int32))
    if keys.before is None or keys.after is None:  # handles along the lines, for who changes the interpolation later
        keys = Keyframes(keys.times, keys.values, *_along(keys.values))
    _write_handles(curve, keys)


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


def move_keys(curves: Sequence[FCurve], moved: Callable[[Any], Any], *, backwards: bool) -> None:
    """Move all keys and handles from each frame x to ``moved(x)``. backwards: whether that reverses their order."""
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


def evaluate(value: Any, curves: Mapping[int, FCurve], frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """What the F-curves of one input make of it at each frame; channels without a curve stand still."""
    single = not hasattr(value, "__len__")
    channels = [
        [curves[k].evaluate(frame) if k in curves else (value if single else value[k]) for frame in frames]
        for k in range(1 if single else 3)
    ]
    return np.array(channels[0]) if single else np.array(channels).T


def remove_curves(material: Material, curves: Iterable[FCurve]) -> None:
    """Remove curves, and the action if it then has none and nothing else uses it."""
    bag, data = channelbag(material), material.node_tree.animation_data
    if bag is None:
        return
    for curve in curves:
        bag.fcurves.remove(curve)
    if len(bag.fcurves):
        return
    action = data.action
    data.action = None
    if not len(data.drivers) and not len(data.nla_tracks):  # bound lamps have theirs there
        material.node_tree.animation_data_clear()
    if action.users == 0:
        bpy.data.actions.remove(action)
