"""The BRDF Viewer in the viewport. Scenarios for tools/window/hands.py, each a generator of one test."""

import contextlib
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

ROOT = "bl_ext.user_default.vgroove"


def setting():
    return bpy.context.scene.vgroove_viewer


def place(area, point):
    """Where a point of the scene is on the screen."""
    region = next(one for one in area.regions if one.type == "WINDOW")
    x, y = location_3d_to_region_2d(region, area.spaces.active.region_3d, point)
    return region.x + x, region.y + y


SIDEBAR = 320  # pixels at the right


def viewport(hands, area, name):
    """The pixels of the viewport beside its sidebar."""
    region = hands.region(area, "WINDOW")
    found = hands.look(name)
    return found[region.y : region.y + region.height - 60, region.x : region.x + region.width - SIDEBAR]


def blue(pixels):
    """How many pixels have the lobe's color; edges of all else are drawn a little differently each time."""
    return int((pixels[..., 2] - pixels[..., 0] > 0.2).sum())


def lobe(hands):
    """Drawn over the cube where it was clicked, hidden behind it; follows edits; gone with the extension."""
    area = hands.area("VIEW_3D")
    area.spaces.active.overlay.show_stats = False
    yield from hands.tab(area, "V-Groove")
    bpy.context.scene.vgroove.preset = "lecture/copper"
    bpy.ops.vgroove.apply()
    with hands.within(area):
        bpy.ops.view3d.view_selected()
    area.spaces.active.region_3d.view_distance = 6.0
    yield from hands.move(area.x + 60, area.y + 60)
    yield 1.0
    without = viewport(hands, area, "without")
    with hands.within(area):
        bpy.ops.vgroove.pick_point("INVOKE_DEFAULT")
    yield 0.5
    yield from hands.click(place(area, (0.0, 0.0, 1.0)))  # the middle of the top
    assert (setting().place, setting().show) == ("POINT", True)
    np.testing.assert_allclose([*setting().point, *setting().normal], [0, 0, 1, 0, 0, 1], atol=0.05)
    assert setting().plots == {"PLANE"}
    yield from hands.move(area.x + 60, area.y + 60)
    yield 1.0
    corner = viewport(hands, area, "corner")[:200, 60:340]
    setting().plots = set()
    yield 1.0
    without_slice = viewport(hands, area, "without_slice")[:200, 60:340]
    assert blue(corner) > blue(without_slice) + 200
    drawn = viewport(hands, area, "drawn")
    assert blue(drawn) > blue(without) + 2000
    setting().log = True
    yield 1.0
    larger = viewport(hands, area, "larger")
    assert blue(larger) > 1.5 * blue(drawn)
    yield from aims(hands, area)
    yield from follows(hands, area, blue(larger))
    yield from stands_behind(hands, area)
    yield from leaves(hands, area, blue(without))


def aims(hands, area):
    """The light follows the mouse until a click; Esc gives the one before back."""
    with hands.within(area):
        bpy.ops.vgroove.aim_light("INVOKE_DEFAULT")
    top = place(area, (0.0, 0.0, 2.0))  # of the lobe's hemisphere, seen from obliquely above
    yield from hands.move(*top)
    yield 0.5
    assert setting().light_from == "ANGLES"
    yield from hands.key("ESC")
    assert setting().light_from == "LIGHT"
    with hands.within(area):
        bpy.ops.vgroove.aim_light("INVOKE_DEFAULT")
    yield from hands.click(top)
    assert (setting().light_from, setting().theta < 0.1) == ("ANGLES", True), setting().theta
    setting().light_from = "LIGHT"
    yield from hands.move(area.x + 60, area.y + 60)
    yield 0.5


def follows(hands, area, before):
    """An edit of an input, and back; and what its drawing takes beside drawing the same again."""
    (group,) = (n for n in bpy.context.object.active_material.node_tree.nodes if n.type == "GROUP")
    roughness = group.inputs["Roughness"]
    was = roughness.default_value
    roughness.default_value = 0.9
    yield 1.0
    assert blue(viewport(hands, area, "rougher")) > 1.2 * before
    roughness.default_value = was
    yield 1.0
    assert abs(blue(viewport(hands, area, "as_before")) - before) < 20
    times = {"same": [], "changed": []}
    with timed() as spans:
        for step in range(10):
            for name, of in times.items():
                if name == "changed":
                    roughness.default_value = was - 0.001 * (step + 1)
                spans.clear()
                area.tag_redraw()
                yield 0.3
                of.append(max(spans))  # of a change Blender may draw more than once, and the first has the work
    hands.notes["ms"] = {name: round(1e3 * min(spans), 2) for name, spans in times.items()}
    roughness.default_value = was


@contextlib.contextmanager
def timed():
    """A list that gets what each drawing of the lobe takes of the processor, in seconds."""
    module = sys.modules[f"{ROOT}.addon.ui.viewer_draw"]
    spans, draw = [], module.draw

    def measured():
        start = time.process_time()
        draw()
        spans.append(time.process_time() - start)

    for one in (measured, draw):
        module.unregister()
        module.draw = one
        module.register()
        if one is measured:
            yield spans


def stands_behind(hands, area):
    """Below the cube, where its sides hide all of a small lobe."""
    cursor = bpy.context.scene.cursor
    setting().light_from, setting().place, setting().size = "ANGLES", "CURSOR", 0.5
    setting().show = False
    cursor.location = (0.0, 0.0, 0.0)  # within the cube
    yield 1.0
    off = blue(viewport(hands, area, "off"))
    setting().show = True
    yield 1.0
    assert abs(blue(viewport(hands, area, "hidden")) - off) < 20
    cursor.location = (0.0, -1.8, 0.0)  # before it
    yield 1.0
    assert blue(viewport(hands, area, "before")) > off + 1000


def leaves(hands, area, before):
    """Without overlays, and without the extension, the viewport is as it was."""
    setting().light_from, setting().place, setting().size = "LIGHT", "POINT", 1.0
    bpy.context.scene.cursor.location = (0.0, 0.0, 0.0)
    handlers = bpy.app.handlers.depsgraph_update_post
    sys.modules[ROOT].unregister()
    area.tag_redraw()
    yield 1.0
    assert abs(blue(viewport(hands, area, "gone")) - before) < 20
    assert not [one for one in handlers if "viewer" in getattr(one, "__module__", "")]
    sys.modules[ROOT].register()
    yield 0.5


def click(hands):
    """The material of the clicked face is shown, with what its texture is there, not the active one."""
    area = hands.area("VIEW_3D")
    cube = bpy.context.object
    bpy.context.scene.vgroove.preset = "diffuse/clay"
    bpy.ops.vgroove.apply()
    clay = cube.active_material
    cube.data.materials.append(clay)
    cube.material_slots[0].material = bpy.data.materials.new("Active")
    cube.active_material_index = 0
    for face in cube.data.polygons:
        face.material_index = int(face.normal.z > 0.5)  # the top is of clay
    image = bpy.data.images.new("Red", 2, 2)
    image.pixels.foreach_set([1.0, 0.0, 0.0, 1.0] * 4)
    tree = clay.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    (group,) = (one for one in tree.nodes if one.type == "GROUP")
    tree.links.new(node.outputs[0], group.inputs["Base Color"])
    with hands.within(area):
        bpy.ops.view3d.view_selected()
    area.spaces.active.region_3d.view_distance = 6.0
    yield 1.0
    with hands.within(area):
        bpy.ops.vgroove.pick_point("INVOKE_DEFAULT")
    yield 0.5
    yield from hands.click(place(area, (0.3, 0.2, 1.0)))
    assert setting().picked == clay
    draw = sys.modules[f"{ROOT}.addon.ui.viewer_draw"]
    viewer = sys.modules[f"{ROOT}.addon.ui.viewer"]
    assert viewer.candidates(bpy.context)[0] == clay
    setting().light_from, setting().channel = "ANGLES", "color"
    wi = viewer.toward_light(bpy.context.scene, None, viewer.frame(bpy.context.scene))
    ((found, _),) = draw.shown(bpy.context, wi)
    assert found.rgb[..., 0].max() > 0.1
    assert found.rgb[..., 1].max() < 1e-3
    yield 1.0
    hands.picture("click")
    setting().place = "CURSOR"
    assert viewer.candidates(bpy.context)[0] == cube.active_material


# In place of Blender: measures at leisure. Half of it is done after a moment, all of it once the file "go" is there.
SLOW = """
import pathlib, sys, time, numpy as np
folder = pathlib.Path(sys.argv[1])
(folder / "progress").write_text("0.5")
while not (folder.parent / "go").exists():
    time.sleep(0.05)
at = np.linspace(-80.0, 80.0, 33)
one = {"at": at, "rgb": np.full((33, 3), 0.2), "cosines": np.ones((33, 2))}
np.savez(folder / "points.npz", **{f"{p}.{n}": v for p in ("PLANE", "ACROSS") for n, v in one.items()},
         **{f"{p}.{n}": v[17:] for p in ("ALBEDO", "THETA_H") for n, v in one.items()})
"""


def plots(hands):
    """All four, of Principled as it is measured, in two themes; the file of them; Esc stops a measurement."""
    area = hands.area("VIEW_3D")
    yield from hands.tab(area, "V-Groove")
    measure = sys.modules[f"{ROOT}.addon.ui.viewer_measure"]
    with hands.within(area):  # Debian's Blender has no OSL, and says so
        assert not bpy.ops.vgroove.measure.poll()
    assert "no OSL" in measure.unavailable()
    measure.unavailable = lambda: ""
    measure.command = lambda folder: ["/usr/bin/python3", "-c", SLOW, str(folder)]
    bpy.context.scene.vgroove.preset = "lecture/copper"
    bpy.ops.vgroove.apply()
    setting().other = bpy.context.object.active_material
    principled = bpy.data.materials.new("Mine")
    bpy.context.object.active_material = principled
    setting().light_from, setting().theta, setting().show = "ANGLES", 0.8, True
    setting().plots = {"PLANE", "ACROSS", "ALBEDO", "THETA_H"}
    yield 1.0
    before = blue(viewport(hands, area, "plots_before")[:220])
    with hands.within(area):
        assert bpy.ops.vgroove.measure("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
        assert not bpy.ops.vgroove.measure.poll()
    (job,) = measure._running
    yield 2.0
    assert job.progress == 0.5
    setting().theta = 0.9  # the window goes on
    yield 0.5
    setting().theta = 0.8
    hands.picture("measuring")
    yield from hands.key("ESC")
    assert measure._running == []
    assert job.process.poll() is not None
    assert not job.folder.exists()
    with hands.within(area):
        bpy.ops.vgroove.measure("INVOKE_DEFAULT")
    (job,) = measure._running
    (job.folder.parent / "go").touch()
    for _ in range(40):
        yield 0.5
        if not measure._running:
            break
    assert measure.points_of(principled, measure._measured[principled.session_uid].wi, "PLANE") is not None
    yield 1.0
    assert blue(viewport(hands, area, "plots_after")[:220]) > before + 100
    path = hands.folder / "written"
    with hands.within(area):
        assert bpy.ops.vgroove.export_plots(filepath=str(path), file_format=".png") == {"FINISHED"}
    written = hands.pixels(path.with_suffix(".png"))
    assert written.shape == (558, 3192, 3)
    assert written[:5].min() > 0.99  # paper
    assert blue(written) > 500
    set_light_theme()
    yield 1.0
    hands.picture("plots_light")


def set_light_theme():
    path = Path(bpy.utils.preset_paths("interface_theme")[0], "Blender_Light.xml")
    bpy.ops.script.execute_preset(filepath=str(path), menu_idname="USERPREF_MT_interface_theme_presets")
