"""Files, the Asset Browser and Material Preview. Scenarios for tools/window/hands.py."""

import sys
import time
from itertools import pairwise

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

EXTENSION = "bl_ext.user_default.vgroove"
# Of every model; one by each quality beside Standard, one that changes over time.
TWENTY = [
    "metals/gold", "metals/copper", "metals_schlick/iron_schlick", "finished_metals/copper_satin",
    "alloys/brass", "lecture/plastic", "plastics/abs_plastic", "diffuse/plaster",
    "diffuse/clay", "car_paints/blue", "car_paints/polaris_silver", "glasses/glass",
    "glasses/window", "gems/diamond", "liquids/water", "translucent/marble",
    "translucent/skin_1", "time_varying/rusting_iron", "metals/silver", "lecture/aluminium",
]  # fmt: skip
DARKEST = 8 / 255  # as displayed; black is 0
QUALITIES = {"metals/silver": "mirror", "lecture/aluminium": "corrected"}


def module(name):
    return sys.modules[f"{EXTENSION}.{name}"]


def ball(preset, x, y):
    """A ball with a preset, as the panel applies it; returns the seconds that this took the processor."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, location=(x, y, 0.0))
    bpy.ops.object.shade_smooth()
    settings = bpy.context.scene.vgroove
    settings.preset, settings.estimator = preset, QUALITIES.get(preset, "auto")
    began = time.thread_time()
    assert bpy.ops.vgroove.apply() == {"FINISHED"}
    return time.thread_time() - began


def on_screen(hands, area, point):
    """Where the viewport shows a point."""
    region = hands.region(area, "WINDOW")
    x, y = location_3d_to_region_2d(region, area.spaces.active.region_3d, point)
    return int(region.x + x), int(region.y + y)


def starts(hands):
    """What the panel warns of in Blender's own scene."""
    assert EXTENSION in bpy.context.preferences.addons
    yield 0.1
    operators = module("addon.ui.operators")
    hands.notes["warnings"] = [one.text for one in operators.current_problems(bpy.context.scene)]


def saves(hands):
    """Twenty presets on balls, three times, of which the fastest counts; the file and its picture."""
    rounds = []
    for _ in range(3):
        bpy.ops.wm.read_homefile()
        yield 1.0
        bpy.data.objects.remove(bpy.data.objects["Cube"])
        with hands.within(hands.area("VIEW_3D")):
            rounds.append([ball(preset, 2.5 * (k % 5 - 2), 2.5 * (k // 5 - 1.5)) for k, preset in enumerate(TWENTY)])
    hands.notes["seconds"] = dict(zip(TWENTY, np.min(rounds, axis=0).tolist(), strict=True))
    scene = bpy.context.scene
    camera = scene.camera
    camera.location, camera.rotation_euler = (0.0, 0.0, 20.0), (0.0, 0.0, 0.0)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 13.0
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 8, False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 80, 64, 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    render(hands, "before")
    path = hands.folder / "twenty.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    hands.notes["bytes"] = path.stat().st_size


def render(hands, name):
    bpy.context.scene.render.filepath = str(hands.folder / f"{name}.exr")
    bpy.ops.render.render(write_still=True)


def reopens(hands):
    """Where the extension is not installed the file renders the same."""
    assert EXTENSION not in bpy.context.preferences.addons
    yield 0.1
    bpy.ops.wm.open_mainfile(filepath=str(hands.folder / "twenty.blend"))
    yield 1.0
    assert not hasattr(bpy.types.Scene, "vgroove")
    outside = [*bpy.data.libraries, *(one for one in bpy.data.images if one.source == "FILE" and not one.packed_file)]
    hands.notes["missing"] = [one.name for one in outside]
    render(hands, "after")
    before, after = (hands.pixels(hands.folder / f"{name}.exr") for name in ("before", "after"))
    hands.notes["difference"] = float(np.abs(before - after).max())
    hands.notes["brightest"] = float(before.max())


def previews(hands):
    """Material Preview, a ball for each model, once EEVEE has compiled them."""
    yield 0.1
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    area = hands.area("VIEW_3D")
    nodes = module("addon.blender.shader_nodes").NODES
    where = {name: (2.4 * (k % 4 - 1.5), 2.4 * (0.5 - k // 4), 0.0) for k, name in enumerate(nodes)}
    with hands.within(area):
        for name, of in nodes.items():
            ball(of.preset, *where[name][:2])
        bpy.ops.object.select_all(action="DESELECT")
        bpy.ops.view3d.view_axis(type="TOP")
        bpy.ops.view3d.view_all()
    area.spaces.active.overlay.show_overlays = False
    area.spaces.active.shading.type = "MATERIAL"
    yield 1.0  # the view takes its place
    places = {name: on_screen(hands, area, place) for name, place in where.items()}
    shown = []
    while len(shown) < 3 or not all(np.array_equal(*pair) for pair in pairwise(shown[-3:])):
        yield 4.0
        screen = hands.look("preview")
        shown.append(np.array([screen[y - 15 : y + 15, x - 15 : x + 15].mean((0, 1)) for x, y in places.values()]))
        if np.ptp(shown[-1], axis=0).max() < 0.1:
            shown.clear()  # all look alike: EEVEE itself is being compiled
    hands.notes["colors"] = dict(zip(nodes, shown[-1].tolist(), strict=True))


def switches(hands):
    """A value is edited while the viewport goes to Material Preview, to Rendered and back to Solid, by the pie on Z."""
    bpy.context.scene.vgroove.preset = "metals/gold"
    bpy.context.scene.render.engine, bpy.context.scene.cycles.preview_samples = "CYCLES", 4
    bpy.ops.vgroove.apply()
    bpy.ops.ed.undo_push(message="Gold")
    area = hands.area("VIEW_3D")
    yield from hands.tab(area, "V-Groove")
    parts = "VGROOVE_PT_advice", "VGROOVE_PT_parameters", "VGROOVE_PT_source"
    yield from hands.find(area, "vgroove.apply")
    yield from hands.unfold(area, "VGROOVE_PT_parameters", parts)

    def rough():
        nodes = bpy.context.object.active_material.node_tree.nodes  # undo makes others of them
        return next(one.inputs["Roughness"] for one in nodes if one.type == "GROUP")

    side = on_screen(hands, area, (0.0, -1.0, 0.0))
    for kind, key, value in (  # keys as they lie on a keypad
        ("MATERIAL", "TWO", "0.3"),
        ("RENDERED", "EIGHT", "0.6"),
        ("SOLID", "SIX", "0.9"),
    ):
        yield from hands.enter(area, rough().path_from_id("default_value"), value)
        yield from hands.move(*on_screen(hands, area, (0.0, -3.0, 0.0)))
        yield from hands.key("Z")
        hands.picture(f"pie_{kind}")
        yield from hands.key(key)
        assert (area.spaces.active.shading.type, f"{rough().default_value:.1f}") == (kind, value)
        yield from until_golden(hands, side)
        yield from hands.key("Z", ctrl=True)
        yield from hands.key("Z", ctrl=True, shift=True)
        assert f"{rough().default_value:.1f}" == value


def until_golden(hands, at):
    """The screen becomes so, once a shader is compiled, and neither black nor magenta is left."""
    x, y = at
    for _ in range(20):
        yield 2.0
        red, green, blue = hands.look("switched")[y - 10 : y + 10, x - 10 : x + 10].mean((0, 1))
        if red > green > 1.1 * blue > DARKEST:
            return
    message = f"not golden: {red:.2f}, {green:.2f}, {blue:.2f}"
    raise AssertionError(message)


def drags(hands):
    """Gold from the Asset Browser onto the cube."""
    assert bpy.ops.vgroove.asset_library(shown=True) == {"FINISHED"}
    area = hands.area("PROPERTIES")
    area.ui_type = "ASSETS"
    yield 1.0
    space = area.spaces.active
    space.show_region_toolbar = space.show_region_tool_props = False
    space.params.asset_library_reference = "V-Groove"
    space.params.filter_search = "gold"
    yield 2.0
    region = hands.region(area, "WINDOW")
    first = region.x + 60, region.y + region.height - 60
    yield from hands.drag(first, on_screen(hands, hands.area("VIEW_3D"), (0.0, 0.0, 0.0)))
    yield 1.0
    hands.picture("dropped")
    made = bpy.context.object.active_material
    assert (made.name, made.library) == ("Gold", None)
    assert module("addon.blender.material").is_ours(made)
    yield from hands.key("Z", ctrl=True)
    assert bpy.context.object.active_material.name == "Material"
