# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with a scene for an estimator is said, and its button mends it."""

import pytest

from vgroove.addon import headless, scene

pytestmark = pytest.mark.blender


@pytest.fixture
def stage(blender):
    """A Cycles scene that suits every estimator, with one sun that has a size."""
    stage = blender.context.scene
    stage.render.engine = "CYCLES"
    scene.exact(stage)
    stage.world = blender.data.worlds.new("World")
    sun = blender.data.lights.new("Sun", "SUN")
    sun.angle = 0.1
    stage.collection.objects.link(blender.data.objects.new("Sun", sun))
    return stage


def spoil_osl(stage):
    stage.cycles.shading_system = False


def spoil_size(stage):
    import bpy

    area = bpy.data.lights.new("Area", "AREA")
    area.size, area.spread = 0.0, 0.0  # so narrow a lamp the formula cannot follow either
    stage.collection.objects.link(bpy.data.objects.new("Area", area))


def spoil_mis(stage):
    stage.objects["Sun"].data.cycles.use_multiple_importance_sampling = False


def spoil_world(stage):
    stage.world.cycles.sampling_method = "NONE"


def spoil_filter(stage):
    stage.cycles.blur_glossy = 1.0


def spoil_clamp(stage):
    stage.cycles.sample_clamp_indirect = 10.0


def spoil_caustics(stage):
    stage.cycles.caustics_reflective = False


def spoil_small(stage):
    stage.objects["Sun"].data.angle = 0.01


def spoil_adaptive(stage):
    stage.cycles.use_adaptive_sampling = True


SPOILERS = {
    "small": spoil_small,
    "adaptive": spoil_adaptive,
    "engine": lambda stage: setattr(stage.render, "engine", "BLENDER_WORKBENCH"),
    "osl": spoil_osl,
    "size": spoil_size,
    "mis": spoil_mis,
    "world": spoil_world,
    "filter": spoil_filter,
    "clamp": spoil_clamp,
    "caustics": spoil_caustics,
}


@pytest.mark.parametrize("key", SPOILERS)
def test_each_problem_is_found_and_its_button_mends_it(stage, key):
    """Nothing is wrong before; after spoiling one thing it alone is named; the button takes it away."""
    stage.cycles.shading_system = True
    assert scene.problems(stage, "osl", "mirror") == []
    SPOILERS[key](stage)
    (problem,) = scene.problems(stage, "osl", "mirror")
    assert problem.key == key
    assert "\n" not in problem.text
    assert problem.button
    problem.mend()
    assert scene.problems(stage, "osl", "mirror") == []


@pytest.mark.parametrize("device", ["HIP", "CUDA", "METAL"])
def test_osl_on_a_gpu_that_cannot_run_it_is_said_and_mended(stage, monkeypatch, device):
    """OptiX can; so can the CPU, to which the button goes. (The device is named here, as there is none.)"""
    monkeypatch.setattr(scene, "_compute_device", lambda: device)
    stage.cycles.shading_system, stage.cycles.device = True, "GPU"
    assert scene.problems(stage, "nodes", "mirror") == []
    (problem,) = scene.problems(stage, "osl", "mirror")
    assert problem.key == "device"
    assert device in problem.text
    problem.mend()
    assert scene.problems(stage, "osl", "mirror") == []
    stage.cycles.device = "GPU"
    monkeypatch.setattr(scene, "_compute_device", lambda: "OPTIX")
    assert scene.problems(stage, "osl", "mirror") == []


def test_closure_beyond_its_slope_and_direct_without_lamps_are_said(stage):
    for native in ("fit", "closure"):
        assert [p.key for p in scene.problems(stage, "nodes", native, m=2.0)] == ["slope"]
    stage.objects["Sun"].hide_render = True
    assert "lamps" in [p.key for p in scene.problems(stage, "nodes", "direct")]


def test_the_preview_scene_suits_mirror_and_has_no_surprises(blender):
    """What we render presets on has no problem of its own."""
    with headless.quiet():
        shown = scene.preview()
    for backend in ("nodes", "osl"):
        shown.cycles.shading_system = backend == "osl"
        assert scene.problems(shown, backend, "mirror") == []
    assert len(scene.environments()) >= 5


def test_a_still_without_camera_or_with_an_odd_ending_is_refused(stage, tmp_path):
    with pytest.raises(scene.SceneError, match="has no camera"):
        scene.still(stage, tmp_path / "a.png")
    with pytest.raises(scene.SceneError, match="unknown ending"):
        scene.still(stage, tmp_path / "a.tga")
    assert list(tmp_path.iterdir()) == []
