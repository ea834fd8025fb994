# SPDX-License-Identifier: GPL-3.0-or-later
"""Automatic: the estimator of which the least error is to be expected, by what reports have found (docs/report.md).

    error^2 = bias^2 + noise^2,    noise = a N^-p after N samples

Bias is a share of the picture and depends on the light and on how rough a surface is; noise depends on the light. An
estimator whose sample takes longer is held against what others do in that time. So a bias is paid for where it shows,
and no sooner: with few samples, or where facets hardly shadow each other, Closure errs least.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..nodegroups import lamp
from . import advice, lamps
from .material import BUILDERS

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Scene, World

    from .presets import Preset

# What docs/report.md has of copper, plaster and plastic, in rounded numbers; m = 1, sigmas but 0.35, and an even light
# at slopes but 0.3 are not measured there, and estimated. Lights: a world that is the same everywhere, one with a
# picture, and lamps.
SLOPES, SIGMAS = (0.1, 0.3, 0.6, 1.0), (0.1, 0.35, 0.6, 1.0)
FACETS: dict[str, dict[str, tuple[float, ...]]] = {  # bias of Cook-Torrance at SLOPES
    "even": {"closure": (0.019, 0.024, 0.07, 0.12), "fit": (0.0024, 0.0041, 0.01, 0.015)},
    "picture": {"closure": (0.0003, 0.0085, 0.028, 0.06), "fit": (0.0003, 0.0055, 0.014, 0.015)},
    "lamps": {"closure": (0.0001, 0.0015, 0.043, 0.13), "fit": (0.0002, 0.0021, 0.029, 0.029)},
}
# In an even light that of dielectrics is this many times as large, and so is noise: F rises toward grazing angles,
# where closure is off and fit holds the albedo. Of mirror noise and time are both as many times copper's.
DIELECTRIC, DIELECTRIC_NOISE, DIELECTRIC_MIRROR = {"closure": 2.0, "fit": 0.25}, 1.8, 1.3
DIFFUSE: dict[str, dict[str, tuple[float, ...]]] = {  # of Oren-Nayar at SIGMAS
    "even": {"closure": (0.003, 0.028, 0.1, 0.2), "fit": (0.0001, 0.0004, 0.001, 0.002)},
    "picture": {"closure": (0.006, 0.05, 0.12, 0.22), "fit": (0.001, 0.0047, 0.008, 0.01)},
    "lamps": {"closure": (0.004, 0.022, 0.1, 0.2), "fit": (0.001, 0.005, 0.008, 0.01)},
}
# Random facets are chosen in an even light alone, elsewhere they are far too noisy: bias, and noise of one sample.
RANDOM_BIAS, RANDOM_NOISE = {"hybrid": 0.0018, "mirror": 0.0}, {"hybrid": 0.064, "mirror": 0.175}
# What all but mirror are off by in Blender 4.5, where Cycles' own lobes have a dielectric's Fresnel term only nearly.
NEARLY, NEARLY_OF = {"even": 0.027, "picture": 0.02, "lamps": 0.015}, 0.035
SKY_SHARE = 0.2  # of a sky beside lamps
GLASS_NOISE = {"closure": 2.9, "mirror": 4.6}  # of one sample, and of mirror's in the time of closure's
# Time of a sample over that of closure.
TIMES: dict[str, dict[str, float]] = {
    "even": {"fit": 2.0, "hybrid": 4.7, "mirror": 1.4},
    "picture": {"fit": 1.4, "corrected": 2.0},
    "lamps": {"fit": 1.6, "corrected": 3.2},
}
OLD_HYBRID = 7.3  # in an even light, in Blender 4.5
OSL_TIMES = {"fit": 1.35, "corrected": 1.6, "hybrid": 2.0, "mirror": 0.8}
DIFFUSE_TIMES = 0.75  # of Oren-Nayar, over those


@dataclass(frozen=True)
class Pick:
    """An estimator, and in a few words why it is the one for a scene."""

    estimator: str
    why: str


@dataclass(frozen=True)
class Light:
    """What lights a scene.

    world: "", "even" or "picture"; soft: whether a lamp is broad; bound: whether one can be; clear: whether nothing in
    the scene keeps random facets from all of its light.
    """

    world: str
    lamps: bool
    soft: bool
    bound: bool
    clear: bool = False

    @property
    def kind(self) -> str:
        """What decides bias and time. Beside lamps an even sky is taken to be dim."""
        return "picture" if self.world == "picture" else "lamps" if self.lamps else self.world

    def noise(self, m: float, samples: float) -> float:
        """Of an estimator without random facets; m: 0 for a diffuse surface. Narrow lobes make a lamp noisier."""
        narrow = 0.3 / max(m, 0.05) if m else 0.25
        if self.world == "picture":
            return float(0.5 * samples**-0.6 if self.lamps else 1.1 * samples**-0.66)
        if self.soft:
            return float(0.2 * narrow * samples**-0.55)
        if self.world == "even":
            return float((0.13 * narrow if self.lamps else 0.3 if m else 0.2) * samples**-0.95)
        return 0.0


def pick(scene: Scene, preset: Preset, backend: str = "nodes") -> Pick:
    """``auto``: what errs least, bias and noise together, in the time of the scene's samples.

    Where a denoiser takes the noise, bias alone decides. Glass has no ``fit``: there ``mirror`` is picked where rays
    readily hit every light.
    """
    m, model = preset.m, preset.model
    if model == "glass":
        return _pick_glass(scene, m)
    if m > 1.0 and not advice.unseen(scene, model):
        return Pick("mirror", "beyond m = 1 Cycles' closures end, and rays readily hit every light")
    if m > 1.0:
        return Pick("corrected", "beyond m = 1 only the formula at lamps is right; the rest is shown as m = 1")
    light = light_of(scene, backend)
    if scene.cycles.use_denoising and light.bound:
        return Pick("corrected", "lamps are exact by the formula, and the denoiser takes the noise of the rest")
    if scene.cycles.use_denoising:
        return Pick("fit", "it is nearest without random facets, whose noise would leave the denoiser little")
    return _least(preset, light, scene.cycles.samples, backend)


def pick_estimator(scene: Scene, preset: Preset, backend: str = "nodes") -> str:
    """The estimator of ``pick``."""
    return pick(scene, preset, backend).estimator


def anywhere(preset: Preset) -> str:
    """For a scene that is not known: what is nearest, without random facets where that can be had."""
    return "mirror" if preset.model == "glass" or preset.m > 1.0 else "fit"


def light_of(scene: Scene, backend: str = "nodes") -> Light:
    """By its lamps and its world. Without a Raycast node what corrects a lamp would shine into its shadows."""
    found = lamps.of_scene(scene)
    shadowless = backend == "nodes" and not lamp.can_cast_shadows()
    bound = not shadowless and any(lamps.refusal(item) is None for item in found)
    world = _world(scene.world)
    clear = world == "even" and not found and not advice.problems(scene, backend, "mirror")  # of use nowhere else
    return Light(world, bool(found), any(not advice.is_small(item) for item in found), bound, clear)


def _world(world: World | None) -> str:
    if world is None:
        return ""
    tree = world.node_tree
    if tree is None or (bpy.app.version < (5, 0, 0) and not world.use_nodes):  # goes with 4.5 LTS
        return "even" if any(world.color) else ""
    shining = [node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground"]
    if any(socket.is_linked for node in shining for socket in node.inputs if socket.name in {"Color", "Strength"}):
        return "picture"
    lit = [node.inputs["Strength"].default_value * max(node.inputs["Color"].default_value[:3]) for node in shining]
    return "even" if any(level > 0.0 for level in lit) else ""


def _least(preset: Preset, light: Light, samples: int, backend: str) -> Pick:
    """Who comes nearest to the least error that could be had in the time of the scene's samples by it."""
    errors, times = _expected(preset, light, backend)

    def regret(name: str) -> float:
        seconds = samples * times[name]
        return errors[name](samples) / max(min(errors[one](seconds / times[one]) for one in errors), 1e-12)

    chosen = min(errors, key=regret)
    return Pick(chosen, _why(chosen, samples, errors[chosen](samples)))


def _why(estimator: str, samples: int, error: float) -> str:
    of = f"at {samples} samples, about {100.0 * error:.2g} % of the picture"
    return {
        "closure": f"its bias is less than noise, and no sample is quicker: the least error {of}",
        "fit": f"it sees every light without random facets: the least error {of}",
        "corrected": f"lamps are exact by the formula, and the rest has no added noise: the least error {of}",
        "hybrid": f"in so even a light its noise is small, and its bias bounded: the least error {of}",
        "mirror": f"in so even a light its noise is small, and it has no bias: the least error {of}",
    }[estimator]


def _expected(
    preset: Preset, light: Light, backend: str
) -> tuple[dict[str, Callable[[float], float]], dict[str, float]]:
    """Of each estimator that may be chosen: the error by samples, and the time of a sample over closure's."""
    parts = list(preset.parts().values()) or [preset]
    facets = [part for part in parts if part.model == "cook_torrance"]
    m = max((part.m for part in facets), default=0.0)
    kind = light.kind or "lamps"
    bias = {name: max(_bias(part, kind, name) for part in parts) for name in ("closure", "fit")}
    of_sky = {name: SKY_SHARE * off if kind == "picture" else 0.0 for name, off in bias.items()}
    if kind == "picture" and light.lamps:
        at_lamps = {name: max(_bias(part, "lamps", name) for part in parts) for name in bias}
        bias = {name: float(np.hypot(of_sky[name], at_lamps[name])) for name in bias}
    if light.bound and "corrected" in BUILDERS[preset.model]:
        bias["corrected"] = of_sky["fit"]
    if light.clear and facets:
        bias |= {name: off for name, off in RANDOM_BIAS.items() if name in BUILDERS[preset.model]}
    nearly = max((advice.native_fresnel_error(part.kind, backend) for part in facets), default=0.0) / NEARLY_OF
    bias = {
        name: off if name == "mirror" else float(np.hypot(off, nearly * NEARLY[kind])) for name, off in bias.items()
    }
    of = OSL_TIMES if backend == "osl" else TIMES[kind]
    if backend == "nodes" and kind == "even" and bpy.app.version < (5, 0, 0):
        of = of | {"hybrid": OLD_HYBRID}
    times = {name: 1.0 + (of[name] - 1.0) * (1.0 if facets else DIFFUSE_TIMES) if name != "closure" else 1.0
             for name in bias}  # fmt: skip

    dielectric = light.kind == "even" and any(map(_is_dielectric, facets))
    if dielectric and "mirror" in times:
        times["mirror"] *= DIELECTRIC_MIRROR

    def error(name: str, samples: float) -> float:
        louder = 1.0 if not dielectric else DIELECTRIC_MIRROR if name == "mirror" else DIELECTRIC_NOISE
        noise = 0.0 if name == "mirror" else louder * light.noise(m, samples)
        return float(np.linalg.norm([bias[name], noise, louder * RANDOM_NOISE.get(name, 0.0) * samples**-0.5]))

    return {name: partial(error, name) for name in bias}, times


def _bias(part: Preset, kind: str, estimator: str) -> float:
    """Between slopes, and between sigmas, straight in both logarithms."""
    if part.model == "oren_nayar":
        at, slopes, table = float(part.parameters["sigma"]), SIGMAS, DIFFUSE  # type: ignore[arg-type]
    else:
        at, slopes, table = part.m, SLOPES, FACETS
    off = _off(at, slopes, table[kind][estimator])
    return off * DIELECTRIC[estimator] if kind == "even" and _is_dielectric(part) else off


def _off(at: float, slopes: tuple[float, ...], bias: tuple[float, ...]) -> float:
    return float(np.exp(np.interp(np.log(at), np.log(slopes), np.log(bias)))) if at else 0.0


def _is_dielectric(part: Preset) -> bool:
    return part.model == "cook_torrance" and part.kind == "dielectric"


def _pick_glass(scene: Scene, m: float) -> Pick:
    if m == 0.0:
        return Pick("mirror", "a smooth interface is exact and draws no random facets")
    if advice.unseen(scene, "glass"):
        return Pick("closure", "random facets would seldom or never hit these lights")
    samples = scene.cycles.samples
    noisier = float(np.hypot(_off(m, SLOPES, FACETS["picture"]["closure"]), GLASS_NOISE["closure"] * samples**-0.5))
    if not scene.cycles.use_denoising and noisier < GLASS_NOISE["mirror"] * samples**-0.5:
        return Pick("closure", f"at {samples} samples its bias is less than the noise that random facets would add")
    return Pick("mirror", "rays readily hit every light, and it is exact")
