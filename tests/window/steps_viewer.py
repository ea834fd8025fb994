"""The BRDF Viewer in the viewport. Scenarios for tools/window/hands.py, each a generator of one test."""

import contextlib
import sys
import time

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
    assert setting().slice
    yield from hands.move(area.x + 60, area.y + 60)
    yield 1.0
    corner = viewport(hands, area, "corner")[:170, 100:420]
    setting().slice = False
    yield 1.0
    without_slice = viewport(hands, area, "without_slice")[:170, 100:420]
    assert blue(corner) > blue(without_slice) + 200
    drawn = viewport(hands, area, "drawn")
    assert blue(drawn) > blue(without) + 2000
    setting().log = True
    yield 1.0
    larger = viewport(hands, area, "larger")
    assert blue(larger) > 1.5 * blue(drawn)
    yield from follows(hands, area, blue(larger))
    yield from stands_behind(hands, area)
    yield from leaves(hands, area, blue(without))


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
