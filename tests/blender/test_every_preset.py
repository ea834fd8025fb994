# SPDX-License-Identifier: GPL-3.0-or-later
"""Every preset that ships, built and rendered: a ball each, a family an image."""

from functools import partial

import numpy as np
import pytest

from vgroove.addon.blender import material
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.choose import automatic
from vgroove.addon.library.presets import all_presets
from vgroove.addon.models import MODELS

pytestmark = pytest.mark.blender

FAMILIES = sorted({preset.family for preset in all_presets().values()})


def by_auto(members, backend, stage):
    return [build(p, Choice(backend, automatic.pick_estimator(stage, p))) for p in members]


def family(name):
    return [preset for preset in all_presets().values() if preset.family == name]


def sent_back(balls, members, backend):
    """Mean of each ball in a white furnace, and its noise: of the mean of pixels, whose views differ too.

    Each is finite, nowhere negative, not black, and at most 1 within its noise.
    """
    found = []
    for preset, ball in zip(members, balls(partial(by_auto, members, backend), osl=backend == "osl"), strict=True):
        mean, noise = ball.mean(axis=0), ball.std(axis=0, ddof=1) / np.sqrt(len(ball))
        assert np.isfinite(ball).all(), preset.id
        assert ball.min() >= 0.0, preset.id
        assert np.all(mean <= 1.0 + 4.0 * noise + 1e-4), (preset.id, mean, noise)  # 1e-4: float32 sums
        assert mean.max() > 0.002, (preset.id, mean)  # black obsidian, a fit, has .0034
        found.append((mean, noise))
    return found


@pytest.mark.parametrize("share", ["most", pytest.param("all", marks=pytest.mark.more)])
@pytest.mark.parametrize("name", FAMILIES)
def test_every_preset_builds_and_sends_back_no_more_than_arrives(balls, name, share):
    """Of what has a list of lobes, which Cycles compiles for most of a second, each fourth: by `make test-all` each."""
    members = family(name)
    listed = [preset for preset in members if MODELS[preset.model].lobes]
    left = {preset.id for preset in listed} - {preset.id for preset in listed[::4]} if share == "most" else ()
    sent_back(balls, [preset for preset in members if preset.id not in left], "nodes")


@pytest.mark.parametrize("step", [6, pytest.param(1, marks=pytest.mark.more)])
@pytest.mark.parametrize("name", FAMILIES)
def test_both_backends_send_back_the_same(balls, name, step):
    """Each sixth preset, and by `make test-all` each: OSL compiles one for 0.2 s; within a model numbers differ."""
    members = family(name)[::step]
    backends = [sent_back(balls, members, backend) for backend in material.BACKENDS]
    for preset, (mean, noise), (other, its_noise) in zip(members, *backends, strict=True):
        assert np.all(np.abs(mean - other) <= 5.0 * np.hypot(noise, its_noise) + 1e-4), (preset.id, mean, other)
