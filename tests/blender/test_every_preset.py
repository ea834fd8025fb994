# SPDX-License-Identifier: GPL-3.0-or-later
"""Every preset that ships, built in both backends and rendered: a ball each, a family an image."""

from functools import partial

import numpy as np
import pytest

from vgroove.addon.blender import material
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.choose import automatic
from vgroove.addon.library.presets import all_presets

pytestmark = pytest.mark.blender

FAMILIES = sorted({preset.family for preset in all_presets().values()})


def by_auto(members, backend, stage):
    return [build(p, Choice(backend, automatic.pick_estimator(stage, p))) for p in members]


def family(name):
    return [preset for preset in all_presets().values() if preset.family == name]


@pytest.mark.parametrize("name", FAMILIES)
def test_every_preset_builds_and_sends_back_no_more_than_arrives(balls, name):
    """In a white furnace a ball is finite, nowhere negative, not black, at most 1 within its noise, and the same in
    both backends."""
    members = family(name)
    images = [balls(partial(by_auto, members, backend), osl=backend == "osl") for backend in material.BACKENDS]
    for preset, *shown in zip(members, *images, strict=True):
        means = [ball.mean(axis=0) for ball in shown]
        # Of the mean of pixels; their views differ too, so it is no less than the noise.
        noises = [ball.std(axis=0, ddof=1) / np.sqrt(len(ball)) for ball in shown]
        for ball, mean, noise in zip(shown, means, noises, strict=True):
            assert np.isfinite(ball).all(), preset.id
            assert ball.min() >= 0.0, preset.id
            assert np.all(mean <= 1.0 + 4.0 * noise + 1e-4), (preset.id, mean, noise)  # 1e-4: float32 sums
            assert mean.max() > 0.005, (preset.id, mean)
        assert np.all(np.abs(means[0] - means[1]) <= 5.0 * np.hypot(*noises) + 1e-4), (preset.id, means, noises)
