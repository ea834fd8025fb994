# SPDX-License-Identifier: GPL-3.0-or-later
"""A lamp, and a floor that it lights: by Cycles itself, or by our groups."""

from functools import partial

from vgroove import headless, nodegroups
from vgroove.addon.blender import gonio, lamps
from vgroove.nodegroups import lamp as lamp_group

KINDS = ("SUN", "POINT", "SPOT")


def make_lamp(bpy, kind, name="Lamp"):
    """A lamp off the axis whose every followed setting differs from its default."""
    light = bpy.data.lights.new(name, kind)
    light.energy, light.color, light.exposure = 7.0, (1.0, 0.5, 0.2), 1.5
    light.use_temperature, light.temperature = True, 3000.0
    if kind == "SUN":
        light.angle = 0.0
    else:
        light.shadow_soft_size = 0.0
    if kind == "SPOT":
        light.spot_size, light.spot_blend = 1.2, 0.4
    item = bpy.data.objects.new(name, light)
    item.location, item.rotation_euler = (0.7, -0.4, 1.5), (0.5, 0.3, 0.2)
    return item


def irradiance_material(empty_material, item, backend, *, shadows):
    """Emission of the irradiance that the stage's one light sends, times the cosine."""
    import bpy

    made = empty_material("Irradiance")
    tree = made.node_tree
    (stage,) = (scene for scene in bpy.data.scenes if scene.name.startswith("VGroove gonio"))
    (light,) = lamps.follow(stage)
    build = partial(lamp_group.build_slot, slot=light.slot, shadows=shadows, osl=backend == "osl")
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = nodegroups.ensure(f"{light.slot} {shadows} {backend}", 1, build)
    geometry, cosine, positive, emission, output = (
        tree.nodes.new(f"ShaderNode{name}")
        for name in ("NewGeometry", "VectorMath", "Math", "Emission", "OutputMaterial")
    )
    cosine.operation, positive.operation, positive.inputs[1].default_value = "DOT_PRODUCT", "MAXIMUM", 0.0
    tree.links.new(geometry.outputs["Normal"], cosine.inputs[0])
    tree.links.new(node.outputs["To Lamp"], cosine.inputs[1])
    tree.links.new(cosine.outputs["Value"], positive.inputs[0])
    tree.links.new(positive.outputs[0], emission.inputs["Strength"])
    tree.links.new(node.outputs["Irradiance"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return made


def white_diffuse(empty_material):
    made = empty_material("White")
    tree = made.node_tree
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    return made


def add_mesh(bpy, stage, name, half, height, made=None):
    """One triangle that covers the square of half width ``half``.

    Where a shadow ray starts exactly on the edge of two triangles the Raycast node sees the second one and nothing
    behind it, so such a pixel is lit; a floor of two triangles would have a diagonal of them.
    """
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(-3 * half, -half, height), (3 * half, -half, height), (0, 5 * half, height)], [], [(0, 1, 2)])
    if made:
        mesh.materials.append(made)
    item = bpy.data.objects.new(name, mesh)
    stage.collection.objects.link(item)
    return item


def as_object(stage, item):
    """The light is an object of the scene."""
    stage.collection.objects.link(item)


def by_seed(stage, seeds):
    """The stage's render for each seed. Cycles keeps all but the seed, as preparing it takes longer than the render."""
    stage.render.use_persistent_data = True
    found = []
    for seed in seeds:
        stage.cycles.seed = seed
        found.append(gonio.rendered(stage).astype(float))
    return found


def floor_image(*given, **settings):
    """Radiance of a floor 4 m wide, seen from above, lit by one lamp, without bounces."""
    return floor_images([0], *given, **settings)[0]


def floor_images(
    seeds, bpy, make_material, kind, *, shading_osl, occluder=False, settings=None, samples=1, size=64, eye_near=False,
    bring=as_object,
):  # fmt: skip
    """``floor_image`` for each seed."""
    with headless.quiet(), gonio.stage((size, size), samples=samples, seed=0, shading_osl=shading_osl) as stage:
        stage.cycles.max_bounces = 0
        gonio.light(stage, gonio.Geometry())
        bpy.data.objects.remove(stage.objects[0])
        item = make_lamp(bpy, kind)
        bring(stage, item)
        if settings is not None:
            stage.cycles.filter_width = 1.0  # moves P, from which random numbers come, over the whole pixel
            settings(item)
            stage.frame_set(7)
        stage.view_layers[0].update()
        add_mesh(bpy, stage, "Floor", 3.0, 0.0, make_material(item))
        if occluder:
            add_mesh(bpy, stage, "Occluder", 0.3, 0.7).visible_camera = False
        gonio.look_down(stage, 4.0, (0.3, -0.4, 1.3) if eye_near else (0, 0, 5))
        if eye_near:
            stage.camera.data.type = "PERSP"
        return by_seed(stage, seeds)
