# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's operators on whatever an artist may have selected: they do it, or say in words why not; never halfway."""

import os

import pytest

from vgroove import headless
from vgroove.addon.blender import course, material, roles
from vgroove.addon.library import presets
from vgroove.addon.ui import operators

pytestmark = pytest.mark.blender


@pytest.fixture
def extension(extension):
    """By one lobe, which is the quickest to build."""
    extension.context.scene.vgroove.estimator = "closure"
    return extension


def run(extension, operator, /, **settings):
    """An operator's result."""
    with headless.quiet():
        return getattr(extension.ops.vgroove, operator)(**settings)


def plane(bpy, name):
    """A mesh of two faces."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2), (0, 2, 3)])
    return mesh


def show(bpy, item, *, alone=True):
    """Put an object into the scene and select it."""
    if alone:
        for other in bpy.context.selected_objects:
            other.select_set(state=False)
    if item.name not in bpy.context.scene.collection.objects:
        bpy.context.scene.collection.objects.link(item)
    item.select_set(state=True)
    bpy.context.view_layer.objects.active = item
    return item


@pytest.fixture
def linked(extension, tmp_path):
    """Objects linked from another file: Bare, and Slotted, whose mesh has an old material."""
    bpy = extension
    for name in ("Bare", "Slotted"):
        item = show(bpy, bpy.data.objects.new(name, plane(bpy, name)))
        if name == "Slotted":
            item.data.materials.append(bpy.data.materials.new("Old"))
    path = str(tmp_path / "library.blend")
    with headless.quiet():
        bpy.data.libraries.write(path, {bpy.data.objects[name] for name in ("Bare", "Slotted")})
        bpy.ops.wm.read_factory_settings()
    bpy.context.scene.vgroove.estimator = "closure"
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Bare", "Slotted"]
    return {item.name: item for item in wanted.objects}


# What is selected


def test_linked_objects_are_refused_in_words(extension, linked):
    """Nothing is built for them."""
    for item in linked.values():
        show(extension, item)
        before = len(extension.data.materials)
        with pytest.raises(
            RuntimeError, match=r"is linked from library\.blend; choose Object > Library Override > Make"
        ):
            run(extension, "apply")
        assert len(extension.data.materials) == before
        with pytest.raises(RuntimeError, match="active material came from this panel"):
            run(extension, "reset")


@pytest.mark.parametrize("how", ["override", "local object"])
def test_objects_whose_mesh_is_linked_get_it_on_the_object(extension, linked, tmp_path, how):
    """Where they have a slot, and it is there after save and open; where they have none, they are refused whole."""
    made = {}
    for name, item in linked.items():
        local = extension.data.objects.new(name, item.data)
        if how == "override":
            extension.context.scene.collection.objects.link(item)  # 5.3 overrides what is in use alone
            local = item.override_create()
        made[name] = show(extension, local, alone=name == "Bare")
    assert run(extension, "apply") == {"FINISHED"}
    assert made["Slotted"].active_material.name == "Copper"
    assert linked["Slotted"].active_material.name == "Old"
    assert not made["Bare"].material_slots
    assert not made["Bare"].data.materials
    show(extension, made["Bare"])
    with pytest.raises(RuntimeError, match="has no material slot, and its mesh data is linked"):
        run(extension, "apply")
    name, path = made["Slotted"].name, str(tmp_path / "scene.blend")
    with headless.quiet():
        extension.ops.wm.save_as_mainfile(filepath=path)
        extension.ops.wm.open_mainfile(filepath=path)
    item = next(one for one in extension.data.objects if one.name == name and one.library is None)
    assert item.active_material.name == "Copper"


def test_materials_that_are_linked_are_not_edited(extension, tmp_path):
    """Edit Parameters does not offer them, Apply puts a local one in their place."""
    path = str(tmp_path / "library.blend")
    run(extension, "apply")
    with headless.quiet():
        extension.data.libraries.write(path, {extension.context.object.active_material})
        extension.ops.wm.read_factory_settings()
    extension.context.scene.vgroove.estimator = "closure"
    with extension.data.libraries.load(path, link=True) as (there, wanted):
        wanted.materials = there.materials
    extension.context.object.active_material = wanted.materials[0]
    assert operators.ours(extension.context) is None
    with pytest.raises(RuntimeError, match=r"is linked from library\.blend; choose Object > Relations > Make Local"):
        run(extension, "reset")
    with pytest.raises(RuntimeError, match="can be changed here"):
        run(extension, "update")
    assert run(extension, "apply") == {"FINISHED"}
    assert extension.context.object.active_material.library is None


def test_advice_on_linked_materials_has_no_button(extension, tmp_path):
    """They cannot be updated here; Fix All passes them over."""
    from vgroove.addon.choose import advice

    path = str(tmp_path / "library.blend")
    extension.data.lights["Light"].shadow_soft_size = 0.0
    extension.context.scene.vgroove.estimator = "direct"
    run(extension, "apply")
    with headless.quiet():
        extension.data.libraries.write(path, {extension.context.object})
        extension.ops.wm.read_factory_settings()
    with extension.data.libraries.load(path, link=True) as (there, wanted):
        wanted.objects = there.objects
    show(extension, next(item for item in wanted.objects if item.type == "MESH"))
    copper = presets.find("lecture/copper")
    found = advice.problems_with(extension.context.scene, copper, "nodes", "direct")
    (stale,) = (problem for problem in found if problem.key.startswith("stale"))
    assert stale.fix is None


def test_objects_that_share_a_mesh_are_named(extension, capfd):
    """Blender keeps slots with the mesh: who else shows the material now is said."""
    other = extension.data.objects.new("Twin", extension.context.object.data)
    extension.context.scene.collection.objects.link(other)
    extension.ops.vgroove.apply()
    assert other.active_material.name == "Copper"
    assert "applied to 1 object and to Twin (same mesh)" in capfd.readouterr().out


def test_what_cannot_have_a_material_is_left_out(extension):
    """Cameras and lights beside a mesh; alone they are refused, and nothing is left behind."""
    mesh = show(extension, extension.data.objects.new("Bare", plane(extension, "Bare")))
    for name in ("Camera", "Light"):
        show(extension, extension.data.objects[name], alone=False)
    assert run(extension, "apply") == {"FINISHED"}
    assert [slot.material.name for slot in mesh.material_slots] == ["Copper"]
    mesh.select_set(state=False)
    extension.context.scene.vgroove.preset = "lecture/aluminium"
    with pytest.raises(RuntimeError, match=r"cannot have a material; select a mesh, curve or text \(and 1 more\)"):
        run(extension, "apply")
    assert "Aluminium" not in extension.data.materials


def test_in_edit_mode_the_selected_faces_get_the_material(extension):
    """As by Blender's own Assign: the others keep theirs, one slot for each material."""
    import bmesh

    item = show(extension, extension.data.objects.new("Bare", plane(extension, "Bare")))
    extension.ops.object.mode_set(mode="EDIT")

    def select(*chosen):
        mesh = bmesh.from_edit_mesh(item.data)
        for selected in (False, True):  # what is deselected last takes shared corners along
            for face in mesh.faces:
                if (face.index in chosen) == selected:
                    face.select_set(selected)
        bmesh.update_edit_mesh(item.data)

    select()
    with pytest.raises(RuntimeError, match="Select faces first, or leave Edit Mode"):
        run(extension, "apply")
    for preset, face in (("lecture/copper", 1), ("lecture/aluminium", 0), ("lecture/copper", 0)):
        extension.context.scene.vgroove.preset = preset
        bmesh.from_edit_mesh(item.data).faces.ensure_lookup_table()
        select(face)
        assert run(extension, "apply") == {"FINISHED"}
        item.update_from_editmode()
        names = [item.material_slots[of.material_index].name for of in item.data.polygons]
        assert names[face] == presets.find(preset).name
    assert names == ["Copper", "Copper"]
    assert [slot.name for slot in item.material_slots] == ["", "Copper", "Aluminium"]
    extension.ops.object.mode_set(mode="OBJECT")


# Changed in place


def test_apply_with_another_estimator_changes_the_material_in_place(extension):
    """No second material: what the artist made of it stays. Another preset is another material."""
    run(extension, "apply")
    made = extension.context.object.active_material
    material.parameter_sockets(made)["m"].default_value = 0.4
    extension.context.scene.vgroove.estimator = "mirror"
    assert run(extension, "apply") == {"FINISHED"}
    assert extension.context.object.active_material == made
    assert material.origin_of(made).estimator == "mirror"
    assert material.parameter_sockets(made)["m"].default_value == pytest.approx(0.4)
    extension.context.scene.vgroove.preset = "lecture/aluminium"
    run(extension, "apply")
    assert [one.name for one in extension.data.materials if material.is_ours(one)] == ["Aluminium", "Copper"]


def test_update_rebuilds_materials_whatever_preset_is_chosen(extension):
    """By the panel's estimator, for the scene's lights; as one step."""
    run(extension, "apply")
    name = extension.context.object.active_material.name
    extension.context.scene.vgroove.preset, extension.context.scene.vgroove.estimator = "lecture/water", "corrected"
    with headless.quiet():
        extension.ops.ed.undo_push(message="before")
        assert extension.ops.vgroove.update() == {"FINISHED"}
        extension.ops.ed.undo_push(message="after")
        assert material.origin_of(extension.data.materials[name]).estimator == "corrected"
        assert roles.nodes(extension.data.materials[name], roles.LIGHT)
        extension.ops.ed.undo()
    assert material.origin_of(extension.data.materials[name]).estimator == "closure"
    extension.context.scene.vgroove.preset, extension.context.scene.vgroove.estimator = "glasses/window", "mirror"
    run(extension, "apply")
    extension.context.scene.vgroove.estimator = "corrected"
    with pytest.raises(RuntimeError, match='has no estimator "corrected"'):
        run(extension, "update")


# Courses that an artist cut


@pytest.fixture
def rusting(extension):
    """The cube with rusting iron, by curves or by Age."""

    def apply(driving):
        extension.context.scene.vgroove.preset = "time_varying/rusting_iron"
        extension.context.scene.vgroove_course.driving = driving
        run(extension, "apply")
        return extension.context.object.active_material

    return apply


@pytest.mark.parametrize("interpolation", ["LINEAR", "BEZIER"])
def test_a_course_of_one_key_stands_still(extension, own_folder, rusting, interpolation):
    """Saved, it is a preset that does not change."""
    made = rusting("curves")
    for curve in material.curves(made):
        while len(curve.keyframe_points) > 1:
            curve.keyframe_points.remove(curve.keyframe_points[-1])
        curve.keyframe_points[0].interpolation = interpolation
    assert run(extension, "save_preset", name=f"One {interpolation}") == {"FINISHED"}
    kept = presets.find(f"mine/one_{interpolation.lower()}")
    assert kept.time is None
    assert kept.m == pytest.approx(0.0645)


@pytest.mark.parametrize("left", [0, 1])
@pytest.mark.parametrize("interpolation", ["LINEAR", "BEZIER"])
def test_an_age_of_one_key_is_baked(extension, rusting, left, interpolation):
    """Or of none: the inputs stand still then."""
    made = rusting("age")
    (curve,) = material.curves(made)
    while len(curve.keyframe_points) > left:
        curve.keyframe_points.remove(curve.keyframe_points[-1])
    for point in curve.keyframe_points:
        point.interpolation = interpolation
    assert run(extension, "course_bake") == {"FINISHED"}
    assert material.origin_of(made).preset.m == pytest.approx(0.0645, rel=1e-5)


def test_what_was_taken_out_of_a_trajectory_is_refused_in_words(extension, rusting, own_folder):
    """A ramp, the group, the whole node: polls answer, and Remove and Reset still work."""
    for what in ("ramp", "script's text", "output", "group", "node"):
        made = rusting("age")
        node = course.trajectory_node(made)
        if what in {"ramp", "script's text"}:
            sink = next(one for one in node.node_tree.nodes if one.bl_idname == "NodeGroupOutput")
            last = sink.inputs["Roughness"].links[0].from_node
            other = node.node_tree.nodes.new("ShaderNodeMath" if what == "ramp" else "ShaderNodeScript")
            where = last.inputs["Before"] if what == "ramp" else sink.inputs["Roughness"]
            node.node_tree.links.new((other.outputs or last.outputs)[0], where)
            if what != "ramp":
                node.node_tree.nodes.remove(last)
        elif what == "output":
            sink = next(one for one in node.node_tree.nodes if one.bl_idname == "NodeGroupOutput")
            node.node_tree.nodes.remove(sink)
        elif what == "group":
            extension.data.node_groups.remove(node.node_tree)
        else:
            made.node_tree.nodes.remove(node)
        whole = course.trajectory_node(made) is not None
        if whole:
            with pytest.raises(RuntimeError, match="was changed and cannot be read; remove the animation"):
                run(extension, "course_bake")
        else:
            with pytest.raises(RuntimeError, match="Select objects whose active material is driven by Age"):
                run(extension, "course_bake")
        assert run(extension, "save_preset", name=what.replace("'", "")) == {"FINISHED"}
        if whole:
            assert run(extension, "course_remove") == {"FINISHED"}
        assert run(extension, "reset") == {"FINISHED"}
        assert run(extension, "course_add") == {"FINISHED"}
        assert course.trajectory_node(made) is not None
        extension.data.materials.remove(made)


def test_a_deleted_group_is_no_obstacle(extension, rusting, own_folder):
    """Every operator answers; Reset brings it back."""
    made = rusting("curves")
    extension.data.node_groups.remove(roles.node(made, roles.MODEL).node_tree)
    for operator in ("course_add", "course_retime", "course_reverse", "course_bake", "course_remove"):
        with pytest.raises(RuntimeError):
            run(extension, operator)
    assert run(extension, "save_preset", name="Lost") == {"FINISHED"}
    assert run(extension, "reset") == {"FINISHED"}
    assert material.plays(made)


def test_retiming_without_keys_says_so(extension, rusting):
    made = rusting("curves")
    for curve in material.curves(made):
        curve.keyframe_points.clear()
    for operator in ("course_retime", "course_reverse"):
        with pytest.raises(RuntimeError, match="has no keys; add its animation first"):
            run(extension, operator)


# Files


def test_a_preset_is_exported_to_a_relative_path(extension, tmp_path, monkeypatch):
    """From the folder of the .blend, as Blender's file browser has it, and from the current one."""
    with headless.quiet():
        extension.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for path in ("//first.toml", f"..{os.sep}second.toml", "third.toml"):
        assert run(extension, "export_preset", filepath=path) == {"FINISHED"}
    assert sorted(path.name for path in tmp_path.rglob("*.toml")) == ["first.toml", "second.toml", "third.toml"]
