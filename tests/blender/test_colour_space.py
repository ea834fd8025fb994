# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials reflect the colours of their presets whatever space the file renders in, and after that changes."""

import bpy
import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import colour_space, colour_update, course, gonio, images, material, rebuild
from vgroove.addon.blender.gonio import Geometry
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.addon.library.checks import as_number
from vgroove.addon.reference import Conductor
from vgroove.headless import scene
from vgroove.nodegroups import versions

REC709 = "Linear Rec.709"
SPACES = [REC709] if not versions.since(5, 0) else [REC709, "ACEScg", "Linear Rec.2020"]  # 4.5 has no other
GIVEN = {  # M of two spaces, as published: SMPTE RP 177 from the primaries; ACES with CAT02
    "Linear Rec.2020": [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]],
    "ACEScg": [[0.6131, 0.3395, 0.0474], [0.0702, 0.9164, 0.0134], [0.0206, 0.1096, 0.8698]],
}
CONDUCTORS = [preset for preset in presets.shipped().values() if preset.kind == "conductor"]
METALS = list({(*one.parameters["n"], *one.parameters["k"]): one for one in CONDUCTORS}.values())  # once, not by finish
GLASSES = [
    preset for preset in presets.shipped().values() if any(np.atleast_1d(preset.parameters.get("absorption", 0)))
]


def matrix(space):
    M = np.array(GIVEN[space])
    return M / M.sum(axis=1, keepdims=True)


def switch(space, **how):
    if versions.since(5, 0):
        with headless.quiet():
            bpy.ops.wm.set_working_color_space(working_space=space, **how)


# The numbers


@pytest.mark.blender
@pytest.mark.parametrize("space", SPACES)
def test_the_matrix_is_that_of_the_space(blender, space):
    """Rec.709 is left alone to the bit; the others are as published, to the published digits."""
    assert (colour_space.matrix() == np.eye(3)).all()
    switch(space)
    if space == REC709:
        assert (colour_space.matrix() == np.eye(3)).all()
    else:
        np.testing.assert_allclose(colour_space.matrix(), GIVEN[space], atol=1.5e-4)


@pytest.mark.parametrize("space", GIVEN)
def test_what_goes_there_comes_back(space):
    """To within what the conversion solves for; what a conductor reflects, as k near 0 hardly counts."""
    M, at = matrix(space), np.array([1.0, colour_space.EDGE])
    for preset in [*presets.shipped().values()][::5]:
        there = colour_space.to_space(preset.parameters, M)
        back = colour_space.from_space(there, M)
        if preset.kind == "conductor":
            new = Conductor(back["n"], back["k"])
            np.testing.assert_allclose(new(at), preset.reference_fresnel()(at), atol=2e-4, err_msg=preset.id)
        for name in (name for name in there if name not in {"absorption", "n", "k"}):
            np.testing.assert_allclose(back[name], preset.parameters[name], rtol=1e-6, atol=1e-9, err_msg=preset.id)
        for name, value in there.items():
            as_number(preset.id, name, value)  # stays what a preset may hold


@pytest.mark.parametrize("space", GIVEN)
def test_grey_stays_grey(space):
    """To the bit: coupled sums and plastics ask for equal channels."""
    M = matrix(space)
    grey = {"f0": (0.04, 0.04, 0.04), "albedo": (0.1, 0.1, 0.1), "n": (1.5,) * 3, "k": (0.2,) * 3, "m": 0.3}
    assert colour_space.to_space(grey, M) == colour_space.from_space(grey, M) == grey


@pytest.mark.parametrize("space", GIVEN)
def test_f82_is_converted_exactly(space):
    """F of the converted numbers is M F at every angle."""
    M, cosine = matrix(space), np.linspace(0.0, 1.0, 101)
    for preset in presets.shipped().values():
        if preset.kind == "f82" and preset.model == "cook_torrance":
            F = preset.reference_fresnel()(cosine) @ M.T
            there = preset.with_parameters(**_held(colour_space.to_space(preset.parameters, M)))
            np.testing.assert_allclose(there.reference_fresnel()(cosine), F, atol=1e-12, err_msg=preset.id)


def _held(values):
    return {name: value for name, value in values.items() if name in {"f0", "f82_tint"}}


@pytest.mark.parametrize("space", GIVEN)
def test_conductors_are_converted_within_the_stated_error(space):
    """Exact head-on, at 82 degrees to 1e-4 where k is 0; between at most 0.008, in the median at most 0.0006."""
    M, cosine = matrix(space), np.linspace(0.0, 1.0, 201)
    worst = []
    for preset in METALS:
        there = colour_space.to_space(preset.parameters, M)
        new = Conductor(there["n"], there["k"])
        at = np.array([1.0, colour_space.EDGE])
        miss = np.abs(new(at) - preset.reference_fresnel()(at) @ M.T)
        assert miss[0].max() < 1e-9
        assert miss[1].max() < 1e-4
        worst.append(np.abs(new(cosine) - preset.reference_fresnel()(cosine) @ M.T).max())
    assert len(worst) > 100
    assert max(worst) < 0.0081
    assert np.median(worst) < 0.0006


@pytest.mark.parametrize("space", GIVEN)
def test_absorption_is_converted_within_the_stated_error(space):
    """Over all depths until the clearest channel that absorbs has lost 95 %."""
    M, worst = matrix(space), []
    for preset in GLASSES:
        a = np.array(preset.parameters["absorption"])
        depth = np.geomspace(1e-3 / a.max(), 3.0 / a[a > 0].min(), 2000)[:, None]
        there = np.array(colour_space.to_space(preset.parameters, M)["absorption"])
        worst.append(np.abs(np.exp(-there * depth) - np.exp(-a * depth) @ M.T).max())
    assert len(worst) > 30
    assert max(worst) < 0.251
    assert np.median(worst) < 0.036


# In Cycles

MODELS = {  # preset, and how far a value may be from that in Rec.709, over the greatest
    "metals/copper": 0.0081,  # its n and k, as above
    "metals_schlick/copper_schlick": 2e-5,  # exact; float32 colours, and Blender's own matrices, round at 1e-6
    # Oren-Nayar's interreflection is at most 0.17 albedo^2 / pi, and M albedo^2 - (M albedo)^2 at most a quarter of the
    # square of the channels' spread, 0.28: 0.0011 of 0.17
    "diffuse/clay": 6.5e-3,
    "car_paints/blue": 1e-3,  # such a base, of spread 0.1, below lobes of 0.3
    "lecture/copper": 2e-5,
}


def measured(made, *, osl=False):
    """f of a material, in linear Rec.709; of Cycles' own closures without noise."""
    return gonio.measure(made, Geometry(40.0, resolution=(8, 8)), shading_osl=osl)


def told(made):
    """What the material says that it is, as numbers."""
    return {name: np.asarray(value) for name, value in material.origin_of(made).preset.parameters.items()}


def assert_is(made, preset):
    """Its numbers are the preset's and nobody changed them."""
    for name, value in preset.parameters.items():
        np.testing.assert_allclose(told(made)[name], value, rtol=1e-6, atol=1e-9, err_msg=name)
    assert not material.is_edited(made)
    assert not colour_space.is_stale(made)


@pytest.fixture
def followed(blender):
    """Blender with the handlers of the extension."""
    colour_update.register()
    yield blender
    colour_update.unregister()


@pytest.mark.blender
@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("backend", material.BACKENDS)
@pytest.mark.parametrize("space", SPACES)
def test_a_material_is_the_same_in_every_space(followed, space, backend, name):
    """Built there, and built before the file was changed to it, it reflects what it does in a Rec.709 file."""
    preset, choice, osl = presets.find(name), Choice(backend, "closure"), backend == "osl"
    before = build(preset, choice)
    expected = measured(before, osl=osl)
    solid = np.array(before.diffuse_color)[:3]
    switch(space)
    allowed = MODELS[name] * expected.max()
    np.testing.assert_allclose(measured(before, osl=osl), expected, atol=allowed)
    assert_is(before, preset)
    assert build(preset, choice) == before
    bpy.data.materials.remove(before)
    after = build(preset, choice)
    np.testing.assert_allclose(measured(after, osl=osl), expected, atol=allowed)
    np.testing.assert_allclose(np.array(after.diffuse_color)[:3], colour_space.matrix() @ solid, atol=1e-6)
    assert_is(after, preset)


@pytest.mark.blender
@pytest.mark.parametrize("name", ["metals/copper", "metals_schlick/copper_schlick", "diffuse/clay"])
@pytest.mark.parametrize("space", SPACES)
def test_a_furnace_is_the_same_in_every_space(blender, space, name):
    """The directional albedo, by fit: within the model's share and the noise of 256 samples."""
    preset = presets.find(name)

    def furnace(seed):
        geometry = Geometry(furnace=True, resolution=(8, 4))
        return gonio.measure(build(preset, Choice("nodes", "fit")), geometry, samples=256, seed=seed, shading_osl=False)

    here = np.array([furnace(seed) for seed in range(4)]).mean(axis=1)  # over azimuths too
    switch(space)
    there = np.array([furnace(seed) for seed in range(4)]).mean(axis=1)
    noise = np.sqrt((here.var(axis=0, ddof=1) + there.var(axis=0, ddof=1)) / 4)
    # Student's t of 6 degrees of freedom exceeds 8 in 2e-4 of channels; 96 of them in all rows
    assert (np.abs(here.mean(axis=0) - there.mean(axis=0)) < MODELS[name] + 8.0 * noise + 1e-6).all()


@pytest.mark.blender
@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("convert", [True, False])
def test_numbers_come_back_however_the_space_was_changed(followed, space, convert):
    """There and back, to float32, with Blender's own conversion and without; what Blender clips too."""
    made = {name: build(presets.find(name), Choice("nodes", "closure")) for name in (*MODELS, GLASSES[0].id)}
    before = {name: told(one) for name, one in made.items()}
    for there in (space, "ACEScg", "Linear Rec.2020", REC709):
        switch(there, convert_colors=convert)
        if not convert:  # of which Blender tells nobody, until something is rendered
            gonio.measure(made["metals/copper"], Geometry(resolution=(1, 1)))
        for name, one in made.items():
            assert_is(one, presets.find(name))
    for name, one in made.items():
        for key, value in before[name].items():
            np.testing.assert_allclose(told(one)[key], value, rtol=1e-7)
        assert colour_space.KEY not in one


@pytest.mark.blender
@pytest.mark.parametrize("space", SPACES)
def test_what_an_artist_changed_stays_changed(followed, space):
    """The colour that was chosen in one space is the same light in the others, and Save as My Preset writes Rec.709."""
    preset = presets.find("metals_schlick/copper_schlick")
    made = build(preset, Choice("nodes", "closure"))
    switch(space)
    chosen = np.array([0.5, 0.4, 0.3])
    material.parameter_sockets(made)["f0"].default_value = (*chosen, 1.0)
    expected = np.linalg.inv(colour_space.matrix()) @ chosen
    kept = material.to_preset(made).parameters
    np.testing.assert_allclose(kept["f0"], expected, atol=1e-6)
    assert material.is_edited(made)
    looks = measured(made)
    switch(REC709)
    np.testing.assert_allclose(told(made)["f0"], expected, atol=1e-4)  # Blender's own conversion
    np.testing.assert_allclose(told(made)["m"], preset.parameters["m"], rtol=1e-7)
    assert material.is_edited(made)
    np.testing.assert_allclose(measured(made), looks, atol=2e-4 * looks.max())
    switch(space)
    rebuild.reset(made, followed.context.scene)
    assert_is(made, preset)


@pytest.mark.blender
@pytest.mark.parametrize("space", SPACES)
def test_an_index_that_an_artist_changed_is_read_back(followed, space):
    """n and k are no colours for Blender, so nothing but the extension converts them."""
    made = build(presets.find("metals/copper"), Choice("nodes", "closure"))
    sockets = material.parameter_sockets(made)
    sockets["n"].default_value, sockets["k"].default_value = (0.3, 0.7, 1.1), (4.0, 2.7, 2.4)
    switch(space)
    np.testing.assert_allclose(told(made)["n"], (0.3, 0.7, 1.1), rtol=1e-4)
    np.testing.assert_allclose(told(made)["k"], (4.0, 2.7, 2.4), rtol=1e-4)
    assert material.is_edited(made)


@pytest.mark.blender
@pytest.mark.parametrize(("there", "here"), [(a, b) for a in SPACES for b in SPACES])
def test_a_material_of_another_file_is_right(followed, tmp_path, there, here):
    """Appended, it is brought to this file's space; linked, it is named, as it cannot be changed."""
    preset = presets.find("metals/copper")
    switch(there)
    build(preset, Choice("nodes", "closure")).use_fake_user = True
    path = tmp_path / "other.blend"
    with headless.quiet():
        followed.ops.wm.save_as_mainfile(filepath=str(path))
        followed.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    switch(here)
    for link in (False, True):
        with followed.data.libraries.load(str(path), link=link) as (inside, wanted):
            wanted.materials = inside.materials
    appended, linked = sorted(followed.data.materials, key=lambda one: one.library is not None)
    assert_is(appended, preset)
    assert colour_update.stale() == ([linked] if there != here else [])


@pytest.mark.blender
@pytest.mark.parametrize("space", SPACES)
def test_a_file_of_older_versions_is_mended_when_opened(blender, tmp_path, space):
    """They wrote Rec.709's numbers into every file; the command line has no extension that would follow."""
    preset = presets.find("metals/copper")
    made = build(preset, Choice("nodes", "closure"))
    made.use_fake_user = True
    switch(space, convert_colors=False)
    path = tmp_path / "old.blend"
    with headless.quiet():
        blender.ops.wm.save_as_mainfile(filepath=str(path))
        scene.open_file(path)
    (made,) = blender.data.materials
    assert_is(made, preset)
    (node,) = (node for node in made.node_tree.nodes if node.bl_idname == "ShaderNodeGroup")
    there = colour_space.to_space(preset.parameters, colour_space.matrix())
    np.testing.assert_allclose(node.inputs["IOR"].default_value, there["n"], rtol=1e-6)


# Courses


@pytest.mark.blender
@pytest.mark.parametrize("driving", course.DRIVINGS)
@pytest.mark.parametrize("name", ["time_varying/heat_tinted_steel", "time_varying/silver_tarnish"])
@pytest.mark.parametrize("space", SPACES)
def test_a_course_is_right_in_every_space(followed, space, name, driving):
    """Blender converts no F-curve; the colours halfway are the preset's, and the course counts as nobody's edit."""
    preset = presets.find(name)
    play = course.Play(driving=driving, length=100.0)
    made = build(preset, Choice("nodes", "closure", play=play))
    time = preset.time.start + 0.4 * (preset.time.end - preset.time.start)
    expected = measured(build(preset.at(time), Choice("nodes", "closure")))
    for there in (space, REC709):
        switch(there)
        assert not material.is_edited(made)
        followed.context.scene.frame_set(41)
        # Keys miss a law by a thousandth of its range, in F0 and in F82 both.
        np.testing.assert_allclose(measured(made), expected, atol=3e-3 * expected.max())
        for key, value in material.to_preset(made).parameters.items():
            np.testing.assert_allclose(value, preset.parameters[key], rtol=1e-6, err_msg=key)


@pytest.mark.blender
@pytest.mark.parametrize("driving", course.DRIVINGS)
@pytest.mark.parametrize("space", SPACES)
def test_a_course_that_an_artist_changed_is_converted(followed, space, driving):
    """As it plays, not as the preset has it."""
    preset = presets.find("time_varying/heat_tinted_steel")
    play = course.Play(driving=driving, length=100.0)
    made = build(preset, Choice("nodes", "closure", play=play))
    if driving == "curves":
        moving = material.curves(made)
        paths = {material.parameter_sockets(made)["f0"].path_from_id("default_value")}
        for curve in (curve for curve in moving if curve.data_path in paths):
            for point in curve.keyframe_points:
                point.co.y *= 0.5
    else:
        inside = course.trajectory_node(made).node_tree
        for node in inside.nodes:
            if "After" in node.inputs:
                node.inputs["After"].default_value = [0.5 * of for of in node.inputs["After"].default_value]
    followed.context.scene.frame_set(41)
    expected = measured(made)
    switch(space)
    followed.context.scene.frame_set(41)
    assert material.is_edited(made)
    np.testing.assert_allclose(measured(made), expected, atol=3e-3 * expected.max())


# What the extension reads and writes beside materials


@pytest.mark.blender
@pytest.mark.parametrize("space", SPACES)
def test_groups_hold_no_colours_of_their_own(blender, space):
    """Blender converts colours within groups too: none that stands for anything but a grey may be there."""
    for preset in [*presets.shipped().values()][::40]:
        for estimator in material.BUILDERS[preset.model]:
            build(preset, Choice("nodes", estimator))
    for group in blender.data.node_groups:
        for node in group.nodes:
            for socket in node.inputs:
                if socket.type == "RGBA" and socket.enabled and not socket.is_linked:
                    assert len(set(socket.default_value[:3])) == 1, (group.name, node.name, socket.name)


@pytest.mark.blender
@pytest.mark.parametrize("space", SPACES)
def test_pictures_state_their_space(blender, tmp_path, space):
    """An EXR that is written here reads back as the light that it was."""
    switch(space)
    path = tmp_path / "picture.exr"
    picture = np.full((2, 2, 3), (0.7, 0.5, 0.25), np.float32)
    images.save(path, picture, blender.context.scene, {})
    np.testing.assert_allclose(images.load(path), picture, atol=1e-6)
    with headless.quiet():
        blender.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    M = matrix(space) if space != REC709 else np.eye(3)
    np.testing.assert_allclose(images.load(path), picture @ np.linalg.inv(M).T, atol=3e-4)


@pytest.mark.blender
def test_lamps_of_another_temperature_are_in_the_working_space(blender):
    """What drivers of bound lamps read: both of a lamp's colours are in the file's space already."""
    lamp = blender.data.lights.new("Lamp", "SUN")
    lamp.color, lamp.use_temperature, lamp.temperature = (0.9, 0.5, 0.2), True, 3000.0
    color, warm = np.array(lamp.color), np.array(lamp.temperature_color)
    for space in SPACES:
        switch(space)
        M = colour_space.matrix()
        np.testing.assert_allclose(np.array(lamp.color), M @ color, atol=1e-5)
        np.testing.assert_allclose(np.array(lamp.temperature_color), M @ warm, atol=1e-4)
