# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with a scene for an estimator is said, and its button fixes it."""

import pytest

from vgroove import headless
from vgroove.addon.blender import lamps, material, roles
from vgroove.addon.blender.material import lamps_to_bind
from vgroove.addon.choose import advice
from vgroove.addon.library import presets
from vgroove.headless import scene
from vgroove.nodegroups.lamp import can_cast_shadows

pytestmark = pytest.mark.blender

TEXT = 'name = "Test"\nmodel = "cook_torrance"\nm = 0.3\n[fresnel]\n{}\n[source]\ndata = "test"\n'


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


@pytest.mark.parametrize("estimator", material.RANDOM)
@pytest.mark.parametrize("key", SPOILERS)
def test_each_problem_is_found_and_its_button_fixes_it(stage, key, estimator):
    """Nothing is wrong before; after spoiling one thing it alone is named; the button takes it away.

    Of light that random rays cannot find, ``hybrid`` says that only the share of its ``fit`` is seen.
    """
    stage.cycles.shading_system = True
    assert advice.problems(stage, "osl", estimator) == []
    SPOILERS[key](stage)
    (problem,) = advice.problems(stage, "osl", estimator)
    assert problem.key == key
    assert "\n" not in problem.text
    assert ("except in Fit's share" in problem.text) == (estimator == "hybrid" and key in {"size", "mis", "world"})
    assert problem.button
    problem.fix()
    assert advice.problems(stage, "osl", estimator) == []


@pytest.mark.parametrize("device", ["HIP", "CUDA", "METAL"])
def test_osl_on_a_gpu_that_cannot_run_it_is_said_and_fixed(stage, monkeypatch, device):
    """OptiX can; so can the CPU, to which the button goes. (The device is named here, as there is none.)"""
    monkeypatch.setattr(advice, "_compute_device", lambda: device)
    stage.cycles.shading_system, stage.cycles.device = True, "GPU"
    assert advice.problems(stage, "nodes", "mirror") == []
    (problem,) = advice.problems(stage, "osl", "mirror")
    assert problem.key == "device"
    assert device in problem.text
    problem.fix()
    assert advice.problems(stage, "osl", "mirror") == []
    stage.cycles.device = "GPU"
    monkeypatch.setattr(advice, "_compute_device", lambda: "OPTIX")
    assert advice.problems(stage, "osl", "mirror") == []


def test_closure_beyond_its_slope_and_direct_without_lamps_are_said(stage):
    for native in ("fit", "closure", "corrected"):
        assert "slope" in [p.key for p in advice.problems(stage, "nodes", native, m=2.0)]
    stage.objects["Sun"].hide_render = True
    assert "lamps" in [p.key for p in advice.problems(stage, "nodes", "direct")]


def test_the_preview_scene_suits_mirror_and_has_no_surprises(blender):
    """What we render presets on has no problem of its own; but 4.5's nodes trace no shadow of its sun's."""
    with headless.quiet():
        shown = scene.preview()
    for backend in ("nodes", "osl"):
        shown.cycles.shading_system = backend == "osl"
        found = [problem.key for problem in advice.problems(shown, backend, "mirror")]
        assert found == ([] if backend == "osl" or can_cast_shadows() else ["shadows"])
    assert len(scene.environments()) >= 5


def test_a_still_without_camera_or_with_an_odd_ending_is_refused(stage, tmp_path):
    with pytest.raises(scene.SceneError, match="has no camera"):
        scene.still(stage, tmp_path / "a.png")
    with pytest.raises(scene.SceneError, match="unknown ending"):
        scene.still(stage, tmp_path / "a.tga")
    assert list(tmp_path.iterdir()) == []


def with_ball(stage, made):
    """The preview's ball, of this material."""
    import bpy

    ball = bpy.data.objects.new("Ball", scene.ball_mesh())
    ball.location = (0, 0, 1)
    ball.data.materials.append(made)
    stage.collection.objects.link(ball)
    return ball


def add_lamp(stage, name, kind="POINT", size=0.0):
    import bpy

    light = bpy.data.lights.new(name, kind)
    light.shadow_soft_size = size
    item = bpy.data.objects.new(name, light)
    stage.collection.objects.link(item)
    return item


@pytest.mark.parametrize("estimator", ["mirror", "hybrid", "corrected", "direct"])
def test_a_lamp_added_after_a_material_is_said_and_bound_anew(stage, estimator):
    """What no ray can hit never vanishes silently; the new material keeps the numbers that an artist has turned."""
    preset = presets.find("lecture/copper")
    bind = lamps_to_bind(stage, estimator)
    ball = with_ball(stage, material.build(preset, material.Choice("nodes", estimator, bind, bound=0.01)))
    node = next(n for n in ball.active_material.node_tree.nodes if n.label == preset.name)
    node.inputs["Roughness"].default_value = 0.4**0.5

    def stale():
        return [p for p in advice.problems_with(stage, preset, "nodes", estimator) if p.key.startswith("stale")]

    assert stale() == []
    lamp = add_lamp(stage, "Late")
    (problem,) = stale()
    assert ("rendered as Standard" in problem.text) == (estimator == "corrected")
    assert problem.text.startswith("Light Late is not included in Copper yet")
    problem.fix()
    assert stale() == []
    assert "POINT 1" in material.bound_slots(ball.active_material)
    origin = material.origin_of(ball.active_material)
    assert origin.preset.m == pytest.approx(0.4)
    assert origin.bound == pytest.approx(0.01)  # kept for Hybrid, also while another estimator has no use for it
    lamp.name = "Renamed"
    assert stale() == []


def test_what_is_linked_to_a_material_is_not_lost_by_a_button(stage):
    """A texture on it stays, and so does the material itself."""
    preset = presets.find("lecture/copper")
    made = material.build(preset, material.Choice("nodes", "mirror"))
    with_ball(stage, made)
    node = roles.node(made, roles.MODEL)
    noise = made.node_tree.nodes.new("ShaderNodeTexNoise")
    made.node_tree.links.new(noise.outputs[0], node.inputs["Roughness"])
    add_lamp(stage, "Late")
    (problem,) = (p for p in advice.problems_with(stage, preset, "nodes", "mirror") if p.key.startswith("stale"))
    problem.fix()
    assert node.inputs["Roughness"].links[0].from_node == noise
    assert material.bound_slots(made) == {"POINT 1"}


def test_a_bound_lamp_that_gets_a_size_is_not_counted_twice(stage):
    """Then rays hit it, and what the formula adds for lamps of zero size goes out."""
    lamp = add_lamp(stage, "Point")
    made = material.build(
        presets.find("lecture/copper"), material.Choice("nodes", "mirror", lamps_to_bind(stage, "mirror"))
    )
    with_ball(stage, made)

    def strength():
        stage.view_layers[0].update()
        return stage.view_layers[0].depsgraph.scene_eval[lamps.RIG]["POINT 1 color"][3]

    assert strength() > 0
    lamp.data.shadow_soft_size = 0.1
    assert strength() == 0
    lamp.data.shadow_soft_size = 0.0
    assert strength() > 0


def test_lamps_that_do_not_light_the_render_are_not_bound(stage):
    """One in an excluded collection neither takes a place nor sways the choice."""
    import bpy

    off = bpy.data.collections.new("Off")
    stage.collection.children.link(off)
    lamp = add_lamp(stage, "Point")
    stage.collection.objects.unlink(lamp)
    off.objects.link(lamp)
    assert lamp in lamps.of_scene(stage)
    stage.view_layers[0].layer_collection.children["Off"].exclude = True
    assert lamp not in lamps.of_scene(stage)


def test_advice_on_the_preset_itself(stage):
    """What native lobes only approximate on this Blender, and for what reflectance Hybrid's bound was not computed."""
    steel = presets.parse(TEXT.format("n = 2.5\nk = 3.0"), "a/steel", "a")
    keys = {e: [p.key for p in advice.problems_with(stage, steel, "nodes", e)] for e in ("fit", "mirror", "hybrid")}
    approximate = advice.native_fresnel_error("conductor", "nodes") > 0
    assert ("fresnel" in keys["fit"]) == ("fresnel" in keys["hybrid"]) == approximate
    assert "fresnel" not in keys["mirror"]
    for text, weak in (("eta = 1.2", True), ("eta = 0.7", True), ("f0 = 0.01", True), ("f0 = 0.04", False)):
        preset = presets.parse(TEXT.format(text), "a/b", "a")
        assert ("bound" in [p.key for p in advice.problems_with(stage, preset, "osl", "hybrid")]) == weak
        assert "bound" not in [p.key for p in advice.problems_with(stage, preset, "osl", "corrected")]
    for eta, faint in ((1.0, False), (1.006, True), (1.007, False)):  # F head-on: ((eta - 1) / (eta + 1))^2
        preset = presets.parse(TEXT.format(f"eta = {eta}"), "a/b", "a")
        assert ("faint" in [p.key for p in advice.problems_with(stage, preset, "osl", "mirror")]) == faint
        assert "faint" not in [p.key for p in advice.problems_with(stage, preset, "osl", "direct")]


def test_bound_lamps_that_cast_no_shadow_are_said_for_every_estimator(stage):
    """On 4.5 nodes cannot trace."""
    add_lamp(stage, "Point")
    for estimator in ("mirror", "hybrid", "corrected", "direct"):
        keys = [p.key for p in advice.problems(stage, "nodes", estimator)]
        assert ("shadows" in keys) == (not can_cast_shadows())
        assert "shadows" not in [p.key for p in advice.problems(stage, "osl", estimator)]


def test_glass_with_few_bounces_is_said(stage):
    """Blender's own four of glossy ones are few; a sheet has no inside, and what is opaque sends back what it may."""
    glass, sheet, copper = (
        presets.find(name) for name in ("glasses/bk7_crown_glass", "glasses/window", "lecture/copper")
    )

    def said(preset, estimator="mirror"):
        return [p for p in advice.problems_with(stage, preset, "nodes", estimator) if p.key == "bounces"]

    assert stage.cycles.glossy_bounces == 4
    for estimator in ("mirror", "closure"):
        (problem,) = said(glass, estimator)
        assert problem.text.endswith("is lost: Glossy 4")
    assert said(sheet) == said(copper) == []
    stage.cycles.max_bounces = 3
    (problem,) = said(glass)
    assert problem.text.endswith("is lost: Total 3, Glossy 4")
    transmission = stage.cycles.transmission_bounces
    problem.fix()
    assert (stage.cycles.max_bounces, stage.cycles.glossy_bounces) == (12, 12)
    assert stage.cycles.transmission_bounces == transmission
    assert said(glass) == []


def test_the_preview_keeps_the_light_within_glass(blender):
    with headless.quiet():
        shown = scene.preview()
    found = advice.problems_with(shown, presets.find("glasses/frosted_glass"), "nodes", "mirror")
    assert "bounces" not in [problem.key for problem in found]


def test_glass_without_refractive_caustics_is_said(stage):
    stage.cycles.caustics_refractive = False
    (problem,) = (p for p in advice.problems(stage, "nodes", "mirror", model="glass") if p.key == "refractive")
    problem.fix()
    assert stage.cycles.caustics_refractive
