# SPDX-License-Identifier: GPL-3.0-or-later
"""Clear bodies that spread colours by their Abbe number in Blender 5.3; before, the switch changes nothing."""

from math import radians, sin, tan

import colour
import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import convert, gonio, material, origin, rebuild, roles
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.addon.models.glass import ABBE
from vgroove.nodegroups import versions

from ..commands import patient as vgroove
from ..commands import read_exr

pytestmark = pytest.mark.blender

GLASS = "glasses/sf11_flint_glass"
SPREAD = Choice(estimator="mirror", disperses=True)
PIXELS, SAMPLES = 8, 256
APEX = 20.0  # degrees between a prism's faces
LINES = {"C": 0.6563, "d": 0.5876, "F": 0.4861}  # micrometres


def inside(made):
    """The kinds of nodes in the model's group, and what its Abbe number is."""
    node = roles.node(made, roles.MODEL)
    kinds = {one.bl_idname for one in node.node_tree.nodes}
    return kinds, (ABBE.label in node.inputs and node.inputs[ABBE.label].default_value)


def test_it_is_off_unless_chosen_and_kept_through_changes(blender):
    """By every quality; the record keeps it also where this Blender cannot."""
    preset = presets.find(GLASS)
    assert inside(build(preset, Choice(estimator="mirror")))[1] is False
    made = build(preset, SPREAD)
    for estimator in ("mirror", "closure", "mirror"):
        rebuild.rebuild(made, blender.context.scene, estimator=estimator)
        kinds, abbe = inside(made)
        assert origin.read(made).disperses
        assert ("ShaderNodeBsdfPrincipled" in kinds) is versions.DISPERSES
        assert abbe == (pytest.approx(preset.parameters["abbe"]) if versions.DISPERSES else False)
    assert not material.is_edited(made)
    assert build(preset, SPREAD) == made
    rebuild.rebuild(made, blender.context.scene, disperses=False)
    assert inside(made)[1] is False
    assert not origin.read(made).disperses


def test_what_has_no_abbe_number_or_no_inside_does_not_spread(blender):
    for identity in ("glasses/frosted_glass", "glasses/window", "metals/copper"):
        preset = presets.find(identity)
        made = build(preset, Choice(estimator=preset.spec.estimators[-1], disperses=True))
        assert inside(made)[1] is False
        assert not origin.read(made).disperses


def test_its_number_is_an_input_like_others(blender):
    """The preset's number where it is switched on in place; an edit outlives a rebuild, is saved and can be reset."""
    preset = presets.find(GLASS)
    made = build(preset, Choice(estimator="mirror"))
    rebuild.rebuild(made, blender.context.scene, disperses=True)
    assert ("abbe" in material.parameter_sockets(made)) is versions.DISPERSES
    if not versions.DISPERSES:
        return
    socket = material.parameter_sockets(made)["abbe"]
    assert socket.default_value == pytest.approx(preset.parameters["abbe"])
    assert not material.is_edited(made)
    socket.default_value = 10.0
    rebuild.rebuild(made, blender.context.scene, estimator="closure")
    assert material.is_edited(made)
    assert inside(made)[1] == 10.0
    assert material.to_preset(made).parameters["abbe"] == 10.0
    rebuild.reset(made, blender.context.scene)
    assert inside(made)[1] == pytest.approx(preset.parameters["abbe"])


def test_switched_off_it_renders_as_if_never_switched_on(blender):
    """Bit for bit, and other than while it was on."""
    preset = presets.find(GLASS)
    before = _seen_through_a_prism(blender, build(preset, Choice(estimator="mirror")), osl=False, of_x=1.0)
    made = build(preset.with_parameters(abbe=30.0), SPREAD)
    on = _seen_through_a_prism(blender, made, osl=False, of_x=1.0)
    rebuild.rebuild(made, blender.context.scene, disperses=False)
    off = _seen_through_a_prism(blender, made, osl=False, of_x=1.0)
    assert before.tolist() == off.tolist()
    assert (on.tolist() == off.tolist()) is not versions.DISPERSES


def test_commands_and_jobs_take_it(tmp_path):
    """The same picture by either, other than without, and other again by another number."""
    small = ("--samples", 4, "--resolution", "32x24")
    for name, more in {"off": (), "on": ("--dispersion",), "less": ("--dispersion", "--set", "abbe=90")}.items():
        assert vgroove("render", GLASS, *more, *small, "-o", tmp_path / f"{name}.exr").code == 0
    job = f'[[render]]\npreset = "{GLASS}"\ndispersion = [true, false]\nsamples = 4\nresolution = "32x24"'
    (tmp_path / "job.toml").write_text(job)
    assert vgroove("batch", tmp_path / "job.toml", "-o", tmp_path / "out").code == 0
    off, on, less = (read_exr(tmp_path / f"{name}.exr")[0] for name in ("off", "on", "less"))
    by_batch = [read_exr(path)[0] for path in (tmp_path / "out").glob("*.exr")]
    assert np.array_equal(off, on) is not versions.DISPERSES
    assert np.array_equal(on, less) is not versions.DISPERSES
    for image in (off, on):  # a batch renders in two halves, of which the mean is rounded
        assert any(np.allclose(image, one, rtol=1e-5, atol=1e-6) for one in by_batch)


def test_conversion_keeps_it(blender):
    preset = presets.find(GLASS)
    made = convert.convert(build(preset, SPREAD)).node.inputs
    names = "Transmission Dispersion Scale", "Transmission Dispersion Abbe Number"
    found = [made[name].default_value for name in names if name in made]
    assert found == (pytest.approx([1.0, preset.parameters["abbe"]]) if versions.DISPERSES else [])


def matching():
    """Wavelengths in micrometres, and the weight of each in linear Rec.709 under D65; each channel sums to 1."""
    shape = colour.SpectralShape(380, 780, 5)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    light = colour.SDS_ILLUMINANTS["D65"].copy().align(shape).values
    weights = (observer * light[:, None]) @ colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_XYZ_to_RGB.T
    return shape.wavelengths / 1e3, weights / weights.sum(axis=0)


def bent(blender, made, *, osl):
    """1 + x of the direction in which a ray leaves a prism that it meets head-on, for each channel.

    The sky shows it, and is black above, so that light which the faces mirror counts neither here nor in a white sky.
    """
    x, white = (_seen_through_a_prism(blender, made, osl=osl, of_x=of) for of in (1.0, 0.0))
    return x / white


def _seen_through_a_prism(blender, made, *, osl, of_x):
    """A sky of 1 + x below, or of 1."""
    with headless.quiet(), gonio.stage((PIXELS, PIXELS), samples=SAMPLES, seed=0, shading_osl=osl) as stage:
        tree = versions.nodes_of(stage.world)
        tree.nodes.clear()
        output, sky, place, apart, sum_, below = (
            tree.nodes.new(f"ShaderNode{kind}")
            for kind in ("OutputWorld", "Background", "TexCoord", "SeparateXYZ", "Math", "Math")
        )
        sum_.operation, below.operation = "MULTIPLY_ADD", "LESS_THAN"
        sum_.inputs[1].default_value, sum_.inputs[2].default_value = of_x, 1.0
        below.inputs[1].default_value = 0.0
        wired = [
            (place.outputs["Generated"], apart.inputs[0]), (apart.outputs["X"], sum_.inputs[0]),
            (apart.outputs["Z"], below.inputs[0]), (sum_.outputs[0], sky.inputs["Color"]),
            (below.outputs[0], sky.inputs["Strength"]), (sky.outputs[0], output.inputs[0]),
        ]  # fmt: skip
        for source, target in wired:
            tree.links.new(source, target)
        stage.world.cycles.sampling_method, stage.cycles.max_bounces = "NONE", 2  # in and out, with no detours
        mesh = blender.data.meshes.new("Prism")
        square = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
        low = [(x, y, -0.5 - tan(radians(APEX)) * (2.0 - x)) for x, y in square]
        sides = [(k, 4 + k, 4 + (k + 1) % 4, (k + 1) % 4) for k in range(4)]
        mesh.from_pydata([(x, y, 0.0) for x, y in square] + low, [], [(0, 1, 2, 3), (7, 6, 5, 4), *sides])
        mesh.materials.append(made)
        stage.collection.objects.link(blender.data.objects.new("Prism", mesh))
        gonio.look_down(stage, 0.5)
        return gonio.rendered(stage).reshape(-1, 3).mean(axis=0)


@pytest.mark.parametrize("osl", [False, True], ids=["nodes", "osl"])
def test_red_and_blue_bend_by_snell_s_law_for_their_index(blender, osl):
    """A channel sees the mean over its matching function, of which the expectation is a sum over wavelengths.

    n(w) = A + B / w^2 through n_d and the Abbe number, as the renderer has it (OpenPBR 1.1.1, eqs. 55 and 56). The
    wavelengths are drawn at random: were they independent and all as likely, the standard error of the mean direction
    would be s below. Cycles draws them more evenly; four s then hold all three channels. Red and blue differ by 40 s.
    """
    preset = presets.find(GLASS).with_parameters(absorption=(0.0, 0.0, 0.0))
    eta, backend = preset.parameters["eta"], "osl" if osl else "nodes"
    wavelengths, weights = matching()
    B = versions.DISPERSES * (eta - 1.0) / preset.parameters["abbe"] / (LINES["F"] ** -2 - LINES["C"] ** -2)
    x = _leaves(eta + B * (wavelengths**-2.0 - LINES["d"] ** -2))
    expected = x @ weights
    s = np.sqrt(np.mean((weights * weights.shape[0] * (x[:, None] - expected)) ** 2, axis=0) / (PIXELS**2 * SAMPLES))
    measured = bent(blender, build(preset, Choice(backend, "mirror", disperses=True)), osl=osl)
    assert np.all(np.abs(measured - expected) <= 4.0 * s + 1e-5 * expected)  # where nothing is drawn, float32's
    assert bool(expected[0] - expected[2] > max(40.0 * s.max(), 1e-9)) is versions.DISPERSES
    np.testing.assert_allclose(
        bent(blender, build(preset, Choice(backend, "mirror")), osl=osl), _leaves(eta), rtol=1e-5
    )


def _leaves(n):
    """1 + x of the direction, by Snell's law."""
    return 1.0 - np.sin(np.arcsin(n * sin(radians(APEX))) - radians(APEX))


@pytest.mark.parametrize("m", [0.0, 1e-4])
def test_as_much_passes_as_without(blender, m):
    """The same share of light, tinted at both surfaces.

    Either share p is a mean of trials, each with a standard error of sqrt(p (1 - p) / N) at most; the drawn wavelengths
    add one of their weights.
    """
    preset = presets.find(GLASS).with_parameters(absorption=(0.0,) * 3, tint=(0.8, 0.5, 0.3), m=m)
    plain, spread = (
        _seen_through_a_prism(blender, build(preset, Choice(estimator="closure", disperses=of)), osl=False, of_x=0.0)
        for of in (False, True)
    )
    count, (_, weights) = PIXELS**2 * SAMPLES, matching()
    s = np.hypot(0.5, np.sqrt(np.mean((weights * weights.shape[0] - 1.0) ** 2, axis=0))) / np.sqrt(count)
    assert np.all(np.abs(spread / plain - 1.0) < 4.0 * np.sqrt(2.0) * s)
