# SPDX-License-Identifier: GPL-3.0-or-later
"""Every preset that ships, built in both backends and rendered: a ball each, a family an image."""

import bmesh
import numpy as np
import pytest

from vgroove.addon import gonio, headless, material, scene
from vgroove.addon.material import Choice, build
from vgroove.addon.presets import all_presets

pytestmark = pytest.mark.blender

FAMILIES = sorted({preset.family for preset in all_presets().values()})
PIXELS, SAMPLES, SPACING = 16, 16, 2.5
ACROSS = (np.arange(PIXELS) + 0.5) * SPACING / PIXELS - SPACING / 2.0
BALL = np.hypot(*np.meshgrid(ACROSS, ACROSS)) < 0.95  # pixels of a tile that lie within the ball of radius 1


def family(name):
    return [preset for preset in all_presets().values() if preset.family == name]


def balls_in_even_light(blender, members, backend):
    """Images (balls, pixels, 3) under a white sky, each preset by what auto picks for it."""
    side = int(np.ceil(np.sqrt(len(members))))
    mesh = blender.data.meshes.new("Ball")
    shape = bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=32, v_segments=16, radius=1.0)
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    mesh.materials.append(None)
    with (
        headless.quiet(),
        gonio.stage((PIXELS * side,) * 2, samples=SAMPLES, seed=0, shading_osl=backend == "osl") as stage,
    ):
        gonio.light(stage, gonio.Geometry(furnace=True))
        for index, preset in enumerate(members):
            estimator = scene.pick_estimator(stage, preset.m, preset.model, backend)
            item = blender.data.objects.new(preset.id, mesh)
            item.material_slots[0].link = "OBJECT"
            item.material_slots[0].material = build(preset, Choice(backend, estimator))
            item.location = (SPACING * (index % side), -SPACING * (index // side), 0.0)
            stage.collection.objects.link(item)
        camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
        camera.data.type, camera.data.ortho_scale = "ORTHO", SPACING * side
        camera.location = (SPACING * (side - 1) / 2.0, -SPACING * (side - 1) / 2.0, 9.0)
        stage.collection.objects.link(camera)
        stage.camera = camera
        image = gonio.rendered(stage)
    tiles = image.reshape(side, PIXELS, side, PIXELS, 3).transpose(0, 2, 1, 3, 4)
    return tiles.reshape(side * side, PIXELS, PIXELS, 3)[: len(members), BALL]


@pytest.mark.parametrize("name", FAMILIES)
def test_every_preset_builds_and_sends_back_no_more_than_arrives(blender, name):
    """In a white furnace a ball is finite, nowhere negative, not black, at most 1 within its noise, and the same in
    both backends."""
    members = family(name)
    both = [balls_in_even_light(blender, members, backend) for backend in material.BACKENDS]
    for preset, *balls in zip(members, *both, strict=True):
        means = [ball.mean(axis=0) for ball in balls]
        # Of the mean of pixels; their views differ too, so it is no less than the noise.
        noises = [ball.std(axis=0, ddof=1) / np.sqrt(len(ball)) for ball in balls]
        for ball, mean, noise in zip(balls, means, noises, strict=True):
            assert np.isfinite(ball).all(), preset.id
            assert ball.min() >= 0.0, preset.id
            assert np.all(mean <= 1.0 + 4.0 * noise + 1e-4), (preset.id, mean, noise)  # 1e-4: float32 sums
            assert mean.max() > 0.005, (preset.id, mean)
        assert np.all(np.abs(means[0] - means[1]) <= 5.0 * np.hypot(*noises) + 1e-4), (preset.id, means, noises)
        print(preset.id, means, noises)
