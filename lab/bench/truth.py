# SPDX-License-Identifier: GPL-3.0-or-later
"""What a ball looks like by its formula: the reference's pictures of the scenes whose light no other thing throws back.

A pixel is the integral, over its square and over the directions wi that light comes from, of f(wi, wo) L(wi) cos. Two
strategies draw wi: the model's own, and each light's. With the balance heuristic a draw of either weighs

    f L cos / (p_model + p_light)

so that neither narrow lobes nor small lights make noise. Points are a scrambled Sobol sequence, which each pixel has
shifted by random numbers of its own: pictures of several seeds are independent, and what they differ by is their error.

Source: Veach 1997, Robust Monte Carlo Methods for Light Transport Simulation, eq. 9.8 (balance heuristic).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi, sin
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from scipy.stats import qmc

from ...addon.blender import images
from ...addon.reference.directions import dot
from ..scenery import background
from . import peers
from .scene_table import SCENES

if TYPE_CHECKING:
    from bpy.types import Object, Scene
    from numpy.typing import NDArray

    from ...addon.library.presets import Preset
    from ...addon.reference import Model
    from .scenes import Stage

    Floats = NDArray[np.float64]
    Light: TypeAlias = "Even | Map | Rectangle | Disc"

LEAST = 0.01  # of a map's mean, added to the density of draws so that dark parts are drawn too
NOWHERE = np.finfo(np.float64).tiny


def has(preset: Preset, scene: str) -> bool:
    """Whether the formula alone says what the scene shows: an opaque ball by itself."""
    return peers.of(preset).LOCAL and SCENES[scene].formula


def picture(shown: Stage, model: Model, samples: int, seed: int) -> Floats:
    """Linear RGB of the ball, (H, W, 3), and 0 in pixels that are not judged. samples: a pixel, a power of two."""
    eye, lights = Eye.of(shown), lights_of(shown)
    points = qmc.Sobol(6 + 2 * len(lights), seed=seed).random(samples)
    shifts = np.random.default_rng(seed).random((*shown.judged.shape, points.shape[1]))
    found = np.zeros((*shown.judged.shape, 3))
    for row, column in zip(*np.nonzero(shown.judged), strict=True):
        u = (points + shifts[row, column]) % 1.0
        place, normal, wo = eye.sees(row + u[:, 0], column + u[:, 1])
        found[row, column] = radiance(model, lights, place, normal, wo, u[:, 2:]).mean(axis=0)
    return found


def radiance(model: Model, lights: list[Light], place: Floats, normal: Floats, wo: Floats, u: Floats) -> Floats:
    """An estimate of what leaves each place (N, 3) toward ``wo``, (N, 3); u: (N, 4 + 2 for each light)."""
    axes = frame(normal)
    wo = _turned(axes, wo)
    wi, weight = model.sample(wo, u[:, :4])
    toward = np.einsum("nij,ni->nj", axes, wi)
    p_model = model.pdf(wi, wo)
    total = np.zeros(wi.shape)
    for index, light in enumerate(lights):
        of_light, p_light = light.seen(place, toward)
        total += weight * of_light * (p_model / np.maximum(p_model + p_light, NOWHERE))[:, None]
        drawn = light.drawn(place, u[:, 4 + 2 * index : 6 + 2 * index])
        if drawn is not None:
            of_light, p_light = light.seen(place, drawn)
            local = _turned(axes, drawn)
            f = model.evaluate(local, wo) * np.maximum(local[:, 2:], 0.0)
            total += f * of_light / np.maximum(model.pdf(local, wo) + p_light, NOWHERE)[:, None]
    return total


@dataclass(frozen=True)
class Eye:
    """A pinhole, the ball in front of it, and a picture of ``size`` x ``size`` pixels. axes: right, up, forward."""

    at: Floats
    axes: Floats
    half: float  # of the picture's width, a unit in front of it
    middle: Floats  # of the ball, of radius 1
    size: int

    @classmethod
    def of(cls, shown: Stage) -> Eye:
        camera = shown.scene.camera
        turned = np.array(camera.matrix_world.to_3x3()).T * np.array([[1.0], [1.0], [-1.0]])
        half = camera.data.sensor_width / camera.data.lens / 2.0
        return cls(np.array(camera.location), turned, half, np.array(shown.item.location), shown.judged.shape[0])

    def sees(self, row: Floats, column: Floats) -> tuple[Floats, Floats, Floats]:
        """Places on the ball, normals and wo at points of the picture, in pixels from its upper left; (N, 3) each."""
        x, y = self.half * (2.0 * column / self.size - 1.0), self.half * (1.0 - 2.0 * row / self.size)
        ray = _unit(np.stack([x, y, np.ones_like(x)], axis=-1) @ self.axes)
        off = self.at - self.middle
        along = ray @ off
        near = -along - np.sqrt(np.maximum(along**2 - off @ off + 1.0, 0.0))
        normal = _unit(off + near[:, None] * ray)
        return self.middle + normal, normal, -ray


# Lights. ``seen``: radiance (N, 3), and the density of ``drawn`` in 1/sr, (N,), toward directions (N, 3) that point
# away from the ball. ``drawn``: such directions for u (N, 2) in [0, 1); None of a light that needs no drawing.


@dataclass(frozen=True)
class Even:
    """The same from everywhere."""

    level: Floats

    def seen(self, _place: Floats, toward: Floats) -> tuple[Floats, Floats]:
        return np.broadcast_to(self.level, toward.shape), np.zeros(len(toward))

    def drawn(self, _place: Floats, _u: Floats) -> Floats | None:
        return None


@dataclass(frozen=True)
class Map:
    """An equirectangular picture (H, W, 3), interpolated as Cycles does, and nowhere brighter than ``brightest``."""

    pixels: Floats
    brightest: float

    def seen(self, _place: Floats, toward: Floats) -> tuple[Floats, Floats]:
        rows, columns = self._cell(toward)
        y, x = np.clip(rows - 0.5, 0.0, len(self.pixels) - 1.0), columns - 0.5
        top, left = np.floor(y).astype(int), np.floor(x).astype(int)
        down, right = (y - top)[:, None], (x - left)[:, None]
        below, beside = np.minimum(top + 1, len(self.pixels) - 1), (left + 1) % self.pixels.shape[1]
        left %= self.pixels.shape[1]
        upper = (1.0 - right) * self.pixels[top, left] + right * self.pixels[top, beside]
        lower = (1.0 - right) * self.pixels[below, left] + right * self.pixels[below, beside]
        return np.minimum((1.0 - down) * upper + down * lower, self.brightest), self._density(toward)

    def drawn(self, _place: Floats, u: Floats) -> Floats:
        height, width = self._shares.shape
        ends = self._ends
        cell = np.minimum(np.searchsorted(ends, u[:, 0] * ends[-1], side="right"), height * width - 1)
        row, column = np.divmod(cell, width)
        across = 1.0 - (ends[cell] - u[:, 0] * ends[-1]) / self._shares.ravel()[cell]
        down = u[:, 1]
        theta, phi = pi * (row + down) / height, 2.0 * pi * (0.5 - (column + across) / width)
        return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)

    @cached_property
    def _shares(self) -> Floats:
        """Of the draws that each cell has, (H, W), by its light; they add up to 1."""
        height = len(self.pixels)
        held = np.minimum(self.pixels, self.brightest).mean(axis=-1)
        shares = (held + LEAST * held.mean()) * np.sin((np.arange(height)[:, None] + 0.5) / height * pi)
        return shares / shares.sum()

    @cached_property
    def _ends(self) -> Floats:
        """Where each cell's share ends, one row after the other."""
        return np.cumsum(self._shares)

    def _density(self, toward: Floats) -> Floats:
        """That of a cell, over its solid angle."""
        rows, columns = (np.floor(of).astype(int) for of in self._cell(toward))
        height, width = self._shares.shape
        share = self._shares[np.clip(rows, 0, height - 1), columns % width]
        return share * height * width / (2.0 * pi**2 * np.maximum(np.hypot(toward[:, 0], toward[:, 1]), NOWHERE))

    def _cell(self, toward: Floats) -> tuple[Floats, Floats]:
        """Row and column, from the upper left corner; x points at the middle, y to the left of it."""
        x, y, z = toward.T
        height, width, _ = self.pixels.shape
        return height * (0.5 - np.arctan2(z, np.hypot(x, y)) / pi), width * (0.5 - np.arctan2(y, x) / (2.0 * pi))


@dataclass(frozen=True)
class Rectangle:
    """A lamp that shines evenly from one side. axes: right, up, away from where it shines."""

    at: Floats
    axes: Floats
    sides: Floats  # lengths, (2,)
    level: float  # radiance

    def seen(self, place: Floats, toward: Floats) -> tuple[Floats, Floats]:
        cos = toward @ self.axes[2]
        off = self.at - place
        far = off @ self.axes[2] / np.where(cos > 0.0, cos, 1.0)
        hit = (far[:, None] * toward - off) @ self.axes[:2].T
        inside = (cos > 0.0) & (far > 0.0) & np.all(np.abs(hit) <= self.sides / 2.0, axis=-1)
        density = np.where(inside, far**2 / np.where(inside, cos, 1.0) / self.sides.prod(), 0.0)
        return np.where(inside, self.level, 0.0)[:, None] * np.ones(3), density

    def drawn(self, place: Floats, u: Floats) -> Floats:
        return _unit(self.at + ((u - 0.5) * self.sides) @ self.axes[:2] - place)


@dataclass(frozen=True)
class Disc:
    """A sun. axes: right, up, toward it; angle: from its middle to its edge, in radians."""

    axes: Floats
    angle: float
    level: float  # radiance

    def seen(self, _place: Floats, toward: Floats) -> tuple[Floats, Floats]:
        inside = np.linalg.norm(np.cross(toward, self.axes[2]), axis=-1) <= sin(self.angle) * (1.0 + 1e-9)
        inside &= toward @ self.axes[2] > 0.0
        whole = 4.0 * pi * sin(self.angle / 2.0) ** 2
        return np.where(inside, self.level, 0.0)[:, None] * np.ones(3), np.where(inside, 1.0 / whole, 0.0)

    def drawn(self, _place: Floats, u: Floats) -> Floats:
        half = np.sqrt(u[:, 0]) * sin(self.angle / 2.0)  # sin of half the angle off its middle: even over solid angle
        off, phi = 2.0 * half * np.sqrt(1.0 - half**2), 2.0 * pi * u[:, 1]
        return np.stack([off * np.cos(phi), off * np.sin(phi), 1.0 - 2.0 * half**2], axis=-1) @ self.axes


def lights_of(shown: Stage) -> list[Light]:
    """The world and the lamp of a stage. ValueError if one is of another kind."""
    return [*_world(shown.scene), *([_lamp(shown.lamp)] if shown.lamp else [])]


def _world(shown: Scene) -> list[Light]:
    colour = background(shown.world).inputs["Color"]
    if not colour.is_linked:
        level = np.array(colour.default_value[:3])
        return [Even(level)] if level.any() else []
    held = colour.links[0].from_node
    picture_node = held.inputs[0].links[0].from_node
    return [Map(images.pixels(picture_node.image).astype(np.float64), held.inputs[1].default_value[0])]


def _lamp(item: Object) -> Light:
    axes = np.array(item.matrix_world.to_3x3()).T
    if item.data.type == "SUN":
        half = item.data.angle / 2.0
        return Disc(axes, half, item.data.energy / (pi * sin(half) ** 2))
    if item.data.type != "AREA":
        message = f"{item.name} is a lamp of kind {item.data.type}; there are AREA and SUN"
        raise ValueError(message)
    sides = np.array([item.data.size] * 2)
    return Rectangle(np.array(item.location), axes, sides, item.data.energy / (pi * sides.prod()))


def frame(normal: Floats) -> Floats:
    """Two tangents and the normal itself, (N, 3, 3), without a seam but at -z.

    Source: Duff et al. 2017, Building an Orthonormal Basis, Revisited (Journal of Computer Graphics Techniques 6).
    """
    x, y, z = normal.T
    side = np.where(z >= 0.0, 1.0, -1.0)
    a = -1.0 / (side + z)
    b = x * y * a
    tangent = np.stack([1.0 + side * x**2 * a, side * b, -side * x], axis=-1)
    return np.stack([tangent, np.stack([b, side + y**2 * a, -y], axis=-1), normal], axis=1)


def _turned(axes: Floats, direction: Floats) -> Floats:
    """Into the frame."""
    return dot(axes, direction[:, None, :])


def _unit(vector: Floats) -> Floats:
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)
