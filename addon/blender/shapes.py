# SPDX-License-Identifier: GPL-3.0-or-later
"""The bodies that pictures of presets show a material on: meshes of some 7 cm, made of few numbers. Lengths in cm."""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi, radians, sin, tan
from typing import TYPE_CHECKING

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from bpy.types import Mesh
    from numpy.typing import ArrayLike

CM = 0.01
SEGMENTS = 96
SHARP = 35.0  # degrees between faces from which on an edge is one
LEVEL = 5.4  # of the liquid in the tumbler
Point = tuple[float, float]
Point3 = tuple[float, float, float]


def ball() -> Mesh:
    """A ball for the form and the reflection of all around, on a plate for light at grazing angles."""
    plate = [(0.0, 0.0), *arc(4.1, 0.3, 0.3, -90, 0, 6), *arc(4.1, 0.8, 0.3, 0, 90, 6)]
    return lathe("Ball", [*plate, *arc(0.0, 3.9, 3.0, -75, 90, 48)])


def vase() -> Mesh:
    """A belly, a neck and a lip, and an inside."""
    belly = [(0.0, 0.0), (1.6, 0.0), *arc(1.0, 2.7, 2.1, -70, 52, 24)]
    neck = [*arc(3.0, 5.55, 1.3, 220, 150, 16)[1:], *arc(2.05, 6.95, 0.12, 0, 180, 8)]
    return lathe("Vase", [*belly, *neck, (1.55, 5.6), (1.9, 4.4), (2.6, 2.7), (1.5, 0.5), (0.0, 0.4)])


def tumbler() -> Mesh:
    """The glass that a liquid stands in: walls of 2 mm on a thick base."""
    outside = [(0.0, 0.0), *arc(2.45, 0.2, 0.2, -90, -5, 5), *arc(3.1, 7.4, 0.1, -5, 180, 8)]
    return lathe("Tumbler", [*outside, *arc(2.15, 1.1, 0.3, 0, -90, 6), (0.0, 0.8)])


def liquid() -> Mesh:
    """The tumbler's filling. It reaches 0.2 mm into the glass: a gap would mirror, one shared surface flickers."""
    inside = [(0.0, 0.78), *arc(2.15, 1.1, 0.32, -90, 0, 6)]
    edge = LEVEL + 0.15  # water climbs where it touches
    wall = 2.47 + 0.55 * (edge - 1.1) / 6.3
    return lathe("Liquid", [*inside, *arc(wall - 0.15, edge, 0.15, 0, -90, 5), (0.0, LEVEL)])


def gem(radius: float = 3.9) -> Mesh:
    """A round brilliant of 57 facets, after Tolkowsky, lying on its pavilion with the table toward the camera.

    Table 57 % of the girdle's diameter, crown 34.5 degrees, pavilion 40.75, star facets half and lower ones 77 % of
    their way: every corner lies on the planes of the eight main facets above or below, so that all facets are flat.
    """
    table, crown, pavilion, girdle, low = 0.57, tan(radians(34.5)), tan(radians(40.75)), 0.015, 0.23
    half = cos(pi / 8)
    star = 0.5 * (1.0 + table * half)

    def ring(r: float, z: float, count: int, turn: float = 0.0) -> list[tuple[float, float, float]]:
        return [(r * cos(a), r * sin(a), z) for a in (2.0 * pi * (k + turn) / count for k in range(count))]

    points = [
        *ring(table, girdle + crown * (1.0 - table), 8),  # 0: of the table
        *ring(star, girdle + crown * (1.0 - star * half), 8, 0.5),  # 8: where stars end
        *ring(1.0, girdle, 16),  # 16: above the girdle
        *ring(1.0, -girdle, 16),  # 32: below it
        *ring(low, -girdle - pavilion * (1.0 - low * half), 8, 0.5),  # 48: where the lower facets end
        (0.0, 0.0, -girdle - pavilion),  # 56: the culet
    ]
    faces: list[Sequence[int]] = [range(8)]
    for k in range(8):
        on, main, nxt, mid = (k + 1) % 8, 16 + 2 * k, 16 + (2 * k + 2) % 16, 17 + 2 * k
        faces += [(k, 8 + k, on), (k, 8 + (k - 1) % 8, main, 8 + k), (8 + k, main, mid), (8 + k, mid, nxt)]
        faces += [(main, main + 16, mid + 16, mid), (mid, mid + 16, nxt + 16, nxt)]
        faces += [
            (56, 48 + k, main + 16, 48 + (k - 1) % 8),
            (48 + k, mid + 16, main + 16),
            (48 + k, nxt + 16, mid + 16),
        ]
    return _lying("Gem", radius * np.array(points), faces, tipped=40.75)


def crystal() -> Mesh:
    """A hexagonal prism with a point, leaning to the camera's right."""
    ring = [(2.1 * cos(k * pi / 3), 2.1 * sin(k * pi / 3)) for k in range(6)]
    points = [(x, y, z) for z in (0.0, 4.9) for x, y in ring] + [(0.0, 0.0, 7.4)]
    sides = [(k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k) for k in range(6)]
    tip = [(6 + k, 6 + (k + 1) % 6, 12) for k in range(6)]
    return _mesh("Crystal", points, [range(5, -1, -1), *sides, *tip])


def cloth() -> Mesh:
    """A curtain that hangs into the picture, in folds that deepen and wander toward the hem."""
    u, z = np.meshgrid(np.linspace(-1.0, 1.0, 241), np.linspace(12.0, 0.1, 97))
    fall = 1.0 - z / 12.0
    fold = np.sin(8.2 * u + 0.9 * fall) + 0.45 * np.sin(17.0 * u + 1.3 - 1.6 * fall) + 0.25 * np.sin(4.1 * u - 2.0)
    x = 4.3 * u + (0.25 + 0.2 * fall) * np.sin(16.4 * u + 1.8 * fall)
    return _grid("Cloth", np.stack([x, (0.35 + 0.55 * fall) * fold, z], axis=-1))


def sheet() -> Mesh:
    """A page that lies flat in front and rolls up behind."""
    roll = np.array([(0.6, 0.05), *arc(0.6, 2.2, 2.15, -90, 150, 60)[1:]])
    profile = np.concatenate([np.stack([np.linspace(-3.8, 0.5, 12), np.full(12, 0.05)], axis=-1), roll])
    x, along = np.meshgrid(np.linspace(-3.6, 3.6, 2), profile[:, 0])
    return _grid("Sheet", np.stack([x, along, np.broadcast_to(profile[:, 1:], x.shape)], axis=-1))


def boards() -> Mesh:
    """Three planks, stacked crosswise."""
    return boxes("Boards", [((7.4, 2.8, 1.1), (0.0, -0.4, 0.55), 18), ((7.0, 2.8, 1.1), (0.2, 0.1, 1.65), -24),
                             ((6.2, 2.8, 1.1), (0.0, 0.0, 2.75), 34)])  # fmt: skip


def block() -> Mesh:
    """A cube, and a slab that it stands on."""
    return boxes("Block", [((7.0, 6.0, 1.0), (0.0, 0.0, 0.5), 24), ((4.0, 4.0, 4.0), (0.0, 0.2, 3.0), 38)])


def pane() -> Mesh:
    """A thin pane that stands, without an inside."""
    corners = np.array([(-3.4, 0.0, 0.4), (3.4, 0.0, 0.4), (-3.4, 0.0, 7.0), (3.4, 0.0, 7.0)]).reshape(2, 2, 3)
    return _grid("Pane", corners)


def frame() -> Mesh:
    """What holds the pane."""
    posts = [((0.25, 0.4, 7.2), (x, 0.0, 3.7), 0.0) for x in (-3.5, 3.5)]
    rails = [((7.25, 0.4, 0.25), (0.0, 0.0, z), 0.0) for z in (0.25, 7.15)]
    return boxes("Frame", [*posts, *rails], rounding=0.05)


def lathe(name: str, profile: Sequence[Point]) -> Mesh:
    """(r, z) turned about z; it begins and ends on the axis, and faces the right of the way from first to last."""
    ring, rows = np.arange(SEGMENTS) * 2.0 * pi / SEGMENTS, profile[1:-1]
    points = [(r * cos(t), r * sin(t), z) for r, z in rows for t in ring]
    first, last = len(points), len(points) - SEGMENTS
    points += [(0.0, 0.0, profile[0][1]), (0.0, 0.0, profile[-1][1])]
    faces: list[Sequence[int]] = []
    for s, t in pairwise([*range(SEGMENTS), 0]):
        faces += [(first, t, s), (first + 1, last + s, last + t)]
        faces += [(r + s, r + t, r + SEGMENTS + t, r + SEGMENTS + s) for r in range(0, last, SEGMENTS)]
    return _mesh(name, points, faces, smooth=True)


def arc(r: float, z: float, radius: float, start: float, end: float, steps: int) -> list[Point]:
    """Points of a circle about (r, z), from one angle to another in degrees."""
    turns = np.radians(np.linspace(start, end, steps + 1))
    return [(r + radius * cos(turn), z + radius * sin(turn)) for turn in turns]


def _mesh(name: str, points: ArrayLike, faces: Iterable[Iterable[int]], *, smooth: bool = False) -> Mesh:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((CM * np.asarray(points, float)).tolist(), [], [tuple(face) for face in faces])
    if smooth:
        mesh.shade_smooth()
        mesh.set_sharp_from_angle(angle=radians(SHARP))
    return mesh


def _grid(name: str, points: np.ndarray) -> Mesh:
    """A smooth sheet of (rows, columns, 3) points."""
    rows, columns = points.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    corners = (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])
    return _mesh(name, points.reshape(-1, 3), np.stack(corners, axis=-1).reshape(-1, 4).tolist(), smooth=True)


def _lying(name: str, points: np.ndarray, faces: Sequence[Sequence[int]], tipped: float) -> Mesh:
    """Turned by degrees about x, with its lowest point on the ground and its middle over the origin."""
    c, s = cos(radians(tipped)), sin(radians(tipped))
    turned = points @ np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])
    low, high = turned.min(axis=0), turned.max(axis=0)
    return _mesh(name, turned - [0.0, 0.5 * (low[1] + high[1]), low[2]], faces)


def boxes(name: str, each: Sequence[tuple[Point3, Point3, float]], rounding: float = 0.12) -> Mesh:
    """Boxes with rounded edges: size, middle, and degrees about z of each."""
    mesh, made = bpy.data.meshes.new(name), bmesh.new()
    for size, middle, turn in each:
        place = Matrix.Translation(CM * Vector(middle)) @ Matrix.Rotation(radians(turn), 4, "Z")
        bmesh.ops.create_cube(made, size=CM, matrix=place @ Matrix.Diagonal((*size, 1.0)))
    bmesh.ops.bevel(made, geom=made.edges[:], offset=rounding * CM, segments=4, profile=0.5, affect="EDGES")
    made.to_mesh(mesh)
    made.free()
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=radians(SHARP))
    return mesh
