# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert and Bake to Principled as an artist presses them: all of it, or one line and nothing; one step to undo."""

from types import SimpleNamespace

import pytest

import vgroove
from vgroove import headless
from vgroove.addon.blender import material
from vgroove.addon.library import presets
from vgroove.addon.ui import export

pytestmark = pytest.mark.blender

OPERATORS = (export.VGROOVE_OT_to_principled, export.VGROOVE_OT_bake)


@pytest.fixture
def extension(blender):
    """The extension switched on in Blender's default scene, with the cube selected, in copper."""
    with headless.quiet():
        blender.ops.wm.read_factory_settings()
    vgroove.register()
    item = blender.context.object
    item.data.materials.clear()
    item.data.materials.append(material.build(presets.find("metals/copper"), material.Choice(estimator="fit")))
    yield blender
    vgroove.unregister()


def run(extension, operator, /, **settings):
    with headless.quiet():
        return getattr(extension.ops.vgroove, operator)(**settings)


def textured(extension):
    """The cube's material, with a picture as its slope."""
    made = extension.context.object.active_material
    node = made.node_tree.nodes.new("ShaderNodeTexChecker")
    made.node_tree.links.new(node.outputs["Fac"], material.parameter_sockets(made)["m"])
    return made


@pytest.mark.parametrize(("operator", "settings"), [("to_principled", {}), ("bake", {"size": 32})])
def test_every_slot_of_the_selected_objects_is_converted_in_one_step(extension, operator, settings):
    """Other materials and other objects keep theirs; undo brings all back."""
    item, made = extension.context.object, textured(extension)
    other = extension.data.materials.new("Other")
    for one in (other, made):
        item.data.materials.append(one)
    apart = extension.data.objects.new("Apart", item.data.copy())
    extension.context.scene.collection.objects.link(apart)
    with headless.quiet():
        extension.ops.ed.undo_push(message="before")
        assert run(extension, operator, **settings) == {"FINISHED"}
        extension.ops.ed.undo_push(message="after")
    names = [slot.name for slot in extension.context.object.material_slots]
    assert names == ["Copper Principled", "Other", "Copper Principled"]
    assert [slot.name for slot in extension.data.objects["Apart"].material_slots] == ["Copper", "Other", "Copper"]
    nodes = extension.data.materials["Copper Principled"].node_tree.nodes
    kinds = {node.bl_idname for node in nodes}
    assert ("ShaderNodeTexImage" in kinds, "ShaderNodeTexChecker" in kinds) == (
        (True, False) if operator == "bake" else (False, True)
    )
    with headless.quiet():
        extension.ops.ed.undo()
    assert [slot.name for slot in extension.context.object.material_slots] == ["Copper", "Other", "Copper"]
    assert "Copper Principled" not in extension.data.materials


@pytest.mark.parametrize("operator", ["to_principled", "bake"])
def test_what_is_not_selected_is_told(extension, operator):
    """Before anything is pressed."""
    with headless.quiet():
        extension.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Switch to Object Mode first"):
        run(extension, operator)
    with headless.quiet():
        extension.ops.object.mode_set(mode="OBJECT")
    extension.context.object.active_material = None
    with pytest.raises(RuntimeError, match="Select objects with a V-Groove material"):
        run(extension, operator)


def test_an_object_without_a_uv_map_is_refused_and_nothing_is_changed(extension):
    """Nor for the objects before it."""
    item, made = extension.context.object, textured(extension)
    bare = extension.data.objects.new("Bare", extension.data.meshes.new("Bare"))
    bare.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    bare.data.materials.append(material.build(presets.find("metals/gold"), material.Choice(estimator="fit")))
    extension.context.scene.collection.objects.link(bare)
    bare.select_set(state=True)
    before = {name: sorted(one.name for one in getattr(extension.data, name)) for name in ("materials", "images")}
    with pytest.raises(RuntimeError, match="Error: Bare has no UV map; unwrap it first"):
        run(extension, "bake", size=16)
    assert item.active_material == made
    assert {name: sorted(one.name for one in getattr(extension.data, name)) for name in before} == before


def test_the_buttons_have_tooltips_units_and_ranges(extension):
    """The size is in pixels, and the panel shows both buttons with a sentence."""
    for operator in OPERATORS:
        kind = getattr(extension.ops.vgroove, operator.bl_idname.partition(".")[2]).get_rna_type()
        assert kind.description == operator.bl_description
        assert "UNDO" in operator.bl_options
    size = extension.ops.vgroove.bake.get_rna_type().properties["size"]
    assert (size.subtype, size.hard_min, size.hard_max, size.default) == ("PIXEL", 16, 8192, 1024)
    assert size.description
    buttons, labels = [], []
    column = SimpleNamespace(label=lambda text, icon: labels.append(text))
    layout = SimpleNamespace(column=lambda **_: column, operator=lambda name, icon: buttons.append(name))
    context = SimpleNamespace(region=SimpleNamespace(width=280))
    export.VGROOVE_PT_export.draw(SimpleNamespace(layout=layout), context)
    assert buttons == ["vgroove.bake", "vgroove.to_principled"]
    assert " ".join(labels) == export.ABOUT


def test_what_is_left_out_is_reported(extension):
    """By name, as a warning."""
    made = extension.context.object.active_material
    node = made.node_tree.nodes.new("ShaderNodeTexChecker")
    made.node_tree.links.new(node.outputs["Color"], material.parameter_sockets(made)["n"])
    said = []
    button = SimpleNamespace(
        report=lambda kind, text: said.append((kind, text)), finish=lambda *_: [], flaw=lambda _item: ""
    )
    export.VGROOVE_OT_to_principled.execute(button, extension.context)
    assert said == [({"WARNING"}, "Made: Copper Principled. Copper Principled leaves out what is linked to IOR")]


def test_a_bake_that_fails_leaves_nothing_behind(extension, monkeypatch):
    """Of materials before it neither: those are as they were, and no image stays."""
    from vgroove.addon.blender import bake

    item, made = extension.context.object, textured(extension)
    item.data.materials.append(material.build(presets.find("metals/gold"), material.Choice(estimator="fit")))
    node = item.data.materials[1].node_tree.nodes.new("ShaderNodeTexChecker")
    node.id_data.links.new(node.outputs["Fac"], material.parameter_sockets(item.data.materials[1])["m"])
    asked, real = [], bake._run

    def run_once(*given):
        asked.append(given)
        if len(asked) > 1:
            message = "Error: out of memory"
            raise RuntimeError(message)
        real(*given)

    monkeypatch.setattr(bake, "_run", run_once)
    kinds = ("materials", "images", "objects", "scenes")
    before = {name: sorted(one.name for one in getattr(extension.data, name)) for name in kinds}
    with pytest.raises(RuntimeError, match="Gold Principled cannot be baked: out of memory"):
        run(extension, "bake", size=16)
    assert item.data.materials[0] == made
    assert {name: sorted(one.name for one in getattr(extension.data, name)) for name in kinds} == before
