# SPDX-License-Identifier: GPL-3.0-or-later
"""The peer Mitsuba 3, on the scenes that it and Cycles can both express. Imports no bpy until a ``Peer`` begins.

Mitsuba runs in a process of its own, which stays warm: its libraries and Blender's must not meet in one. Requests go
down its standard input, pictures come up its standard output, pickled.

The scenes are those of scenes.py, whose numbers stand here again, as that module needs Blender; the tests hold the two
against each other. They differ in two things: the ball is a sphere, where Cycles has a fine smooth mesh, and the
environment map is given point by point as the mean of its surroundings. The sampler is the best of Mitsuba's that take
any number of samples: on the softbox at 64 its noise is a quarter of the default's.

The variant that compiles is three to four times as fast as the plain one, but needs an LLVM new enough (15 is not;
DRJIT_LIBLLVM_PATH names another than the system's). It is tried first, in a process that may end over it.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from functools import cache, cached_property
from math import atan, degrees, pi, radians, tan
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Self

import numpy as np
from scipy.optimize import minimize_scalar

from ...addon.reference.fresnel import fresnel_conductor, schlick

if TYPE_CHECKING:
    from types import TracebackType

    from numpy.typing import NDArray

    from ...addon.library.presets import Preset

VARIANTS = ("llvm_ad_rgb", "scalar_rgb")  # the quickest first
SCENES = ("environment", "softbox", "sun", "outdoors", "checker")
MAPPED = ("environment", "outdoors", "checker")  # lit by the map
DIFFERS = {  # by the type of BSDF
    "roughconductor": (
        "G is Smith's of each direction by itself in place of the V-groove's; F is that of a conductor with Schlick's "
        "F0, whose n is chosen for the least difference, on copper 0.007 at most"
    ),
    "conductor": "F is that of a conductor with Schlick's F0, whose n is chosen for the least difference",
    "roughplastic": (
        "G is Smith's; the base lies under the coat: light crosses it twice and is in part thrown back from within "
        "(nonlinear off: without a change of colour); ours is a sum of two lobes, whose weights it has"
    ),
    "plastic": (
        "the base lies under the coat: light crosses it twice and is in part thrown back from within (nonlinear off: "
        "without a change of colour); ours is a sum of two lobes, whose weights it has"
    ),
    "diffuse": "Lambert's law, as Mitsuba has no Oren-Nayar",
    "dielectric": "the same model, of glass that absorbs and tints nothing",
    "roughdielectric": (
        "G is Smith's in place of the V-groove's, for what passes too; of glass that absorbs and tints nothing"
    ),
}
TRIAL = {"type": "roughconductor", "distribution": "beckmann"}
LAST_WORDS = 300  # characters of what the process said last


class PeerError(RuntimeError):
    """Mitsuba cannot render that, or its process ended."""


@dataclass(frozen=True)
class Rendered:
    """A picture in linear RGB, (H, W, 3), and the seconds that its render took.

    samples: a pixel, as the sampler rounded them up to a grid.
    """

    picture: NDArray[np.float64]
    samples: int
    wall: float
    cpu: float


class Peer:
    """Mitsuba's process, seen from Blender's. A context; PeerError if Mitsuba does not start."""

    def __enter__(self) -> Self:
        from ...addon.blender import images
        from ...headless.scene import environments

        world = images.load(environments()["studio"])
        *quicker, plain = VARIANTS
        for variant in quicker:
            with contextlib.suppress(PeerError):
                self._begin(variant, world)
                return self
        self._begin(plain, world)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def render(self, scene: str, bsdf: dict[str, Any], samples: int, seed: int, size: int) -> Rendered:
        """One of ``SCENES``, its ball of any BSDF that Mitsuba has, in ``size`` x ``size`` pixels.

        The time is that of the render alone, on all cores: the scene has been loaded, and a first render has compiled
        what it needs. PeerError if Mitsuba refuses, or its process ends over it.
        """
        self._send((scene, bsdf, samples, seed, size))
        found = self._receive()
        if isinstance(found, str):
            raise PeerError(found)
        return Rendered(*found)

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.communicate()
        self._said.close()

    def _begin(self, variant: str, world: NDArray[np.float32]) -> None:
        """PeerError if the variant renders nothing here."""
        self.variant = variant
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", __name__, variant],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
        )
        try:
            self._send(world)
            self.version: str = self._receive()
            self.render("softbox", TRIAL, 1, 0, 8)
        except BaseException:
            self.close()
            raise

    def _send(self, what: Any) -> None:
        try:
            pickle.dump(what, self._process.stdin)  # type: ignore[arg-type]
            self._process.stdin.flush()  # type: ignore[union-attr]
        except OSError as error:
            raise self._lost() from error

    def _receive(self) -> Any:
        try:
            return pickle.load(self._process.stdout)  # type: ignore[arg-type] # noqa: S301 - from our own process
        except (EOFError, pickle.UnpicklingError) as error:
            raise self._lost() from error

    def _lost(self) -> PeerError:
        code = self._process.wait()
        self._said.seek(0)
        words = " ".join(self._said.read().decode(errors="replace").split())[-LAST_WORDS:]
        name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return PeerError(f"Mitsuba's process ({self.variant}) ended ({name}): {words}")


# What Mitsuba is given


def nearest(preset: Preset) -> dict[str, Any]:
    """The BSDF of Mitsuba that is nearest to a preset. ValueError if none is near; ``DIFFERS`` says by how much."""
    of: dict[str, Any] = preset.parameters
    kind, rough = ("rough", {"distribution": "beckmann", "alpha": preset.m}) if preset.m else ("", {})
    if preset.model == "oren_nayar":
        return {"type": "diffuse", "reflectance": rgb(of["albedo"])}
    if preset.model == "glass" and preset.kind == "interface":
        return {"type": f"{kind}dielectric", "int_ior": of["eta"], "ext_ior": 1.0} | rough
    if preset.model == "sum" and preset.kind == "dielectric":
        lobes = {
            "diffuse_reflectance": rgb(of["d"] * np.array(of["albedo"])),
            "specular_reflectance": rgb([of["s"]] * 3),
        }
        return {"type": f"{kind}plastic", "int_ior": of["eta"], "ext_ior": 1.0} | lobes | rough
    if preset.model == "cook_torrance" and preset.kind in {"schlick", "conductor"}:
        n, k = (of["n"], of["k"]) if preset.kind == "conductor" else conductor_like(of["f0"])
        return {"type": f"{kind}conductor", "eta": rgb(n), "k": rgb(k)} | rough
    message = f"Mitsuba has nothing like {preset.id} ({preset.model}, {preset.kind})"
    raise ValueError(message)


def rgb(values: Any) -> dict[str, Any]:
    return {"type": "rgb", "value": [float(v) for v in values]}


@cache
def conductor_like(f0: tuple[float, ...]) -> tuple[list[float], list[float]]:
    """n and k, for each channel, of the conductor that reflects ``f0`` head-on and is nearest to Schlick elsewhere.

    f0 = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2) leaves n free between (1 - r) / (1 + r), r = sqrt(f0), and its inverse;
    it is the one whose F, over all angles, comes at most the least distance away from Schlick's. f0 in (0, 1).
    """
    cos = np.linspace(0.0, 1.0, 1001)
    indices, extinctions = [], []
    for f in f0:

        def k(n: float, f: float = f) -> float:
            return float(np.sqrt(max(f * (n + 1.0) ** 2 - (n - 1.0) ** 2, 0.0) / (1.0 - f)))

        def distance(n: float, f: float = f) -> float:
            return float(np.max(np.abs(fresnel_conductor(cos, n, k(n)) - schlick(cos, f))))

        least = (1.0 - f**0.5) / (1.0 + f**0.5)
        n = float(minimize_scalar(distance, bounds=(least, 1.0 / least), options={"xatol": 1e-8}).x)
        indices.append(n)
        extinctions.append(k(n))
    return indices, extinctions


# In the process itself

BOUNCES = 12  # of Blender's defaults
BRIGHTEST = 3.0
PROBES = 8  # each way, of a cell of the environment map
FAR = 1e4  # metres to the disc of the sun: a metre beside the ball's middle it has moved by 0.006 of its 0.53 degrees
SUN_ANGLE = radians(0.53)


def stage(mi: Any, name: str, bsdf: dict[str, Any], world: Any, size: int) -> dict[str, Any]:
    """A scene of scenes.py, as Mitsuba's dictionary, under ``world`` if ``MAPPED``. ValueError if there is none."""
    if name not in SCENES:
        message = f"no scene {name!r}; there are {', '.join(SCENES)}"
        raise ValueError(message)
    ball = {"type": "sphere", "center": [0.0, 0.0, 1.0], "bsdf": bsdf}
    found = {"type": "scene", "ball": ball, "integrator": {"type": "path", "max_depth": BOUNCES + 1}}
    eye = placed(mi, (0.0, -5.6, 2.6), 74.0) if name == "checker" else placed(mi, (0.0, -6.0, 1.0), 90.0)
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb", "component_format": "float32"}
    found["sensor"] = {
        "type": "perspective",
        "fov": degrees(2.0 * atan(36.0 / 2.0 / 90.0)),
        "to_world": eye @ turned(mi),  # Blender's camera looks along -z, with x to the right
        "film": film | {"rfilter": {"type": "box"}},
        "sampler": {"type": "multijitter"},
    }
    if name in MAPPED:
        # Mitsuba's map has y up, and its middle column along z
        axes = mi.ScalarTransform4f([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
        found["world"] = {"type": "envmap", "bitmap": world, "to_world": axes}
    if name == "softbox":
        found["lamp"] = lamp(
            "rectangle", placed(mi, (1.3, -1.6, 2.6), 45.0, 39.0) @ turned(mi) @ scaled(mi, 0.5), 60.0 / pi
        )
    if name == "sun":
        found["world"] = {"type": "constant", "radiance": rgb([0.05] * 3)}
    if name in {"sun", "outdoors"}:
        half = SUN_ANGLE / 2.0
        above = placed(mi, (0.0, 0.0, 1.0), 45.0, 39.0) @ mi.ScalarTransform4f().translate([0.0, 0.0, FAR])
        disc = above @ turned(mi) @ scaled(mi, FAR * tan(half))
        found["lamp"] = lamp("disk", disc, 2.0 / (pi * np.sin(half) ** 2))
    if name == "checker":
        squares = {"type": "checkerboard", "color0": rgb([0.05] * 3), "color1": rgb([0.7] * 3)}
        squares["to_uv"] = mi.ScalarTransform4f().scale([80.0, 80.0, 1.0])  # a pair of them each metre
        floor = {"type": "rectangle", "to_world": scaled(mi, 40.0), "bsdf": {"type": "diffuse", "reflectance": squares}}
        found["floor"] = floor
    return found


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
            total += np.minimum(_between(rows, x + across).transpose(1, 0, 2), BRIGHTEST)
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
            world = self.world if name in MAPPED else None
            self.shown = self.mi.load_dict(stage(self.mi, name, bsdf, world, size))
            self.loaded, self.warm = (name, bsdf, size), set()
        first = samples if self.compiles else 1
        if first not in self.warm:
            self._picture(first, seed)
            self.warm.add(first)
        wall, cpu = time.perf_counter(), time.process_time()
        picture = self._picture(samples, seed)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        return picture, self.shown.sensors()[0].sampler().sample_count(), wall, cpu

    @cached_property
    def world(self) -> Any:
        return self.mi.Bitmap(resampled(self.pixels))

    def _picture(self, samples: int, seed: int) -> NDArray[np.float64]:
        return np.array(self.mi.render(self.shown, spp=samples, seed=seed), np.float64)  # an array has been computed


def main() -> None:
    """Render what comes on standard input until that ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to all; who began this process ends it
    answers = os.fdopen(os.dup(1), "wb")
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)  # where Mitsuba prints
    renderer = Renderer(sys.argv[1], pickle.load(sys.stdin.buffer))  # noqa: S301 - from our own process
    _answer(answers, renderer.mi.__version__)
    with contextlib.suppress(EOFError):
        while True:
            request = pickle.load(sys.stdin.buffer)  # noqa: S301 - from our own process
            try:
                found: Any = renderer.render(*request)
            except (RuntimeError, ValueError) as error:
                found = " ".join(str(error).split())
            _answer(answers, found)


def _answer(answers: IO[bytes], what: Any) -> None:
    pickle.dump(what, answers)
    answers.flush()


if __name__ == "__main__":
    main()
