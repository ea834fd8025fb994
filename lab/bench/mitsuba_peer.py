# SPDX-License-Identifier: GPL-3.0-or-later
"""The peer Mitsuba 3, on the scenes that it and Cycles can both express. Imports no bpy until it is ``started``.

Mitsuba runs in a process of its own (``mitsuba_scenes``), which stays warm: its libraries and Blender's must not meet
in one (``headless.pipe``).

The variant that compiles is three to four times as fast as the plain one, but needs an LLVM new enough (15 is not;
DRJIT_LIBLLVM_PATH names another than the system's). It is tried first, in a process that may end over it.
"""

from __future__ import annotations

from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...headless import pipe
from . import mitsuba_scenes, peers

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from ...addon.library.presets import Preset

VARIANTS = ("llvm_ad_rgb", "scalar_rgb")  # the quickest first
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


class PeerError(RuntimeError):
    """Mitsuba cannot render that, or its process ended."""


@dataclass(frozen=True)
class Rendered:
    """A picture in linear RGB, (H, W, 3), and the processor seconds that its render took."""

    picture: NDArray[np.float64]
    cpu: float


@contextmanager
def started() -> Iterator[Peer]:
    """Mitsuba's process, by the quickest variant that works. PeerError if none does."""
    from ...addon.blender import images
    from ...headless.scene import environments

    world = images.load(environments()["studio"])
    peer = None
    for variant in VARIANTS[:-1]:
        with suppress(PeerError):
            peer = peer or Peer(variant, world)
    with closing(peer or Peer(VARIANTS[-1], world)) as begun:
        yield begun


class Peer:
    """Mitsuba's process, seen from Blender's. PeerError if the variant renders nothing here."""

    def __init__(self, variant: str, world: NDArray[np.float32]) -> None:
        self.variant = variant
        self._process = pipe.Process(mitsuba_scenes.__name__, variant, name=f"Mitsuba's process ({variant})")
        try:
            self.version: str = self._ask(world)
            self.render("softbox", TRIAL, 1, 0, 8)
        except BaseException:
            self.close()
            raise

    def render(self, scene: str, bsdf: dict[str, Any], samples: int, seed: int, size: int) -> Rendered:
        """One of ``mitsuba_scenes.SCENES``, its ball of any BSDF that Mitsuba has, in ``size`` x ``size`` pixels.

        The time is that of the render alone, on all cores: the scene has been loaded, and a first render has compiled
        what it needs. PeerError if Mitsuba refuses, or its process ends over it.
        """
        found = self._ask((scene, bsdf, samples, seed, size))
        if isinstance(found, str):
            raise PeerError(found)
        return Rendered(*found)

    def close(self) -> None:
        """End the process."""
        self._process.close()

    def _ask(self, request: Any) -> Any:
        try:
            return self._process.ask(request)
        except pipe.LostError as error:
            raise PeerError(str(error)) from error


def nearest(preset: Preset) -> dict[str, Any]:
    """The BSDF of Mitsuba that is nearest to a preset. ValueError if none is near; ``DIFFERS`` says by how much."""
    found: dict[str, Any] | None = peers.of(preset).mitsuba(preset)
    if found is None:
        message = f"Mitsuba has nothing like {preset.id} ({preset.model}, {preset.kind})"
        raise ValueError(message)
    return found
