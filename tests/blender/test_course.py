# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that change: what stands still stays plain, keys stay near the law, and files and frames keep them."""

import math

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import course, fcurves, gonio, images, material, origin
from vgroove.addon.blender.course import AnimationError, Play
from vgroove.addon.blender.inputs import Converted
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library.presets import find
from vgroove.addon.models import parameter
from vgroove.addon.reference import place_keys
from vgroove.addon.reference.trajectory import Trajectory
from vgroove.headless import sequence
from vgroove.nodegroups import osl_script, ramp, trajectory

from .courses import CHANGING, EPS, SHORT, made, shown, stiff

pytestmark = pytest.mark.blender


# Materials hold what they need


def test_a_material_that_stands_still_has_nothing_of_time(blender):
    """No nodes, drivers or actions, also of a preset that could change."""
    for name in ("lecture/copper", "plastics/red_plastic", *SHORT):
        for backend in material.BACKENDS:
            with headless.quiet():
                one = build(find(name), Choice(backend, "fit"))
            assert one.node_tree.animation_data is None
            assert one.animation_data is None
            assert origin.read(one).play is None
            assert not material.plays(one)
    assert len(blender.data.actions) == 0
    names = [group.name for group in blender.data.node_groups]
    assert not any(word in name for name in names for word in (ramp.NAME, trajectory.NAME))
    assert not any("trajectory" in text.name for text in blender.data.texts)


@pytest.mark.parametrize("driving", course.DRIVINGS)
@pytest.mark.parametrize("name", CHANGING)
def test_only_what_changes_has_curves_or_is_driven(blender, name, driving):
    """F-curves of the changing parameters alone, or one of Age and links to them alone; no drivers."""
    preset = find(name)
    one = made(blender, preset, driving=driving)
    data = one.node_tree.animation_data
    assert len(data.drivers) == 0
    sockets = material.parameter_sockets(one)
    paths = {socket.path_from_id("default_value"): name for name, socket in sockets.items()}
    found = material.curves(one)
    assert len(found) == len(fcurves.channelbag(one).fcurves)
    if driving == "curves":
        assert {paths[curve.data_path] for curve in found} == set(preset.time.laws)
        assert course.trajectory_node(one) is None
    else:
        assert len(found) == 1
        assert {name for name, socket in sockets.items() if socket.is_linked} == set(preset.time.laws)


def test_each_material_is_made_once(blender):
    """Same preset, same play: the same material, also at another frame; another play, or none: another one."""
    with headless.quiet():
        first = build(find(SHORT[0]), Choice(play=Play()))
        blender.context.scene.frame_set(77)
        assert build(find(SHORT[0]), Choice(play=Play())) == first
        assert not material.is_edited(first)
        assert build(find(SHORT[0]), Choice(play=Play(length=100.0))) != first
        assert build(find(SHORT[0]), Choice()) != first
        course.retime(material.curves(first), 5.0, 50.0)
        assert material.is_edited(first)
        assert build(find(SHORT[0]), Choice(play=Play())) != first


# Keys and frames


@pytest.mark.parametrize("driving", course.DRIVINGS)
@pytest.mark.parametrize("interpolation", course.INTERPOLATIONS)
def test_keys_stay_within_the_tolerance_of_the_law(blender, driving, interpolation):
    """As Blender plays them; with handles no value leaves the parameter's own range between any two frames."""
    if driving == "age" and interpolation == "shape":
        with pytest.raises(AnimationError, match="goes straight between keys"):
            Play(driving, interpolation=interpolation)
        return
    preset = stiff()
    changes = preset.trajectory()
    # so long that the flash, 1e-5 h, lasts a frame
    one = made(blender, preset, driving=driving, interpolation=interpolation, start=1.0, length=1e6, tolerance=1e-3)
    parts = np.geomspace(1e-7, 1.0, 150), np.linspace(0.0, 1.0, 60), np.linspace(0.19, 0.21, 60)
    ages = np.unique(np.concatenate(parts))
    frames = np.float32(1.0 + ages * 1e6).astype(float)
    values = [shown(one, frame) for frame in frames]
    for name in changes.laws:
        to_input = parameter(name).scale.to_input  # the keys are those of the input, and so is their tolerance
        got = to_input(np.array([value[name] for value in values]))
        law = to_input(changes.value(name, changes.time((frames - 1.0) / 1e6)))
        reach = np.ptp(law, axis=0).max()
        # float32: a value rounds by 2^-24, and a frame by 2^-24 of itself, at the law's steepest slope there
        steep = np.abs(np.gradient(law, frames, axis=0)) * (frames * EPS)[(...,) + (None,) * (law.ndim - 1)]
        assert (np.abs(got - law) <= 1e-3 * reach + 4.0 * EPS + 2.0 * steep).all()
        whole = to_input(changes.value(name, np.concatenate([changes.laws[name].events(), changes.time(ages)])))
        assert (got >= whole.min(axis=0) - 1e-6).all()
        assert (got <= whole.max(axis=0) + 1e-6).all()


def test_transients_shorter_than_a_frame_are_kept(blender):
    """A flash of a twentieth of a frame is seen by who looks between frames."""
    one = made(blender, stiff(), start=1.0, length=5e3)  # the flash, 1e-5 h, is 1/200 frame
    before, inside, after = (float(shown(one, frame)["albedo"][0]) for frame in (1.0, 1.0 + 5e3 * 1e-6, 1.1))
    assert before == pytest.approx(0.8, abs=1e-6)
    assert inside == pytest.approx(0.45 + 0.35 * math.exp(-1.0), abs=0.01)
    assert after == pytest.approx(0.45, abs=1e-3)


def test_cycles_reads_materials_once_a_frame(blender):
    """With motion blur too: the shutter does not average what changes, whatever its position."""
    one = made(blender, find("time_varying/yellowing_paper"), estimator="closure", start=1.0, length=2.0)
    (curve, *_) = material.curves(one)
    with headless.quiet(), gonio.stage((4, 4), samples=16, seed=0, shading_osl=False) as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        gonio._patch(stage, one, gonio.Geometry())
        camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
        camera.location.z = 2.0
        stage.collection.objects.link(camera)
        stage.camera = camera
        for item in (stage, blender.context.scene):
            item.frame_set(2)
        stage.render.motion_blur_shutter = 1.0
        images = []
        for blurred, position in ((False, "CENTER"), (True, "START"), (True, "CENTER"), (True, "END")):
            stage.render.use_motion_blur, stage.render.motion_blur_position = blurred, position
            images.append(gonio.rendered(stage))
    assert curve.evaluate(1.5) != curve.evaluate(2.0)
    for image in images[1:]:
        np.testing.assert_allclose(image, images[0], rtol=1e-5)


@pytest.fixture
def flash(blender, empty_material):
    """The window's scene with a plane that glows with 1 at frame 2 and with 0 a quarter of a frame before and after."""
    one = empty_material()
    tree = one.node_tree
    glow, sink = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs[0], sink.inputs["Surface"])
    for frame, value in ((1.75, 0.0), (2.0, 1.0), (2.25, 0.0)):
        glow.inputs["Strength"].default_value = value
        glow.inputs["Strength"].keyframe_insert("default_value", frame=frame)
    for curve in fcurves.channelbag(one).fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    view = blender.context.scene
    mesh = blender.data.meshes.new("Plane")
    mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(one)
    camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
    camera.location.z = 2.0
    for item in (camera, blender.data.objects.new("Plane", mesh)):
        view.collection.objects.link(item)
    view.camera, view.render.engine, view.cycles.use_denoising = camera, "CYCLES", False
    view.view_settings.view_transform = "Standard"
    view.render.dither_intensity = 0.0
    return view


@pytest.mark.parametrize("ending", ["exr", "png"])
@pytest.mark.parametrize("shutter", [0.0, 0.5, 1.0])
def test_an_exposed_frame_sees_what_happens_within_it(flash, tmp_path, shutter, ending):
    """The mean over the shutter, here of a triangle of half a frame: 1/2 of it, and 1/4 of a whole frame."""
    path = tmp_path / f"frame.{ending}"
    flash.render.use_motion_blur = True
    with headless.quiet():
        assert not sequence.frame_to(flash, 2, path, "a note", shutter, samples=16, seed=3, resolution=(4, 4))
        assert sequence.frame_to(flash, 2, path, "a note", shutter, samples=16, seed=3, resolution=(4, 4))
    assert not sequence.is_done(path, "another note")
    assert flash.render.use_motion_blur
    # At midpoints of equal parts the mean of straight lines is exact, as the tips of the triangle lie between them.
    expected = {0.0: 1.0, 0.5: 0.5, 1.0: 0.25}[shutter]
    image = images.load(path)
    if ending == "png":
        np.testing.assert_allclose(image, images.srgb(np.float32(expected)), atol=0.5 / 255 + 1e-4)
    else:
        np.testing.assert_allclose(image, expected, rtol=1e-5)


def test_a_saved_file_plays_as_before(blender, tmp_path):
    """Keys nearer than a hundredth of a frame too, which Blender's own tools would merge."""
    paths = {}
    for driving in course.DRIVINGS:
        with headless.quiet():
            blender.ops.wm.read_factory_settings(use_empty=True)
        one = made(blender, stiff(), driving=driving, start=1.0, length=5e3)
        frames = (1.0, 1.005, 1.01, 40.5, 1000.0, 1001.0)
        before = [shown(one, frame) for frame in frames]
        paths[driving] = tmp_path / f"{driving}.blend"
        with headless.quiet():
            blender.ops.wm.save_as_mainfile(filepath=str(paths[driving]))
            blender.ops.wm.open_mainfile(filepath=str(paths[driving]))
        again = blender.data.objects["Plane"].active_material
        for frame, expected in zip(frames, before, strict=True):
            for name, value in shown(again, frame).items():
                np.testing.assert_allclose(value, expected[name], atol=1e-7)


# Bad input


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"driving": "wind"}, 'unknown driving "wind"; use one of curves, age'),
        ({"interpolation": "wavy"}, 'unknown interpolation "wavy"'),
        ({"length": 0.0}, "length must be between 1e-06 and 1e"),
        ({"length": math.nan}, "length must be between"),
        ({"start": math.inf}, "start must be between"),
        ({"tolerance": 0.0}, "tolerance must be between 1e-06 and 0.1"),
    ],
)
def test_a_play_that_does_not_hold_is_refused(given, complaint):
    with pytest.raises(AnimationError, match=complaint):
        Play(**given)


def test_a_script_that_does_not_compile_leaves_nothing_behind(blender, monkeypatch):
    """No half-made material, group or text."""
    source = osl_script.source
    monkeypatch.setattr(osl_script, "source", lambda shader, tables=None: "no" if tables else source(shader))
    with headless.quiet(), pytest.raises(osl_script.OslError):
        build(find("time_varying/yellowing_paper"), Choice("osl", "direct", play=Play("age")))
    assert not [text for text in blender.data.texts if "trajectory" in text.name]
    assert not [group for group in blender.data.node_groups if group.name.startswith(trajectory.NAME)]
    assert len(blender.data.materials) == 0


def test_keys_of_a_course_are_those_that_the_reference_places(blender):
    """By age, within the tolerance that was asked for."""
    changes = find("time_varying/drying_paint").trajectory()
    laws = {name: Converted(law, parameter(name).scale.to_input) for name, law in changes.laws.items()}
    as_inputs = Trajectory(laws, changes.start, changes.end)
    for tolerance in (1e-2, 1e-3):
        keys = course.keyframes(changes, Play(tolerance=tolerance))
        for name in changes.laws:
            direct = place_keys(as_inputs, name, tolerance)
            assert abs(keys[name].times.size - direct.times.size) <= 1
