# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's Alpha: a mix with Transparent outside the model's node, made once it is needed."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import beside, gonio, material, principled, rebuild, roles
from vgroove.addon.blender.material import Choice, lamps_to_bind
from vgroove.addon.library import presets
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender

PIXELS, SAMPLES = 16, 64
BEHIND = 0.25  # radiance of the sky, of which a surface that is not there shows all


def kinds(made):
    return sorted(node.bl_idname for node in made.node_tree.nodes)


def test_nothing_is_added_until_something_is_transparent(blender):
    """And then one mix for each output, in either order of its sides; it counts as alpha wherever that is read."""
    made = material.build(presets.find("metals/copper"), Choice(estimator="mirror"))
    before = kinds(made)
    beside.set_alpha(made, 1.0)
    assert kinds(made) == before
    beside.set_alpha(made, 0.25)
    count = sum(1 for _ in beside.outputs(made))
    assert len(beside.joints(made, roles.CLEAR)) == count == 2
    assert principled.describe(made)["Alpha"].value == 0.25
    for mix in beside.joints(made, roles.CLEAR):
        beside.exchange(made.node_tree, mix)
    beside.set_alpha(made, 0.25)
    assert [mix.inputs[0].default_value for mix in beside.joints(made, roles.CLEAR)] == [0.75] * count
    assert principled.describe(made)["Alpha"].value == 0.25
    rebuild.rebuild(made, blender.context.scene, estimator="mirror", backend="osl")
    assert principled.describe(made)["Alpha"].value == 0.25


def rendered(blender, identity, estimator, alpha):
    """Colour of a square under a sun, seen from above before a grey sky that lights nothing else."""
    with headless.quiet(), gonio.stage((PIXELS, PIXELS), samples=SAMPLES, seed=0, shading_osl=False) as stage:
        gonio.light(stage, gonio.Geometry(30.0))
        sky = versions.nodes_of(stage.world).nodes["Background"]
        sky.inputs["Color"].default_value = (BEHIND, BEHIND, BEHIND, 1.0)
        stage.world.cycles_visibility.diffuse = stage.world.cycles_visibility.glossy = False
        preset = presets.find(identity).with_parameters(m=0.5) if "metals" in identity else presets.find(identity)
        made = material.build(preset, Choice(estimator=estimator, lamps=lamps_to_bind(stage, estimator, preset.model)))
        if alpha is not None:
            beside.set_alpha(made, 0.5)  # the mix is there
            beside.set_alpha(made, alpha)
        gonio._patch(stage, made, gonio.Geometry(30.0))
        gonio.look_down(stage, 0.5)
        return gonio.rendered(stage)


@pytest.mark.parametrize(
    ("identity", "estimator"),
    [("metals/copper", "closure"), ("metals/copper", "corrected"), ("metals/copper", "hybrid"),
     ("metals/copper", "mirror"), ("metals/copper", "direct"), ("diffuse/clay", "fit")],
)  # fmt: skip
def test_alpha_is_the_share_of_the_surface(blender, identity, estimator):
    """By every quality, lights that are bound included: a R + (1 - a) B of radiance R of the surface and B behind.

    At 1 it is the surface itself, bit for bit. Cycles draws whether a ray passes: each sample is one of two values at
    most |R| + B apart, of which the mean over N has a standard error below half of that over sqrt(N).
    """
    surface = rendered(blender, identity, estimator, None)
    np.testing.assert_array_equal(rendered(blender, identity, estimator, 1.0), surface)
    mixed = rendered(blender, identity, estimator, 0.25).mean(axis=(0, 1))
    R = surface.mean(axis=(0, 1))
    error = 0.5 * (np.abs(surface).max() + BEHIND) / np.sqrt(PIXELS**2 * SAMPLES)
    assert np.all(np.abs(mixed - (0.25 * R + 0.75 * BEHIND)) < 4.0 * error)
    assert np.all(np.abs(R - BEHIND) > 8.0 * error)
