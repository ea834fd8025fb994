# SPDX-License-Identifier: GPL-3.0-or-later
"""Every light of a scene is known, and what brings it."""

import pytest

from vgroove.addon.blender import facts
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.nodegroups import versions

from ..scenes import add, add_card, add_light, add_world, by_instance, in_background_set

pytestmark = pytest.mark.blender


@pytest.fixture
def stage(blender):
    shown = blender.context.scene
    shown.render.engine = "CYCLES"
    return shown


def lights(shown):
    return {(one.item.name, one.via) for one in facts.of(shown).lights}


def put_away(shown, item):
    """Into a collection that the scene does not hold."""
    import bpy

    rig = bpy.data.collections.new("Rig")
    shown.collection.objects.unlink(item)
    rig.objects.link(item)
    return rig


def test_plain_lights_are_known_if_they_are_rendered(stage, blender):
    sun, other = add_light(stage, "Sun"), add_light(stage, "Other")
    assert lights(stage) == {("Sun", ""), ("Other", "")}
    other.hide_render = True
    assert lights(stage) == {("Sun", "")}
    off = put_away(stage, sun)
    assert lights(stage) == set()
    stage.collection.children.link(off)
    assert lights(stage) == {("Sun", "")}
    stage.view_layers[0].layer_collection.children["Rig"].exclude = True
    assert lights(stage) == set()


def test_a_portal_is_no_light(stage):
    area = add_light(stage, "Area", "AREA", size=1.0)
    assert lights(stage) == {("Area", "")}
    area.data.cycles.is_portal = True
    assert lights(stage) == set()


def test_lights_of_collection_instances_are_known_however_deep(stage, blender):
    """An instance within an instance; nothing that is switched off within one."""
    by_instance(stage)
    assert lights(stage) == {("Sun", 'the instance "Holder"')}
    outer = put_away(stage, stage.objects["Holder"])
    holder = add(stage, "Outer", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", outer
    assert lights(stage) == {("Sun", 'the instance "Outer"')}
    blender.data.objects["Sun"].hide_render = True
    assert lights(stage) == set()


def test_a_light_that_is_repeated_is_known_as_both(stage, blender):
    """The object itself can be bound, its copy cannot."""
    by_instance(stage)
    stage.collection.objects.link(blender.data.objects["Sun"])
    assert lights(stage) == {("Sun", ""), ("Sun", 'the instance "Holder"')}


@pytest.mark.parametrize("how", ["VERTS", "FACES"])
def test_lights_on_vertices_and_faces_are_known_as_copies(stage, how):
    """The child itself is not rendered."""
    card, sun = add_card(stage, "BsdfDiffuse"), add_light(stage, "Sun")
    sun.parent, card.instance_type = card, how
    assert lights(stage) == {("Sun", 'instances of "Card"')}


def test_lights_of_particles_are_known(stage, blender):
    card, sun = add_card(stage, "BsdfDiffuse"), add_light(stage, "Sun")
    put_away(stage, sun)
    card.modifiers.new("Dust", "PARTICLE_SYSTEM")
    how = card.particle_systems[0].settings
    how.render_type, how.instance_object = "OBJECT", sun
    assert lights(stage) == {("Sun", 'the instance "Card"')}
    how.render_type, how.instance_collection = "COLLECTION", blender.data.collections["Rig"]
    assert lights(stage) == {("Sun", 'the instance "Card"')}


@pytest.mark.parametrize("given", [False, True])
@pytest.mark.parametrize("node", ["Object", "Collection"])
def test_lights_of_geometry_nodes_are_known(stage, blender, node, given):
    """By what the evaluated geometry refers to; where the viewport hides it, by what is chosen in nodes or given."""
    card, sun = add_card(stage, "BsdfDiffuse"), add_light(stage, "Sun")
    rig = put_away(stage, sun)
    tree = blender.data.node_groups.new("Rig", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    info, out = tree.nodes.new(f"GeometryNode{node}Info"), tree.nodes.new("NodeGroupOutput")
    chosen = sun if node == "Object" else rig
    if given:
        socket = tree.interface.new_socket(node, in_out="INPUT", socket_type=f"NodeSocket{node}")
        tree.links.new(tree.nodes.new("NodeGroupInput").outputs[0], info.inputs[node])
    else:
        info.inputs[node].default_value = chosen
    if node == "Object":
        info.inputs["As Instance"].default_value = True
    tree.links.new(info.outputs["Instances" if node == "Collection" else "Geometry"], out.inputs[0])
    modifier = card.modifiers.new("Rig", "NODES")
    modifier.node_group = tree
    if given and not versions.since(5, 0):
        modifier[socket.identifier] = chosen
    elif given:
        getattr(modifier.properties.inputs, socket.identifier).value = chosen
    found = {("Sun", 'the instance "Card"')}
    assert lights(stage) == found
    card.hide_viewport = True  # but not from the render
    assert lights(stage) == found
    card.hide_viewport, modifier.show_viewport = False, False
    assert lights(stage) == found
    modifier.show_render = False
    assert lights(stage) == set()


def test_lights_of_background_sets_are_known_through_to_the_last(stage, blender):
    """Also where sets go round in a circle."""
    in_background_set(stage)
    behind = stage.background_set
    assert lights(stage) == {("Sun", 'the background set "Stage"')}
    far = blender.data.scenes.new("Far")
    far.collection.objects.link(blender.data.objects.new("Moon", blender.data.lights.new("Moon", "SUN")))
    behind.background_set = far
    assert lights(stage) == {("Sun", 'the background set "Stage"'), ("Moon", 'the background set "Far"')}


def test_shining_objects_are_known_by_used_nodes(stage, blender):
    """Emission and Principled, also within a group; not what is unlinked, black or of strength 0."""
    card = add_card(stage, "Emission")
    tree = card.active_material.node_tree
    shine = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission")

    def strengths():
        return [one.strength for one in facts.of(stage).emitters]

    assert strengths() == [1.0]
    shine.inputs["Strength"].default_value = 7.0
    assert strengths() == [7.0]
    shine.inputs["Color"].default_value = (0, 0, 0, 1)
    assert strengths() == []
    tree.links.remove(tree.links[0])
    principled = tree.nodes.new("ShaderNodeBsdfPrincipled")
    output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(principled.outputs[0], output.inputs["Surface"])
    assert strengths() == []
    principled.inputs["Emission Color"].default_value = (1, 1, 1, 1)
    principled.inputs["Emission Strength"].default_value = 2.0
    assert strengths() == [2.0]
    group = blender.data.node_groups.new("Glow", "ShaderNodeTree")
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    inner, end = group.nodes.new("ShaderNodeEmission"), group.nodes.new("NodeGroupOutput")
    inner.inputs["Strength"].default_value = 3.0
    group.links.new(inner.outputs[0], end.inputs[0])
    use = tree.nodes.new("ShaderNodeGroup")
    use.node_tree = group
    tree.links.new(use.outputs[0], output.inputs["Surface"])
    assert strengths() == [3.0]


def test_what_an_artist_adds_to_our_materials_counts(stage):
    """Emission beside it, and Transparent; by itself ours neither shines nor lets light pass."""
    card = add_card(stage, "Emission")
    card.active_material = made = build(presets.find("copper"), Choice("nodes", "closure"))
    assert facts.of(stage).emitters == facts.of(stage).seen_through == ()
    tree = made.node_tree
    output = next(
        node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial" and node.target != "EEVEE"
    )
    ours = output.inputs["Surface"].links[0].from_socket
    for kind in ("ShaderNodeEmission", "ShaderNodeBsdfTransparent"):
        added, both = tree.nodes.new(kind), tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(ours, both.inputs[0])
        tree.links.new(added.outputs[0], both.inputs[1])
        tree.links.new(both.outputs[0], output.inputs["Surface"])
        known = facts.of(stage)
        assert bool(known.emitters) == (kind == "ShaderNodeEmission")
        assert known.seen_through == ((card.name,) if kind == "ShaderNodeBsdfTransparent" else ())


@pytest.mark.parametrize(("name", "passes"), [("glasses/window", True), ("glasses/glass", False)])
def test_a_sheet_of_glass_lets_shadow_rays_pass(stage, name, passes):
    card = add_card(stage, "Emission")
    card.active_material = build(presets.find(name), Choice("nodes", "mirror"))
    assert facts.of(stage).seen_through == ((card.name,) if passes else ())


@pytest.mark.parametrize(("side", "small"), [(0.2, True), (3.0, False)])
def test_a_shining_object_is_small_by_the_angle_at_which_it_is_seen(stage, side, small):
    add_card(stage, "BsdfDiffuse", name="Floor").location = (0, 0, 0)
    lit = add_card(stage, "Emission")
    lit.location, lit.scale = (0, 0, 4), (side, side, side)
    stage.view_layers[0].update()
    (found,) = facts.of(stage).emitters
    assert found.small is small


def test_worlds_are_told_apart(stage, blender):
    """None, black, even, one with a picture, a sky, a medium, and one that is not sampled."""
    assert facts.of(stage).sky.kind == ""
    shine = add_world(stage, "Background")
    assert facts.of(stage).sky.kind == "even"
    tree = stage.world.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeRGB").outputs[0], shine.inputs["Color"])
    assert facts.of(stage).sky.kind == "even"
    shine.inputs["Strength"].default_value = 0.0
    assert facts.of(stage).sky.kind == ""
    shine.inputs["Strength"].default_value = 1.0
    texture = tree.nodes.new("ShaderNodeTexSky")
    tree.links.new(texture.outputs[0], shine.inputs["Color"])
    known = facts.of(stage).sky
    assert (known.kind, known.sun_disc, known.sampled, known.volume) == ("picture", "Sky Texture", True, False)
    texture.sun_disc = False
    assert facts.of(stage).sky.sun_disc == ""
    stage.world.cycles.sampling_method = "NONE"
    assert not facts.of(stage).sky.sampled
    add_world(stage, "VolumeScatter", "Volume")
    known = facts.of(stage)
    assert (known.sky.kind, known.sky.volume, known.volumes) == ("", True, ('world "World.001"',))


def test_a_world_without_nodes_is_even(stage, blender):
    """As 4.5 has them at first."""
    stage.world = blender.data.worlds.new("Plain")
    assert facts.of(stage).sky.kind == "even"


def test_facts_of_facts_are_themselves(stage):
    known = facts.of(stage)
    assert facts.of(known) is known
