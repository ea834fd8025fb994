# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows: the formula at lights, and transparent things are seen through."""

from functools import partial

import bpy
import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, groups, rebuild, roles
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.lab.bench import everyday_stage
from vgroove.lab.bench.everyday_stage import Scenario
from vgroove.lab.scenery import add_node, add_object, background, light_data, quad, surface, wire, write_exact
from vgroove.nodegroups import eevee, versions

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


# The formula at lights, in Blender 5.3

CELLS, PIXELS = 15, 3  # per side of a subject; across a cell
STEEPEST = 0.94  # sine of the largest angle of a cell's normal to the view
HALF, PACKED = 2.0**-11, 2.0**-7  # rounding of EEVEE's pixels, and of its closures' colours: 10 and 6 bits
SUN, WARM = np.array([0.6, 0.0, 0.8]), (1.0, 0.7, 0.4)
POINT, POINT_POWER = np.array([9.0, 12.0, 16.0]), 12000.0


def normals():
    """Of the cells, (rows from the top, columns, 3); NaN where there is none."""
    x, y = np.meshgrid(*[(np.arange(CELLS) + 0.5) / CELLS * 2.0 - 1.0] * 2)
    with np.errstate(invalid="ignore"):
        return np.stack([x, -y, np.sqrt(np.where(np.hypot(x, y) < STEEPEST, 1.0 - x * x - y * y, np.nan))], axis=-1)


def add_cells(shown, made, left):
    """Flat cells, each with its normal, that appear as squares from above: their pixels need no interpolation."""
    corners, centres, N = [], cells(left), normals()
    for centre, n in zip(centres[np.isfinite(N[..., 2])], N[np.isfinite(N[..., 2])], strict=True):
        for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)):
            corners.append((centre[0] + x, centre[1] + y, -(n[0] * x + n[1] * y) / n[2]))
    mesh = bpy.data.meshes.new("Cells")
    mesh.from_pydata(corners, [], [range(k, k + 4) for k in range(0, len(corners), 4)])
    mesh.materials.append(made)
    add_object(shown, "Cells", mesh)


def cells(left):
    """Places of the cells' middles, as of ``normals``."""
    x, y = np.meshgrid(left + np.arange(CELLS) + 0.5, CELLS / 2 - np.arange(CELLS) - 0.5)
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


def cells_stage(materials):
    """The materials side by side, from above, in a black world."""
    with headless.quiet():
        bpy.ops.wm.read_factory_settings()
    shown = bpy.context.scene
    for unwanted in ("Cube", "Light"):
        bpy.data.objects.remove(shown.objects[unwanted])
    for k, make in enumerate(materials):
        add_cells(shown, make(), k * CELLS)
    write_exact(shown, CELLS * PIXELS)
    shown.render.resolution_x *= len(materials)
    shown.render.filter_size = 0.0
    shown.camera.data.type, shown.camera.data.ortho_scale = "ORTHO", CELLS * len(materials)
    shown.camera.location, shown.camera.rotation_euler = (CELLS * len(materials) / 2, 0.0, 50.0), (0, 0, 0)
    background(shown.world).inputs["Strength"].default_value = 0.0
    return shown


def seen(shown):
    """EEVEE's picture of the cells: (subjects, cells, 3)."""
    middle = render_in_eevee(shown)[PIXELS // 2 :: PIXELS, PIXELS // 2 :: PIXELS]
    apart = np.stack(np.split(middle, middle.shape[1] // CELLS, axis=1))
    return apart[:, np.isfinite(normals()[..., 2])]


def expected(model, left=None):
    """f cos(theta_i) E of the reference in the light of ``add_lights``; without ``left`` in that of the sun alone."""
    there = np.isfinite(normals()[..., 2])
    N = normals()[there]
    B = np.cross(N, TANGENT)
    B /= np.linalg.norm(B, axis=-1, keepdims=True)
    frame = np.stack([np.cross(B, N), B, N], axis=-2)

    def lit(to_light, irradiance):
        wi, wo = (np.einsum("kij,kj->ki", frame, np.broadcast_to(one, N.shape)) for one in (to_light, (0.0, 0.0, 1.0)))
        cosine = np.maximum(wi[:, 2:], 0.0)
        return model.evaluate(wi, wo) * cosine * np.asarray(irradiance)

    by_sun = lit(SUN, 3.0 * np.array(WARM))
    if left is None:
        return by_sun
    away = POINT - cells(left)[there]
    d2 = np.sum(away**2, axis=-1, keepdims=True)
    return by_sun + lit(away / np.sqrt(d2), POINT_POWER / (4.0 * np.pi * d2))


def add_lights(shown):
    """A warm sun and a white point, without shadows: the cells would shade one another."""
    sun = add_object(shown, "Sun", light_data("Sun", "SUN", energy=3.0, color=WARM, angle=0.0, use_shadow=False), SUN)
    everyday_stage.look_at(sun)
    point = light_data("Point", "POINT", energy=POINT_POWER, shadow_soft_size=0.0, use_shadow=False)
    return sun, add_object(shown, "Point", point, POINT)


def standard(preset):
    known = presets.find(preset)
    return build(known, Choice("nodes", "fit" if "fit" in known.spec.estimators else "closure"))


def without_formula(preset):
    """A material whose group has no formula for EEVEE."""
    made = standard(preset).copy()
    node = roles.node(made, roles.MODEL)
    node.node_tree = tree = node.node_tree.copy()
    sink = next(one for one in tree.nodes if one.bl_idname == "NodeGroupOutput").inputs[0]
    tree.links.new(sink.links[0].from_node.inputs[1].links[0].from_socket, sink)
    return made


def half_of(preset):
    """A material that an artist mixed of one of ours and of black."""
    made = standard(preset)
    tree, output = made.node_tree, roles.node(made, roles.OUTPUT).inputs["Surface"]
    tree.links.new(add_node(tree, "MixShader", Fac=0.5, Shader=output.links[0].from_socket).outputs[0], output)
    return made


def brushed(preset):
    """A material whose grooves follow a tangent that is linked."""
    made = standard(preset)
    tangent = add_node(made.node_tree, "CombineXYZ", **dict(zip("XYZ", TANGENT, strict=True)))
    made.node_tree.links.new(tangent.outputs[0], roles.node(made, roles.MODEL).inputs["Tangent"])
    return made


MATTE, COATED, MIXED, BRUSHED = "plaster", "abs_plastic", "metals/copper", "finished_metals/gold_ground"
GLOSSY, SHEET = "phong/phong_red_plastic", "finished_metals/rolled_steel_sheet"
RIBBON, STEEL = "ashikhmin_shirley/satin_ribbon_ruby_as", "merl_fits/black_oxidized_steel_merl"
OAK = "merl_fits/pickled_oak_260_merl_as"
TANGENT = 0.9, 0.3, 0.2


def test_eevee_shows_the_formula_at_every_light(blender):
    """Of each model that has it, and of a mixture, as by NumPy, in shadows too; where EEVEE traces rays, closures.

    The world is shown as well, and lights do not count in it. One test, as EEVEE takes long to compile.
    """
    if not versions.LIGHT_NODES:  # no lights can be evaluated there, and nothing is built for that
        standard(MATTE)
        assert not [node for group in bpy.data.node_groups for node in group.nodes if eevee.is_formula(node)]
        return
    shown = cells_stage([partial(standard, MATTE), partial(standard, COATED), partial(half_of, MIXED),
                         partial(brushed, BRUSHED), partial(standard, GLOSSY), partial(brushed, SHEET),
                         partial(brushed, RIBBON), partial(standard, STEEL), partial(standard, OAK),
                         partial(without_formula, MATTE)])  # fmt: skip
    lights, usual = add_lights(shown), shown.eevee.light_threshold
    shown.eevee.light_threshold = 1e-5  # by its own, lights fade with distance: 5 % at 60 m
    at_lights = seen(shown)
    # Of a narrow lobe EEVEE's own closure, whose color is cut to 6 bits, holds most of what is shown
    for k, preset in enumerate((MATTE, COATED, MIXED, BRUSHED, GLOSSY, SHEET, RIBBON, STEEL, OAK)):
        share, bar = 0.5 if preset == MIXED else 1.0, 2.0 * PACKED if preset == SHEET else 0.005
        wanted = share * expected(presets.find(preset).reference(), k * CELLS)
        np.testing.assert_allclose(at_lights[k], wanted, atol=bar * wanted.max(), rtol=0.0, err_msg=preset)

    screen = add_object(shown, "Screen", quad("Screen", 6.0), POINT - (0.0, 0.0, 1.0))
    lights[1].data.use_shadow, shown.eevee.light_threshold = True, usual  # a far reach makes shadows coarse
    by_sun = expected(presets.find(MATTE).reference())
    np.testing.assert_allclose(seen(shown)[0], by_sun, atol=0.005 * by_sun.max(), rtol=0.0)
    screen.hide_render, lights[1].data.use_shadow, shown.eevee.light_threshold = True, False, 1e-5

    shown.eevee.use_raytracing = lights[1].hide_render = True  # the point is nearer to one
    traced = seen(shown)
    np.testing.assert_allclose(traced[0], traced[-1], atol=PACKED * traced[-1].max(), rtol=0.0)
    assert np.abs(traced[0] - by_sun).max() > 10 * PACKED * traced[0].max()
    shown.eevee.use_raytracing = lights[1].hide_render = False

    background(shown.world).inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    background(shown.world).inputs["Strength"].default_value = 1.0
    both = seen(shown)
    for one in lights:
        one.hide_render = True
    world = seen(shown)
    peak = both[:-1].max()
    np.testing.assert_allclose(both[:-1], world[:-1] + at_lights[:-1], atol=4 * HALF * peak, rtol=0.0)


@pytest.mark.parametrize("name", ["metals/copper", MATTE, COATED, BRUSHED, "car_paints/blue", "translucent/marble"])
def test_cycles_drops_the_formula(blender, monkeypatch, name):
    """Every bit of its picture stays, also on a mapped normal."""
    pictures = []
    for formula_of in (groups.formula_of, lambda _model: None):
        shown = stage()
        everyday_stage.light(shown, "SUN", 3.0)
        monkeypatch.setattr(groups, "formula_of", formula_of)
        made = standard(name)
        tree, normal = made.node_tree, roles.node(made, roles.MODEL).inputs["Normal"]
        tree.links.new(add_node(tree, "NormalMap", Color=(0.7, 0.5, 0.9)).outputs[0], normal)
        shown.objects["Subject"].data.materials.append(made)
        shown.cycles.samples = 4
        with headless.quiet():
            pictures.append(gonio.rendered(shown))
        nested = [node for group in bpy.data.node_groups for node in group.nodes if eevee.is_formula(node)]
        assert bool(nested) == (formula_of("oren_nayar") is not None)
    np.testing.assert_array_equal(*pictures)
    assert pictures[0].max() > 0.01
