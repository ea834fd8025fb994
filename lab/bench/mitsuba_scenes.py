# SPDX-License-Identifier: GPL-3.0-or-later
"""Mitsuba's own process: the scenes of scenes.py as its dictionaries, and rendering them on request. Imports no bpy.

Tests compare its pictures with those of scenes.py. Two things differ: the ball is a sphere, where Cycles has a fine
smooth mesh, and each point of the environment map is the mean of its surroundings. The sampler is the best of Mitsuba's
that take any number of samples: on the softbox at 64 its noise is a quarter of the default's.
"""

from __future__ import annotations

import contextlib
import sys
import time
from functools import cached_property
from math import atan, degrees, pi, tan
from typing import TYPE_CHECKING, Any

import numpy as np

from ...headless import pipe
from . import scene_table as table

if TYPE_CHECKING:
    from numpy.typing import NDArray

BOUNCES = 12  # of Blender's defaults
PROBES = 8  # each way, of a cell of the environment map
FAR = 1e4  # metres to the disc of the sun: a metre beside the ball's middle it has moved by 0.006 of its 0.53 degrees
SCENES = tuple(name for name in table.SCENES if name != "furnace")


def stage(mi: Any, name: str, bsdf: dict[str, Any], world: Any, size: int) -> dict[str, Any]:
    """A scene of scenes.py, as Mitsuba's dictionary, under ``world`` if it is mapped. ValueError if there is none."""
    if name not in SCENES:
        message = f"no scene {name!r}; there are {', '.join(SCENES)}"
        raise ValueError(message)
    ball = {"type": "sphere", "center": [0.0, 0.0, 1.0], "bsdf": bsdf}
    found = {"type": "scene", "ball": ball, "integrator": {"type": "path", "max_depth": BOUNCES + 1}}
    kind = table.SCENES[name]
    if kind.floor:
        eye = placed(mi, table.CHECKER_CAMERA, table.CHECKER_DEGREES)
    else:
        eye = placed(mi, (0.0, -table.DISTANCE, 1.0), 90.0)
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb", "component_format": "float32"}
    found["sensor"] = {
        "type": "perspective",
        "fov": degrees(2.0 * atan(table.SENSOR / 2.0 / table.LENS)),
        "to_world": eye @ turned(mi),  # Blender's camera looks along -z, with x to the right
        "film": film | {"rfilter": {"type": "box"}},
        "sampler": {"type": "multijitter"},
    }
    if kind.mapped:
        # Mitsuba's map has y up, and its middle column along z
        axes = mi.ScalarTransform4f([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
        found["world"] = {"type": "envmap", "bitmap": world, "to_world": axes}
    elif kind.world:
        found["world"] = {"type": "constant", "radiance": rgb([kind.world] * 3)}
    if kind.lamp == "AREA":
        shape = placed(mi, table.LAMP_LOCATION, *table.LAMP_DEGREES) @ turned(mi) @ scaled(mi, table.SOFTBOX_SIDE / 2.0)
        found["lamp"] = lamp("rectangle", shape, table.SOFTBOX_WATTS / pi / table.SOFTBOX_SIDE**2)
    elif kind.lamp == "SUN":
        half = table.SUN_ANGLE / 2.0
        above = placed(mi, (0.0, 0.0, 1.0), *table.LAMP_DEGREES) @ mi.ScalarTransform4f().translate([0.0, 0.0, FAR])
        disc = above @ turned(mi) @ scaled(mi, FAR * tan(half))
        found["lamp"] = lamp("disk", disc, table.SUN_STRENGTH / (pi * np.sin(half) ** 2))
    if kind.floor:
        dark, light = (rgb([level] * 3) for level in table.CHECKER_LEVELS)
        squares = {"type": "checkerboard", "color0": dark, "color1": light}
        pairs = table.FLOOR_HALF / table.CHECKER_SIDE  # of squares, across the floor
        squares["to_uv"] = mi.ScalarTransform4f().scale([pairs, pairs, 1.0])
        floor = {"type": "rectangle", "to_world": scaled(mi, table.FLOOR_HALF)}
        found["floor"] = floor | {"bsdf": {"type": "diffuse", "reflectance": squares}}
    return found


def rgb(values: Any) -> dict[str, Any]:
    return {"type": "rgb", "value": [float(v) for v in values]}


def roughness(kind: str, m: float) -> dict[str, Any]:
    """A BSDF of that kind, rough with slope m by Beckmann's D, or smooth if m is 0."""
    return {"type": f"rough{kind}", "distribution": "beckmann", "alpha": m} if m else {"type": kind}


def lamp(shape: str, to_world: Any, radiance: float) -> dict[str, Any]:
    """A black shape that shines along its z."""
    black = {"type": "diffuse", "reflectance": rgb([0.0] * 3)}
    shine = {"type": "area", "radiance": rgb([radiance] * 3)}
    return {"type": shape, "to_world": to_world, "bsdf": black, "emitter": shine}


def placed(mi: Any, location: tuple[float, float, float], x: float, z: float = 0.0) -> Any:
    """Of an object in Blender, rotated by (x, 0, z) degrees."""
    transform = mi.ScalarTransform4f()
    return transform.translate(location) @ transform.rotate([0, 0, 1], z) @ transform.rotate([1, 0, 0], x)


def turned(mi: Any) -> Any:
    """From Blender, where cameras and lamps face along -z, to Mitsuba."""
    return mi.ScalarTransform4f().rotate([0, 1, 0], 180.0)


def scaled(mi: Any, factor: float) -> Any:
    return mi.ScalarTransform4f().scale(factor)


def resampled(world: NDArray[np.float32]) -> NDArray[np.float32]:
    """An environment map as Cycles interpolates and the scene cuts it, on the lattice of Mitsuba's.

    Columns are alike; rows are pixels' middles in Cycles, but begin and end at the poles in Mitsuba. A point of the
    lattice has the mean of the cell around it: interpolated between points that were cut, light would be lost (0.25 %
    of what the ball reflects).
    """
    height, width, _ = world.shape
    offsets = (np.arange(PROBES) + 0.5) / PROBES - 0.5
    y, x = np.arange(height + 1) - 0.5, np.arange(width, dtype=np.float64)
    total = np.zeros((len(y), len(x), 3), np.float32)
    for down in offsets:
        rows = _between(world, np.clip(y + down, 0.0, height - 1.0)).transpose(1, 0, 2)
        for across in offsets:
            total += np.minimum(_between(rows, x + across).transpose(1, 0, 2), table.BRIGHTEST)
    return total / np.float32(PROBES**2)


def _between(lines: NDArray[np.float32], at: NDArray[np.float64]) -> NDArray[np.float32]:
    low = np.floor(at).astype(int)
    share = (at - low)[:, None, None].astype(np.float32)
    return (1.0 - share) * lines[low % len(lines)] + share * lines[(low + 1) % len(lines)]


class Renderer:
    """Mitsuba. Keeps the scene that it rendered last."""

    def __init__(self, variant: str, world: NDArray[np.float32]) -> None:
        import mitsuba as mi

        mi.set_variant(variant)
        mi.set_log_level(mi.LogLevel.Error)
        self.mi, self.pixels = mi, world
        self.compiles = not variant.startswith("scalar")  # and that for each number of samples
        self.loaded: tuple[Any, ...] = ()
        self.warm: set[int] = set()

    def render(self, name: str, bsdf: dict[str, Any], samples: int, seed: int, size: int) -> tuple[Any, ...]:
        """The fields of ``Rendered``."""
        if self.loaded != (name, bsdf, size):
            world = self.world if name in SCENES and table.SCENES[name].mapped else None
            self.shown = self.mi.load_dict(stage(self.mi, name, bsdf, world, size))
            self.loaded, self.warm = (name, bsdf, size), set()
        first = samples if self.compiles else 1
        if first not in self.warm:
            self._picture(first, seed)
            self.warm.add(first)
        start = time.process_time()
        picture = self._picture(samples, seed)
        return picture, time.process_time() - start

    @cached_property
    def world(self) -> Any:
        return self.mi.Bitmap(resampled(self.pixels))

    def _picture(self, samples: int, seed: int) -> NDArray[np.float64]:
        return np.array(self.mi.render(self.shown, spp=samples, seed=seed), np.float64)  # an array has been computed


def main() -> None:
    """Render what comes on standard input until that ends."""
    answers = pipe.open_answers()
    renderer = Renderer(sys.argv[1], pipe.next_request())
    pipe.answer(answers, renderer.mi.__version__)
    with contextlib.suppress(EOFError):
        while True:
            request = pipe.next_request()
            try:
                found: Any = renderer.render(*request)
            except (RuntimeError, ValueError) as error:
                found = " ".join(str(error).split())
            pipe.answer(answers, found)


if __name__ == "__main__":
    main()
