# SPDX-License-Identifier: GPL-3.0-or-later
"""Automatic, which artists know as Standard: one of Cycles' own closures, whatever the scene holds.

It binds no light, draws no random facet and needs no driver, so no later change to the scene makes it wrong.
Of ``closure`` and ``fit`` it picks the one with the smaller expected error at equal render time:

    error^2 = bias^2 + noise^2,    noise = a N^-p after N samples

Fit's bias is smaller and its samples take longer, so it is picked where noise no longer hides the difference.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..blender import facts
from ..models.estimators import NATIVE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import Scene

    from ..blender.facts import SceneFacts
    from ..library.presets import Preset

TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
# By model: ``bias`` as a share of the image, by kind of light and estimator, at the values ``at`` of its ``parameter``.
BIASES: dict[str, Any] = TABLES["models"]
# The kinds of light under which each model was measured. Elsewhere the tables above, measured with other materials,
# give an estimate, and no comparison is shown.
MEASURED: dict[str, list[str]] = TABLES["measured"]
# Under an even world a dielectric's bias and noise are this many times as large: its reflectance rises toward grazing
# angles, where closure is wrong and fit keeps the albedo.
DIELECTRIC, DIELECTRIC_NOISE = {"closure": 2.0, "fit": 0.25}, 1.8
SKY_SHARE = 0.2  # a sky's share of the light beside lights
FIT_TIME = 1.2  # time of a sample by fit over one by closure: measured are 1.14 to 1.34 (tests/lab/test_fit_speed.py)
UNDER = {
    "even": "under an even sky",
    "picture": "under an environment map",
    "lights": "under lights",
    "picture and lights": "under an environment map and lights",
}


@dataclass(frozen=True)
class Pick:
    """An estimator, and in a few words why it is the one for a scene."""

    estimator: str
    why: str


def pick(scene: Scene | SceneFacts | None, preset: Preset) -> Pick:
    """``auto`` for this preset in this scene; None if the scene is not known yet, as in an asset library.

    Smooth glass takes ``mirror``, which is exact there and draws nothing at random.
    """
    if preset.is_smooth:
        return Pick(preset.spec.smooth_estimator, "Mirror is exact on a smooth surface and draws no random facets")
    natives = [name for name in NATIVE if name in preset.spec.estimators]
    if len(natives) == 1:
        return Pick(natives[0], "Cycles' own closure; this model has no Fit")
    known = None if scene is None else facts.of(scene)
    unmeasured = _not_measured(known, preset)
    if known is None or unmeasured:
        return Pick(natives[0], f"the estimator closest to the formula; {unmeasured}")
    chosen, why = _smallest_error(known, preset)
    if (kind := kind_of_light(known)) not in MEASURED[preset.model]:
        why = f"estimated from other materials; the model {preset.model} was not measured {UNDER[kind]}"
    if preset.m > 1.0:
        why = slope_limit(preset.m)
    return Pick(chosen, why)


def slope_limit(m: float) -> str:
    """What to know of a slope m above 1."""
    return f"Cycles' closures are limited to m = 1; this material has m = {m:g}. Use Reference for larger m"


def pick_estimator(scene: Scene | SceneFacts | None, preset: Preset) -> str:
    """The estimator of ``pick``."""
    return pick(scene, preset).estimator


def _not_measured(known: SceneFacts | None, preset: Preset) -> str:
    """What was not measured, as a sentence; "" if the tables hold."""
    if preset.model not in MEASURED:
        return f"the model {preset.model} was not measured"
    if known is None:
        return "the scene is not known"
    if known.lights or known.sky.kind:
        return ""
    lit_by = "lit by emissive objects alone" if known.emitters else "without light"
    return f"scenes {lit_by} were not measured"


def kind_of_light(known: SceneFacts) -> str:
    """One of ``UNDER``. Beside lights an even world counts as dim."""
    lit = bool(known.lights or known.emitters or known.sky.sun_disc)
    if known.sky.kind == "picture":
        return "picture and lights" if lit else "picture"
    return "lights" if lit else "even"


def _smallest_error(known: SceneFacts, preset: Preset) -> tuple[str, str]:
    """The estimator with the smaller expected error, and why. A denoiser removes the noise: then bias alone decides."""
    samples, denoised = known.scene.cycles.samples, known.scene.cycles.use_denoising
    parts = list(preset.parts().values()) or [preset]
    closure, fit = (_bias(known, parts, name) for name in ("closure", "fit"))
    if not denoised:
        closure = float(np.hypot(closure, _noise(known, parts, samples * FIT_TIME)))
        fit = float(np.hypot(fit, _noise(known, parts, samples)))
    if closure <= fit:
        why = "its bias is small here" if denoised else f"its bias is below the noise of {samples} samples"
        return "closure", f"Cycles' nearest closure: {why}, and it is the fastest"
    shows = "a denoiser removes the noise" if denoised else f"{samples} samples are enough to show it"
    return "fit", f"Fit is closer to the formula than one closure, and {shows}"


def _bias(known: SceneFacts, parts: Sequence[Preset], estimator: str) -> float:
    """Expected bias, as a share of the image: the largest of a preset's parts."""
    kind = kind_of_light(known)
    off = max(_bias_of(part, kind.removesuffix(" and lights"), estimator) for part in parts)
    if kind == "picture and lights":
        at_lights = max(_bias_of(part, "lights", estimator) for part in parts)
        return float(np.hypot(SKY_SHARE * off, at_lights))
    return off


def _bias_of(part: Preset, kind: str, estimator: str) -> float:
    """Interpolated linearly in both logarithms between the measured values; constant beyond them."""
    table = BIASES[part.model]
    roughness, off = float(part.parameters[table["parameter"]]), 0.0  # type: ignore[arg-type]
    if roughness:
        off = float(np.exp(np.interp(np.log(roughness), np.log(table["at"]), np.log(table["bias"][kind][estimator]))))
    return off * DIELECTRIC[estimator] if kind == "even" and _is_dielectric(part) else off


def _noise(known: SceneFacts, parts: Sequence[Preset], samples: float) -> float:
    """Expected noise after so many samples, as a share of the image; narrow lobes make a broad light noisier."""
    m = max((part.m for part in parts), default=0.0)
    narrow = 0.3 / max(m, 0.05) if m else 0.25
    lit = bool(known.lights or known.emitters or known.sky.sun_disc)
    if known.sky.kind == "picture":
        return float(0.5 * samples**-0.6 if lit else 1.1 * samples**-0.66)
    if known.is_soft:
        return float(0.2 * narrow * samples**-0.55)
    if known.sky.kind == "even":
        louder = DIELECTRIC_NOISE if not lit and any(map(_is_dielectric, parts)) else 1.0
        return float(louder * (0.13 * narrow if lit else 0.3 if m else 0.2) * samples**-0.95)
    return 0.0


def _is_dielectric(part: Preset) -> bool:
    return part.spec.has_fresnel and part.kind == "dielectric"
