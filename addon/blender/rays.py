# SPDX-License-Identifier: GPL-3.0-or-later
"""How many rays of one pixel differ from each other: of what stands still, random numbers are hashed from these alone.

Cycles rounds where a ray starts to float32 in world space, that is to 2^-24 of the distance from the origin, and its
direction to 2^-24. Orthographic rays all have one direction; far from the origin, or between samples that the pixel
filter keeps close together, few of them differ. Samples that share a ray share their random numbers: of rays that come
up with chances p, the sum of p^2 is that of a pair to do so, and M is 1 over it. To the variance v / N of N independent
samples then comes (1 - 1/N) v / M; samples that Cycles spreads evenly meet less often, but are never better than v / N
or v / M. A lens that has an aperture gives each ray a direction of its own.

Within its triangle what moves is met elsewhere at each moment (Parametric, in random_numbers.py): there more differ.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bpy.types import Camera, Object, Scene
    from mathutils import Vector
    from numpy.typing import NDArray

SAMPLED_RAYS = 4096  # rays, of which 8 million pairs: M is known to a tenth up to 80 000
MOST = 2**17  # samples to which that is enough to tell whether 8 times as many rays differ
APERTURE = 2.0**-14  # radius over focal distance: blurs by 1/16 of a pixel what is 1024 pixels out of focus


def different_rays(scene: Scene) -> float:
    """How many rays of a pixel in the middle of the picture differ: M, at most ``SAMPLED_RAYS`` squared over 2.

    All rays of panoramic cameras and of those that a shader drives count as different: they are not computed here.
    """
    if scene.camera is None or scene.camera.type != "CAMERA" or scene.camera.data.type not in {"ORTHO", "PERSP"}:
        return float(SAMPLED_RAYS**2 / 2)
    x, y, u, v = np.random.default_rng(1).random((4, SAMPLED_RAYS), dtype=np.float32)
    rows = np.concatenate(_rays(scene, scene.camera, x, y, u, v), axis=-1)
    _, counts = np.unique(rows.view(np.uint32).astype(np.uint64) @ _mix(), return_counts=True)
    return different(counts)


def different(counts: NDArray[np.int64]) -> float:
    """M, the effective number of different rays, from how often each drawn one came up, (n,): pairs over equal pairs.

    With N draws and counts n_i, M = N (N - 1) / sum n_i (n_i - 1), at most N (N - 1) / 2. 1 / M is the unbiased
    estimate of sum p_i^2, the chance that two draws are equal (Simpson 1949, Nature 163, 688).
    """
    drawn = int(counts.sum())
    alike = int(np.sum(counts * (counts - 1)))
    return drawn * (drawn - 1) / max(alike, 2)


def _mix() -> NDArray[np.uint64]:
    """Makes one number of six. A function, as NumPy's random numbers take 7 ms to import."""
    return np.random.default_rng(1).integers(0, 2**63, 6, dtype=np.uint64) | np.uint64(1)


def _rays(
    scene: Scene, item: Object, x: NDArray[np.float32], y: NDArray[np.float32], u: NDArray[np.float32],
    v: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:  # fmt: skip
    """Starts and directions (N, 3) in world space, rounded as Cycles does; x, y in 0..1 over what a pixel filters."""
    camera, frame = item.data, item.data.view_frame(scene=scene)
    width = filter_width(scene)
    middle, across, up = _pixel(scene, frame)
    at = middle + width * (np.outer(x - 0.5, across) + np.outer(y - 0.5, up))
    ahead = np.array([0.0, 0.0, -1.0])
    start, way = (at * [1, 1, 0], ahead) if camera.type == "ORTHO" else (0.0 * at, at)
    if radius := aperture(camera):
        focus = focal_distance(item)
        phi = 2.0 * np.pi * v
        lens = radius * np.sqrt(u)[:, None] * np.stack([np.cos(phi), np.sin(phi), 0.0 * v], axis=-1)
        start, way = start + lens, way * (focus / -np.broadcast_to(way, at.shape)[:, 2:]) - lens
    matrix = np.array(item.matrix_world.normalized(), dtype=np.float32)
    turned = np.broadcast_to(way, at.shape).astype(np.float32) @ matrix[:3, :3].T
    direction = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
    return start.astype(np.float32) @ matrix[:3, :3].T + matrix[:3, 3], direction.astype(np.float32)


def _pixel(scene: Scene, frame: tuple[Vector, ...]) -> tuple[NDArray[np.float64], ...]:
    """The middle of the picture and the edges of a pixel there, in camera space."""
    top_right, _, bottom_left, top_left = (np.array(corner) for corner in frame)
    render = scene.render
    scale = render.resolution_percentage / 100.0
    across = (top_right - top_left) / max(1.0, render.resolution_x * scale)
    up = (top_left - bottom_left) / max(1.0, render.resolution_y * scale)
    return (top_right + bottom_left) / 2.0, across, up


def filter_width(scene: Scene) -> float:
    """Width of the pixel filter, in pixels; Blackman-Harris is as dense as a box of this width, over twice as many."""
    return 1.0 if scene.cycles.pixel_filter_type == "BOX" else float(scene.cycles.filter_width)


def aperture(camera: Camera) -> float:
    """The radius of the lens in metres; 0 for a pinhole."""
    if not camera.dof.use_dof:
        return 0.0
    opening = 1.0 if camera.type == "ORTHO" else camera.lens * 1e-3
    return float(opening / (2.0 * max(camera.dof.aperture_fstop, 1e-5)))


def focal_distance(item: Object) -> float:
    """Distance from a camera to its plane of focus, metres."""
    dof = item.data.dof
    if dof.focus_object is None:
        return max(float(dof.focus_distance), 1e-5)
    sight = item.matrix_world.inverted() @ dof.focus_object.matrix_world.translation
    return max(abs(float(sight.z)), 1e-5)


def open_aperture(scene: Scene) -> None:
    """Give an orthographic camera so small an aperture that the picture stays sharp and every ray differs."""
    item, dof = scene.camera, scene.camera.data.dof
    if not dof.use_dof and dof.focus_object is None:
        dof.focus_distance = _middle(scene, item)
    dof.use_dof = True
    dof.aperture_fstop = 1.0 / (2.0 * APERTURE * focal_distance(item))


def _middle(scene: Scene, item: Object) -> float:
    """Distance to the surface in the middle of the picture, metres; without one, the meshes' median distance."""
    rotation = item.matrix_world.to_quaternion()
    ahead = rotation @ type(item.location)((0.0, 0.0, -1.0))
    graph = scene.view_layers[0].depsgraph
    graph.update()
    hit, place, *_ = scene.ray_cast(graph, item.matrix_world.translation, ahead)
    if hit:
        return float((place - item.matrix_world.translation).length)
    inverse = item.matrix_world.inverted()
    depths = [-(inverse @ one.matrix_world.translation).z for one in scene.objects if one.type == "MESH"]
    return float(np.median([d for d in depths if d > 0.0] or [item.data.dof.focus_distance]))
