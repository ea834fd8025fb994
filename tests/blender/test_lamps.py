# SPDX-License-Identifier: GPL-3.0-or-later
"""What lamps send by our groups is what Cycles' own send; which are bound, and which are refused."""

from math import pi

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, lamps, material
from vgroove.addon.blender.choice import lamps_to_bind, most_lights
from vgroove.addon.choose import advice
from vgroove.lab.check.cook_torrance import materials
from vgroove.lab.check.rows import SETUPS
from vgroove.nodegroups import lamp as lamp_group
from vgroove.nodegroups import versions

from .lights import KINDS, add_mesh, floor_image, irradiance_material, make_lamp, white_diffuse

pytestmark = pytest.mark.blender


def as_instance(stage, item):
    """The light comes by a collection instance that is moved, turned and not at the collection's own middle."""
    import bpy

    rig, holder = bpy.data.collections.new("Rig"), bpy.data.objects.new("Holder", None)
    rig.objects.link(item)
    rig.instance_offset = (0.2, 0.1, -0.3)
    holder.instance_type, holder.instance_collection = "COLLECTION", rig
    holder.location, holder.rotation_euler = (0.3, -0.2, 0.2), (0.2, -0.1, 0.8)
    stage.collection.objects.link(holder)


def in_set(stage, item):
    """The light is in the scene's background set."""
    import bpy

    stage.background_set = bpy.data.scenes.new("Set")
    stage.background_set.collection.objects.link(item)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("setup", SETUPS, ids=str)
def test_a_lamp_group_sends_what_cycles_own_lamp_sends(blender, empty_material, kind, setup):
    """Colour, temperature, exposure, strength, distance and cone agree with a white diffuse floor times pi."""
    cycles = pi * floor_image(blender, lambda _: white_diffuse(empty_material), kind, shading_osl=setup.shading_osl)
    ours = floor_image(
        blender,
        lambda item: irradiance_material(empty_material, item, setup.backend, shadows=False),
        kind,
        shading_osl=setup.shading_osl,
    )
    assert cycles.max() > 0.1
    # About 40 float32 operations of 6e-8 in either; the spot's edge multiplies one rounding by 1/blend, a dozen times.
    np.testing.assert_allclose(ours, cycles, atol=5e-6 * cycles.max())


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("setup", SETUPS, ids=str)
def test_a_lamp_group_casts_the_shadow_of_cycles_own_lamp(blender, empty_material, kind, setup):
    """Behind an occluder both are dark in the same pixels; on 4.5 nodes cast none, and the panel says so."""
    traced = setup.backend == "osl" or lamp_group.can_cast_shadows()
    cycles = pi * floor_image(
        blender, lambda _: white_diffuse(empty_material), kind, shading_osl=setup.shading_osl, occluder=True
    )
    ours = floor_image(
        blender,
        lambda item: irradiance_material(empty_material, item, setup.backend, shadows=traced),
        kind,
        shading_osl=setup.shading_osl,
        occluder=True,
    )
    dark = (cycles.max(-1) == 0) & (ours.max(-1) > 0)
    if not traced:
        blender.context.scene.render.engine = "CYCLES"
        blender.context.scene.collection.objects.link(make_lamp(blender, kind))
        found = advice.problems(blender.context.scene, "nodes", "direct")
        assert any(problem.key == "shadows" for problem in found)
        assert dark.any()
        return
    assert (cycles.max(-1) == 0).sum() > 50
    np.testing.assert_allclose(ours, cycles, atol=5e-6 * cycles.max())


@pytest.mark.parametrize(("kind", "bring"), [(kind, as_instance) for kind in (*KINDS, "AREA")] + [("SPOT", in_set)])
def test_a_light_that_an_instance_or_a_set_brings_sends_what_cycles_own_sends(blender, empty_material, kind, bring):
    """Moved and turned by the instance, less the collection's offset."""
    more = {"shading_osl": False, "bring": bring, "samples": 512 if kind == "AREA" else 1, "size": 16}
    cycles = pi * floor_image(blender, lambda _: white_diffuse(empty_material), kind, **more)
    ours = floor_image(
        blender, lambda item: irradiance_material(empty_material, item, "nodes", shadows=False), kind, **more
    )
    for scene in [one for one in blender.data.scenes if one.name.startswith("Set")]:
        blender.data.scenes.remove(scene)
    assert cycles.max() > 0.1
    # A point as above, and two products of matrices more; an area light of 512 samples: 16 of them over each of the
    # lamp's 5 % wide cells, across which the irradiance changes by a tenth at the most.
    np.testing.assert_allclose(ours, cycles, atol=(0.02 if kind == "AREA" else 1e-5) * cycles.max())


def test_the_longest_driver_fits_into_what_blender_takes(blender):
    """255 characters, after which it cuts: that of an ellipse which an instance brings."""
    stage, item = blender.context.scene, make_lamp(blender, "AREA")
    item.data.shape = "ELLIPSE"
    as_instance(stage, item)
    lamps.follow(stage)
    blender.context.view_layer.update()
    drivers = [curve.driver for curve in stage.animation_data.drivers]
    assert all(driver.is_valid and driver.is_simple_expression for driver in drivers)
    longest = max((driver.expression for driver in drivers), key=len)
    assert len(longest) > 200
    assert longest.endswith(" else 0")


def test_what_cannot_be_followed_is_refused_in_one_line(blender):
    """Portals, needles of light, sheared lamps, lamps with nodes and uneven spots are named with a way out."""
    stage = blender.context.scene
    items = {name: make_lamp(blender, "AREA", name) for name in ("portal", "spread under", "sheared")}
    items |= {"scaled unevenly": make_lamp(blender, "SPOT", "Spot"), "node tree": make_lamp(blender, "SUN", "Sun")}
    items |= {word: make_lamp(blender, "POINT", word) for word in ("shadow linking", "glossy rays")}
    for item in items.values():
        stage.collection.objects.link(item)
    items["portal"].data.cycles.is_portal = True
    items["shadow linking"].light_linking.blocker_collection = blender.data.collections.new("Blockers")
    items["glossy rays"].visible_glossy = False
    items["spread under"].data.spread = 0.01
    parent = blender.data.objects.new("Parent", None)
    parent.scale = (1, 3, 1)
    stage.collection.objects.link(parent)
    items["sheared"].parent = parent
    items["scaled unevenly"].scale = (1.0, 2.0, 1.0)
    versions.nodes_of(items["node tree"].data).nodes.new("ShaderNodeTexNoise")
    blender.context.view_layer.update()
    for word, item in items.items():
        refused = lamps.refusal(item)
        assert word in refused
        assert f'"{item.name}"' in refused
        assert "\n" not in refused
        with pytest.raises(material.MaterialError, match=word):
            material.Choice("nodes", "direct", (lamps.Light(item, stage),))
    assert lamps_to_bind(stage, "direct") == ()


def test_as_many_lamps_are_bound_as_fit_the_strongest_first(blender):
    """Of ten the weakest are left out, and the advice says which: two, and on 4.5 as many as its smaller stack asks."""
    most = most_lights("direct", "cook_torrance")
    assert most == (8 if versions.LEAN_STACK else 6)
    stage = blender.context.scene
    stage.render.engine = "CYCLES"
    for index in range(10):
        item = make_lamp(blender, "SUN", f"Sun {index}")
        item.data.energy = 1.0 + index
        stage.collection.objects.link(item)
    taken = lamps_to_bind(stage, "direct")
    strongest_first = [f"Sun {index}" for index in range(9, -1, -1)]
    assert [light.name for light in taken] == strongest_first[:most]
    (said,) = (p for p in advice.problems(stage, "nodes", "direct") if p.key == "limit")
    assert ", ".join(strongest_first[most:]) in said.text
    with pytest.raises(material.MaterialError, match="at most 8"):
        material.Choice("nodes", "direct", (taken * 2)[:9])


def test_the_strongest_lamp_is_the_one_that_gives_most_to_the_middle_of_the_objects(blender):
    """Near beats far, and watts count by what they give there: a sun of 1 W/m^2, 4 pi W at 1 m, pi W of area."""
    stage = blender.context.scene
    add_mesh(blender, stage, "Left", 1.0, 0.0).location = (9, 0, 0)
    add_mesh(blender, stage, "Right", 1.0, 0.0).location = (11, -4, 0)  # the middle is at (10, 0, 0)
    for name, kind, strength, height in (
        ("sun", "SUN", 1.0, 50.0),
        ("near point", "POINT", 4 * pi * 1.1, 1.0),
        ("far point", "POINT", 4 * pi * 3.0, 2.0),
        ("area", "AREA", pi * 0.9 * 2.0, 1.0),
        ("glare", "AREA", pi * 0.3, 1.0),
    ):
        item = make_lamp(blender, kind, name)
        light = item.data
        light.color, light.use_temperature, light.exposure, light.energy = (1, 1, 1), False, 0.0, strength
        if kind == "AREA":
            light.size = 1.0  # its own size counts as distance, so that a lamp at the middle stays finite
        item.location = (10, 0, height)
        stage.collection.objects.link(item)
    stage.objects["glare"].data.normalize = False
    stage.objects["glare"].scale = (3, 4, 1)
    blender.context.view_layer.update()
    names = [item.name for item in lamps.of_scene(stage)]
    assert names == ["glare", "near point", "sun", "area", "far point"]


@pytest.mark.parametrize("setup", SETUPS, ids=str)
def test_four_lamps_add_up(blender, setup):
    """The radiance of a ball under four lamps is the sum under each alone."""
    images = []
    for chosen in ([0], [1], [2], [3], [0, 1, 2, 3]):
        with headless.quiet(), gonio.stage((32, 32), samples=1, seed=0, shading_osl=setup.shading_osl) as stage:
            (first,) = gonio.light(stage, gonio.Geometry(10.0))
            items = [first]
            for kind in KINDS:
                item = make_lamp(blender, kind, f"Lamp {kind}")
                item.location = (0.7, -0.4, 2.5)
                stage.collection.objects.link(item)
                items.append(item)
            for index, item in enumerate(items):
                item.hide_render = index not in chosen
            preset = materials()["conductor"]
            bound = lamps_to_bind(stage, "direct")
            made = material.build(preset, material.Choice(setup.backend, "direct", bound, shadows=False))
            gonio.sphere(stage, made)
            gonio.look_down(stage, 2.0)
            images.append(gonio.rendered(stage).astype(float))
    *single, together = images
    assert all(image.max() > 0 for image in single)
    # Emission closures round when they are added: four sums of 6e-8.
    np.testing.assert_allclose(together, sum(single), atol=4e-7 * together.max())
