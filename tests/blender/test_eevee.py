# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows: transparent things are seen through."""

import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, rebuild
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.lab.bench import everyday_stage
from vgroove.lab.bench.everyday_stage import Scenario
from vgroove.lab.scenery import add_node, background, surface, wire
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender

SIZE = 24
WALL, WORLD = (1.0, 0.1, 0.1), (0.1, 0.1, 1.0)


def render_in_eevee(shown, samples=1):
    shown.render.engine, shown.eevee.taa_render_samples = versions.EEVEE, samples
    with headless.quiet():
        return gonio.rendered(shown)


def stage():
    """Blender's start scene with a ball, without a light."""
    with headless.quiet():
        return everyday_stage.prepare(Scenario("ball"), size=SIZE)


@pytest.mark.parametrize("backend", ["nodes", "osl"])
@pytest.mark.parametrize(("preset", "refracts"), [("glasses/bk7_crown_glass", True), ("liquids/red_wine", True),
                                                  ("window", False), ("lecture/copper", False)])  # fmt: skip
def test_materials_that_bend_light_are_traced_through(blender, preset, refracts, backend):
    """Also after a change of the estimator; panes need no tracing."""
    made = build(presets.find(preset), Choice(backend, "closure"))
    assert made.use_raytrace_refraction == refracts
    rebuild.rebuild(made, blender.context.scene, estimator="mirror")
    assert made.use_raytrace_refraction == refracts


@pytest.mark.once
@pytest.mark.parametrize(("preset", "traced", "behind"), [("glasses/bk7_crown_glass", True, WALL),
                                                          ("glasses/bk7_crown_glass", False, WORLD),
                                                          ("window", False, WALL)])  # fmt: skip
def test_eevee_shows_what_is_behind_glass(blender, preset, traced, behind):
    """A wall through the middle of a ball; the world, where the scene has no raytracing; and a pane hides nothing.

    Of each colour at least a half arrives, of the other at most a half: a ball of glass passes 0.92.
    """
    shown = stage()
    toward = shown.camera.location.normalized()
    wall = everyday_stage.square(shown, "Wall", 40.0, -4.0 * toward, toward=shown.camera.location)
    wall.data.materials.append(surface("Wall", lambda tree: add_node(tree, "Emission", Color=WALL)))
    wire(shown.world.node_tree, WORLD, background(shown.world).inputs["Color"])
    shown.objects["Subject"].data.materials.append(build(presets.find(preset), Choice("nodes", "mirror")))
    shown.eevee.use_raytracing = traced
    middle = render_in_eevee(shown, samples=4)[10:14, 10:14].mean(axis=(0, 1))
    red, _, blue = middle
    assert (red > 0.5, blue < 0.5) == (behind == WALL,) * 2
