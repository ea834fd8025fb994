# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that change over time, by the panel's settings and buttons."""

import pytest

from vgroove import headless
from vgroove.addon.blender import material
from vgroove.addon.blender.inputs import value_of

from .panel import Recorder

pytestmark = pytest.mark.blender


@pytest.fixture
def rusting(extension):
    """The cube with rusting iron, played by what the panel has."""
    stage = extension.context.scene
    stage.vgroove.preset, stage.vgroove.estimator = "time_varying/rusting_iron", "fit"

    def apply(**settings):
        for name, value in settings.items():
            setattr(stage.vgroove_course, name, value)
        with headless.quiet():
            assert extension.ops.vgroove.apply() == {"FINISHED"}
        return extension.context.object.active_material

    return apply


def slope(extension, made, frame):
    extension.context.scene.frame_set(frame)
    return value_of("m", material.parameter_sockets(made)["m"])


def test_apply_plays_a_preset_that_changes(extension, rusting):
    """By curves, by Age, or not at all where the panel says so."""
    from vgroove.addon.blender import course

    made = rusting(start=10.0, length=100.0)
    assert [slope(extension, made, frame) for frame in (1, 10, 110, 200)] == pytest.approx([0.0645] * 2 + [0.27153] * 2)
    assert course.trajectory_node(rusting(driving="age")) is not None
    assert not material.plays(rusting(play=False))


def test_start_and_length_are_in_seconds_or_frames(extension):
    """At the scene's own frame rate."""
    stage, settings = extension.context.scene, extension.context.scene.vgroove_course
    stage.render.fps, stage.render.fps_base = 30, 1.001
    settings.start_seconds, settings.length_seconds = 1.0, 10.0
    assert settings.start == pytest.approx(30.0 / 1.001)
    assert settings.length == pytest.approx(300.0 / 1.001)
    settings.length = 60.0
    assert settings.length_seconds == pytest.approx(2.002)


def test_courses_are_retimed_reversed_baked_removed_and_added_again(extension, rusting):
    """On every selected object at once."""
    from vgroove.addon.blender import course

    made = rusting(driving="age")
    other = extension.data.objects.new("Other", extension.data.meshes.new("Other"))
    other.data.materials.append(made.copy())
    extension.context.collection.objects.link(other)
    other.select_set(state=True)
    both = [made, other.active_material]
    ops, settings = extension.ops.vgroove, extension.context.scene.vgroove_course
    with headless.quiet():
        assert ops.course_bake() == {"FINISHED"}
        assert not any(course.trajectory_node(one) for one in both)
        settings.start, settings.length = 5.0, 10.0
        assert ops.course_retime() == {"FINISHED"}
        assert [course.span_of(material.curves(one)) for one in both] == [(5.0, 15.0)] * 2
        assert ops.course_reverse() == {"FINISHED"}
    assert [slope(extension, one, 15) for one in both] == pytest.approx([0.0645] * 2)
    with headless.quiet():
        assert ops.course_remove() == {"FINISHED"}
        assert not any(material.plays(one) for one in both)
        assert len(extension.data.actions) == 0
        assert ops.course_add() == {"FINISHED"}
    assert all(course.trajectory_node(one) for one in both)


@pytest.mark.parametrize(
    "operator", ["apply", "course_add", "course_retime", "course_reverse", "course_bake", "course_remove"]
)
def test_each_change_of_a_course_is_one_undo_step(extension, rusting, operator):
    """One Ctrl-Z, and the curves are as before."""

    made = rusting(driving="age" if operator == "course_bake" else "curves", play=operator != "course_add")

    def state():
        one = extension.data.materials[name]
        return material.state_of(one), [group.name for group in extension.data.node_groups], len(extension.data.actions)

    name = made.name
    extension.context.scene.vgroove_course.length = 33.0
    with headless.quiet():
        extension.ops.ed.undo_push(message="before")
        before = state()
        getattr(extension.ops.vgroove, operator)()
        extension.ops.ed.undo_push(message="after")
        assert operator == "apply" or state() != before
        extension.ops.ed.undo()
    assert state() == before


def test_courses_refuse_in_words(extension, rusting):
    """What has none, and a clock that comes from a texture."""
    from vgroove.addon.blender import course

    ops = extension.ops.vgroove
    with pytest.raises(RuntimeError, match="came from this panel and changes over time"):
        ops.course_reverse()
    with pytest.raises(RuntimeError, match="came from a preset that changes over time"):
        ops.course_add()
    made = rusting(driving="age")
    noise = made.node_tree.nodes.new("ShaderNodeTexNoise")
    made.node_tree.links.new(noise.outputs[0], course.trajectory_node(made).inputs["Rate"])
    with headless.quiet(), pytest.raises(RuntimeError, match="come from a texture, which no curve can follow"):
        ops.course_bake()
    assert course.trajectory_node(made) is not None


def test_the_panel_says_how_a_preset_changes(extension, rusting):
    """What changes over what time, how it is known, and how many keys it takes."""
    from types import SimpleNamespace

    from vgroove.addon.ui import course

    stage = extension.context.scene
    context = SimpleNamespace(
        scene=stage, region=SimpleNamespace(width=280), selected_objects=extension.context.selected_objects
    )
    assert course.VGROOVE_PT_course.poll(context)
    rusting(driving="age")
    layout = Recorder()
    course.VGROOVE_PT_course.draw(SimpleNamespace(layout=layout), context)
    text = " ".join(layout.texts)
    for part in ("Rusting Iron (measured) changes over its whole duration", "59 keys"):
        assert part in text
    stage.vgroove.preset = "lecture/copper"
    context.selected_objects = []
    assert not course.VGROOVE_PT_course.poll(context)


@pytest.mark.parametrize("driving", ["curves", "age"])
def test_a_course_that_was_edited_is_saved_with_the_preset(extension, own_folder, rusting, driving):
    """Its keys as they are now; one that was not keeps its laws."""
    from vgroove.addon.blender import course
    from vgroove.addon.library import presets

    made = rusting(driving=driving)
    with headless.quiet():
        extension.ops.vgroove.save_preset(name="As It Was")
    assert presets.find("mine/as_it_was").time == presets.find("time_varying/rusting_iron").time
    if driving == "curves":
        socket = material.parameter_sockets(made)["m"]
        curve = next(c for c in material.curves(made) if c.data_path == socket.path_from_id("default_value"))
        curve.keyframe_points[-1].co.y = 0.66**0.5
    else:
        group = course.trajectory_node(made).node_tree
        output = next(node for node in group.nodes if node.bl_idname == "NodeGroupOutput")
        output.inputs["Roughness"].links[0].from_node.inputs["After"].default_value = 0.66**0.5
    with headless.quiet():
        extension.ops.vgroove.save_preset(name="Edited")
    edited = presets.find("mine/edited")
    assert edited.at(1.0).m == pytest.approx(0.66)
    for time in (0.0, 0.33, 0.7):
        assert edited.at(time).m == pytest.approx(presets.find("time_varying/rusting_iron").at(time).m, rel=2e-3)
        albedo = presets.find("time_varying/rusting_iron").at(time).parameters["albedo"]
        assert edited.at(time).parameters["albedo"] == pytest.approx(albedo, abs=1e-3)
    assert edited.source["data"].startswith("edited from time_varying/rusting_iron")
