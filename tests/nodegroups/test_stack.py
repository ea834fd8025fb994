# SPDX-License-Identifier: GPL-3.0-or-later
"""No material outgrows Cycles' stack, on which it would render black without an error."""

from contextlib import contextmanager
from itertools import cycle, product

import pytest

from vgroove import headless
from vgroove.addon.blender import choice, gonio, lamps, roles
from vgroove.addon.blender.material import BUILDERS, Choice, build, lamps_to_bind, parameter_sockets
from vgroove.addon.choose import advice
from vgroove.addon.library import presets
from vgroove.headless import stack_overflows
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender

SPARE = 24  # floats for an artist's own nodes: eight colours or vectors that are all needed at once
KINDS = {"SUN": "angle", "POINT": "shadow_soft_size", "SPOT": "shadow_soft_size", "AREA": "size"}
RIGS = {f"{count} {kind.lower()}": [kind] * count for kind, count in product(KINDS, (1, 8))}
RIGS |= {"two of each": list(KINDS) * 2, "a sun and 7 points": ["SUN", *["POINT"] * 7]}
RIGS |= {"4 areas and 4 spots": ["AREA"] * 4 + ["SPOT"] * 4, "4 points and 4 areas": ["POINT"] * 4 + ["AREA"] * 4}
# Parts of these rigs, whose shaders are parts of theirs: one row each, with models, estimators and sizes in turn
FEWER = {f"{count} {kind.lower()}": [kind] * count for kind, count in product(KINDS, range(2, 8))}
FEWER |= {f"{count} mixed": [*KINDS, *KINDS][:count] for count in range(2, 8)}
MODELS = {
    "schlick": "lecture/copper", "conductor": "metals/copper", "f82": "metals_schlick/copper_schlick",
    "diffuse": "diffuse/clay", "coupled sum": "plastics/abs_plastic",
    "body": "translucent/apple", "paint": "car_paints/blue",
    "brushed": "finished_metals/copper_turned", "ward": "lecture/ward_brdf_viewer",
}  # fmt: skip
ESTIMATORS = ("corrected", "direct", "hybrid", "mirror")


def light(shown, kinds, *, sized):
    """Lights around the ball; ``sized``: else of no size, where the kind can have none."""
    import bpy

    for number, kind in enumerate(kinds):
        data = bpy.data.lights.new(f"Light {number}", kind)
        setattr(data, KINDS[kind], 0.2 if sized or kind == "AREA" else 0.0)
        item = bpy.data.objects.new(f"Light {number}", data)
        item.location = (number - 3.0, -2.0, 3.0)
        shown.collection.objects.link(item)


def padded(made, count):
    """Wrap a material's surface so that ``count`` more floats lie on the stack all the while: read on both sides."""
    tree = made.node_tree
    output = tree.get_output_node("CYCLES")
    inner = output.inputs["Surface"].links[0].from_socket
    geometry, split = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(geometry.outputs["Position"], split.inputs[0])

    def add(a, b):
        node = tree.nodes.new("ShaderNodeVectorMath")
        tree.links.new(a, node.inputs[0])
        if isinstance(b, float):
            node.inputs[1].default_value = (b, b, b)
        else:
            tree.links.new(b, node.inputs[1])
        return node.outputs[0]

    pads = [add(geometry.outputs["Position"], 1.0 + k) for k in range(count // 3)]
    sides = []
    for total in (geometry.outputs["Normal"], geometry.outputs["Incoming"]):
        for pad in pads:
            total = add(total, pad)  # noqa: PLW2901 - a sum
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(total, emission.inputs["Color"])
        sides.append(emission.outputs[0])
    both, mix = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeMixShader")
    for source, socket in zip((inner, sides[0]), both.inputs, strict=True):
        tree.links.new(source, socket)
    for source, socket in zip((split.outputs[0], both.outputs[0], sides[1]), mix.inputs, strict=True):
        tree.links.new(source, socket)
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def textured(made):
    """A bump, and a texture of its own in each input: Cycles would merge what two lobes do with the same one."""
    tree = made.node_tree

    def noise():
        node = tree.nodes.new("ShaderNodeTexNoise")
        node.inputs["Scale"].default_value = len(tree.nodes)
        return node.outputs[0]

    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(noise(), bump.inputs["Height"])
    tree.links.new(bump.outputs[0], roles.node(made, roles.MODEL).inputs["Normal"])
    for socket in parameter_sockets(made).values():
        tree.links.new(noise(), socket)


@contextmanager
def lit(kinds, *, sized):
    """A scene of four pixels with lights, and a function that tells whether a ball of a material outgrows the stack."""
    import bpy

    with headless.quiet(), gonio.stage((2, 2), samples=1, seed=0, shading_osl=False) as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        light(stage, kinds, sized=sized)
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        camera.location = (0, 0, 3)
        stage.collection.objects.link(camera)
        stage.camera = camera
        stage.view_layers[0].update()

        def overflows(made):
            gonio.sphere(stage, made)
            return stack_overflows(lambda: gonio.rendered(stage))

        yield stage, overflows


def test_the_message_is_heard(empty_material):
    """A shader of 300 floats is black, and nothing but a line on the standard streams says so."""
    made = empty_material()
    tree = made.node_tree
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    with lit([], sized=True) as (_, overflows):
        assert not overflows(made)
        padded(made, 300)
        assert overflows(made)


@pytest.mark.parametrize("sized", [True, False], ids=["sized", "zero"])
@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("model", MODELS)
def test_no_material_outgrows_the_stack(blender, model, estimator, rig, sized):
    """With SPARE floats beside it, a bump, and every input textured, but for a paint's 19; in 4.5 as it is built."""
    check(model, estimator, RIGS[rig], sized=sized)


@pytest.mark.once
@pytest.mark.parametrize(
    ("rig", "model", "estimator", "sized"),
    [*zip(FEWER, cycle(MODELS), cycle(ESTIMATORS), cycle((True, False, True)), strict=False)],
)
def test_no_material_outgrows_the_stack_in_fewer_lights(blender, model, estimator, rig, sized):
    """Two to seven of each kind, and mixed."""
    check(model, estimator, FEWER[rig], sized=sized)


def check(model, estimator, kinds, *, sized):
    preset = presets.find(MODELS[model])
    if estimator not in BUILDERS[preset.model]:
        assert (model, estimator) in {("body", "direct"), ("brushed", "hybrid"), ("ward", "hybrid")}
        return
    old = not versions.since(5, 0)
    with lit(kinds, sized=sized) as (stage, overflows):
        bound = lamps_to_bind(stage, estimator, preset.model)
        made = build(preset, Choice("nodes", estimator, bound, bounces=preset.can_bounce))
        if not old and model != "paint":
            textured(made)
        if not old:
            padded(made, SPARE)
        assert not overflows(made)


def test_lights_that_have_no_room_are_named():
    """The panel says which, before the render; the strongest are bound."""
    with lit(["SUN"] * 8, sized=True) as (stage, overflows):
        for number, item in enumerate(lamps.of_scene(stage)):
            item.data.energy = 10.0 - number
        preset, known = presets.find(MODELS["paint"]), lamps.rig_lights(stage)
        bound = lamps_to_bind(stage, "corrected", "car_paint")
        assert list(bound) == known[: choice.most_lights("corrected", "car_paint")]
        (said,) = (p.text for p in advice.problems_with(stage, preset, "nodes", "corrected") if p.key == "limit")
        assert f"the {len(bound)} strongest lights" in said
        assert all(one.name in said for one in known[len(bound) :])
        assert not overflows(build(preset, Choice("nodes", "corrected", bound)))
        assert overflows(build(preset, Choice("nodes", "corrected", tuple(known))))
