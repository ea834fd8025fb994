# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel registers and leaves nothing behind, draws quickly, and is explained everywhere."""

import pytest

import vgroove
from vgroove import headless
from vgroove.addon.blender import material

from .panel import drawn

pytestmark = pytest.mark.blender


def ours(bpy):
    return sorted(name for name in dir(bpy.types) if name.lower().startswith("vgroove"))


def test_registering_and_unregistering_leaves_nothing_behind(blender):
    """Twice over, classes and the scene's property come and go."""
    before = ours(blender)
    for _ in range(2):
        vgroove.register()
        assert hasattr(blender.types.Scene, "vgroove")
        vgroove.unregister()
        assert not hasattr(blender.types.Scene, "vgroove")
        assert ours(blender) == before


def test_a_failure_half_way_leaves_nothing_behind(blender, monkeypatch):
    """If one class cannot be registered, those before it are taken back."""
    from vgroove.addon.ui import panels

    original = blender.utils.register_class

    def register_class(kind):
        if kind is panels.CLASSES[-1]:
            message = "no"
            raise RuntimeError(message)
        original(kind)

    monkeypatch.setattr(blender.utils, "register_class", register_class)
    before = ours(blender)
    with pytest.raises(RuntimeError, match="no"):
        vgroove.register()
    assert ours(blender) == before
    assert not hasattr(blender.types.Scene, "vgroove")


def test_everything_in_the_panel_has_a_tooltip(extension):
    """Properties, their choices and the operators say what they do."""
    from vgroove.addon.ui import preferences, properties

    for kind in (properties.VGrooveSettings, preferences.VGroovePreferences):
        for name in kind.__annotations__:
            assert kind.bl_rna.properties[name].description, name
    settings = extension.context.scene.vgroove
    items = [properties.BACKENDS, properties.ESTIMATORS, properties.QUALITIES]
    items += [properties.family_items(settings, None), properties.shown_items(settings, None)]
    assert all(item[2] for of in items for item in of)
    for operator in operators():
        family, name = operator.bl_idname.split(".")
        kind = getattr(getattr(extension.ops, family), name).get_rna_type()
        assert kind.description == operator.bl_description
        for one in kind.properties:
            hidden = one.is_hidden or one.identifier == "rna_type" or one.identifier in FILE_SELECTOR
            assert one.description or hidden, (operator, one.identifier)


def operators():
    """Every operator's class."""
    from vgroove.addon import ui

    found = [one for of in ui.WITH_CLASSES for one in of.CLASSES if hasattr(one, "execute")]
    assert len(found) >= 19
    return found


def test_what_changes_the_file_is_undone(extension):
    """And what does not makes no step to undo."""
    unchanged = {"favourite", "copy_citation", "delete_preset", "export_preset", "asset_library"}
    unchanged |= {"measure", "measure_material", "stop_measuring", "close_measured", "export_plots"}
    assert {one.bl_idname.split(".")[1] for one in operators() if "UNDO" not in one.bl_options} == unchanged


FILE_SELECTOR = {"filepath", "check_existing"}


def test_the_panels_draw(extension):
    """With the choices, the source and the advice, in each of the editors."""
    from vgroove.addon.ui import panels

    with headless.quiet():
        extension.ops.vgroove.apply()
    extension.context.scene.render.engine = "BLENDER_WORKBENCH"
    for kind in panels.CLASSES:
        layout = drawn(extension, kind)
        assert layout.texts or layout.props, kind
        assert layout.buttons or kind is panels.VGROOVE_PT_published


def test_panels_read_the_scene_once_per_change(extension, monkeypatch):
    """No redraw reads it again, until something is changed, the frame is, or another file is opened."""
    from vgroove.addon.blender import facts
    from vgroove.addon.ui import panels

    read, of = [], facts.of

    def counted(scene, **more):
        read.extend([scene] * (not isinstance(scene, facts.SceneFacts)))
        return of(scene, **more)

    monkeypatch.setattr(facts, "of", counted)

    def reads():
        read.clear()
        for kind in panels.CLASSES:
            drawn(extension, kind)
        return len(read)

    stage = extension.context.scene
    stage.vgroove.estimator = "corrected"
    extension.context.view_layer.update()
    reads()
    assert reads() == 0
    extension.data.objects["Light"].data.energy = 7.0
    extension.context.view_layer.update()
    assert (reads(), reads()) == (1, 0)
    stage.frame_set(2)
    assert (reads(), reads()) == (1, 0)
    with headless.quiet():
        extension.ops.wm.read_homefile(use_factory_startup=True)
    assert (reads(), reads()) == (1, 0)


def test_a_redraw_is_quicker_than_one_walk_over_the_scene(extension):
    """With 1000 objects, 21 lights and 15 materials, however the material is built.

    Redraws that read the scene took four walks and more; what is left depends on the panel's texts alone and takes a
    fifth of a walk. The bound is one: between these by a factor of four either way.
    """
    from statistics import median
    from time import process_time

    from vgroove.addon.blender import lamps
    from vgroove.addon.library import presets
    from vgroove.addon.ui import panels

    stage = extension.context.scene
    copper = presets.find("lecture/copper")
    made = [material.build(copper, material.Choice("nodes", "mirror")).copy() for _ in range(15)]
    mesh = extension.data.meshes.new("Triangle")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    for index in range(1000):
        item = extension.data.objects.new("Triangle", mesh if index >= 15 else mesh.copy())
        if index < 15:
            item.data.materials.append(made[index])
        stage.collection.objects.link(item)
    for index in range(20):
        light = extension.data.lights.new("Light", ("POINT", "SUN", "AREA")[index % 3])
        stage.collection.objects.link(extension.data.objects.new("Light", light))
    extension.context.view_layer.update()

    def seconds(act):
        start = process_time()
        act()
        return process_time() - start

    def redraw():
        for kind in panels.CLASSES:
            drawn(extension, kind)

    for estimator in ("auto", "corrected", "mirror"):
        stage.vgroove.estimator = estimator
        redraw()
        ratios = [seconds(redraw) / seconds(lambda: lamps.of_scene(stage)) for _ in range(7)]
        assert median(ratios) < 1.0, estimator


def test_nothing_watches_after_the_extension_is_off(blender):
    from vgroove.addon.ui import watch

    for _ in range(2):
        vgroove.register()
        assert all(watch.forget in getattr(blender.app.handlers, name) for name in watch.CHANGES)
        vgroove.unregister()
        assert not any(watch.forget in getattr(blender.app.handlers, name) for name in watch.CHANGES)


# The asset library


def test_the_asset_library_is_registered_by_its_button_alone(extension, tmp_path, monkeypatch):
    """This Blender's, or that of the nearest earlier one; and it goes away again."""
    from vgroove.addon.blender import assets

    libraries = extension.context.preferences.filepaths.asset_libraries
    before = [one.name for one in libraries]
    monkeypatch.setattr(assets, "FOLDER", tmp_path)
    with headless.quiet(), pytest.raises(RuntimeError, match="came without its asset library"):
        extension.ops.vgroove.asset_library(shown=True)
    for version in ("3.6", "4.5", "99.0"):
        (tmp_path / version).mkdir()
        (tmp_path / version / assets.FILE).touch()
    with headless.quiet():
        for _ in range(2):  # once is enough, twice does no harm
            assert extension.ops.vgroove.asset_library(shown=True) == {"FINISHED"}
        assert [one.name for one in libraries] == [*before, "V-Groove"]
        assert libraries[-1].path == str(tmp_path / "4.5")
        assert libraries[-1].import_method == "APPEND"
        for _ in range(2):
            assert extension.ops.vgroove.asset_library(shown=False) == {"FINISHED"}
    assert [one.name for one in libraries] == before
