# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles against NumPy: the whole plan of ``vgroove check``, and that it turns red."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.reference import Schlick, cook_torrance
from vgroove.lab.check import glass as check_glass
from vgroove.lab.check import hybrid as check_hybrid
from vgroove.lab.check import oren_nayar as check_oren_nayar
from vgroove.lab.check import rows as check
from vgroove.nodegroups import beckmann_d, osl_script, random_numbers, vgroove_g
from vgroove.nodegroups._tree import Value

pytestmark = pytest.mark.blender


def name(item):
    measure, arguments = item
    return f"{measure.__name__}-{'-'.join(str(part).replace(' ', '_') for part in arguments)}"


@pytest.mark.parametrize("item", check.plan(), ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, item):
    """Every row of the plan passes, and is red against a reference 1 % brighter, as by an error in D or in G."""
    measure, arguments = item
    row = measure(*arguments)
    assert row.passed, row.as_json()
    approximate = row.test in {"closure", "fit"} and check.fresnel_approximation(row.setup, row.fresnel)
    if not approximate:  # there F alone is off by more than 1 %: the Schlick row of the same m holds D and G
        assert not row.scaled(1.01).passed
        assert not row.scaled(1 / 1.01).passed
        assert not row.is_noisy or row.resolves <= check.surely_seen(0.01)  # red on any machine's noise


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    noisy = [item for item in check.plan() if item[0] in {check.furnace_row, check.sun_row}]
    assert len(noisy) == check.NOISY_ROWS


def test_a_row_is_judged_by_the_size_of_its_own_plan():
    """3.3 standard errors are beyond 1 % for 4 rows (3.02), not for 32 (3.60)."""
    ones = np.ones((32, 32, 3))
    view = check.View(gonio.Geometry(), ones + 3.3 / 32, ones, variance=ones)
    assert abs(check.Row("", check.SETUPS[0], "", 0.3, [view]).scale_z - 3.3) < 0.01
    assert check.Row("", check.SETUPS[0], "", 0.3, [view]).passed
    assert not check.Row("", check.SETUPS[0], "", 0.3, [view], noisy_rows=4).passed


@pytest.mark.parametrize(
    ("module", "judged"),
    [
        (check_glass, (check_glass.furnace_row, (check.SETUPS[0], 1.5, 0.3, "all"))),
        (check_oren_nayar, (check_oren_nayar.furnace_row, (check.SETUPS[0], "full", 0.3))),
        (check_hybrid, (check_hybrid.furnace_row, (check.SETUPS[0], "schlick", 0.3))),
    ],
    ids=lambda one: getattr(one, "__name__", ""),
)
def test_rows_of_other_plans_know_theirs(instrument, module, judged):
    """One of each: the other tests of these plans hold what it resolves to the same number."""
    measure, arguments = judged
    assert measure(*arguments).noisy_rows == module.NOISY_ROWS


@pytest.mark.parametrize("m", check.MIRROR_SLOPES)
def test_mirror_resolves_one_percent_at_every_slope(instrument, m):
    """What the furnace row reports as resolved is under 1 %."""
    assert check.furnace_row(check.SETUPS[0], "white", m).resolves < 0.01


def one_percent(module, output):
    """The module's build function with 1 % more in its output."""
    original = module.build

    def build(tree):
        original(tree)
        sink = tree._output.inputs[output]
        before = Value(tree, sink.links[0].from_socket)
        tree.connect(before * 1.01, sink)

    return build


@pytest.mark.once
@pytest.mark.parametrize("m", check.DIRECT_SLOPES)
@pytest.mark.parametrize(("module", "output"), [(beckmann_d, "D"), (vgroove_g, "G")], ids=["D", "G"])
def test_an_error_of_one_percent_in_a_node_group_turns_direct_red(blender, monkeypatch, module, output, m):
    """The deliberate error is in the group itself, at every slope that ``direct`` claims."""
    monkeypatch.setattr(module, "build", one_percent(module, output))
    assert not check.direct_row(check.SETUPS[0], "schlick", m).passed


@pytest.mark.once
@pytest.mark.parametrize("m", check.DIRECT_SLOPES)
@pytest.mark.parametrize(
    ("old", "new"),
    [("return exp(", "return 1.01 * exp("), ("return min(1, 2 * nh", "return 1.01 * min(1, 2 * nh")],
    ids=["D", "G"],
)
def test_an_error_of_one_percent_in_osl_turns_direct_red(blender, monkeypatch, old, new, m):
    """The same in the shaders' shared header."""
    monkeypatch.setattr(osl_script, "source", mutated(old, new))
    assert not check.direct_row(check.SETUPS[2], "schlick", m).passed


def mutated(old, new):
    original = osl_script.source

    def source(shader):
        text = original(shader)
        if shader not in {"gonio_camera", "lamp"}:
            assert old in text
        return text.replace(old, new)

    return source


@pytest.mark.once
@pytest.mark.parametrize("m", check.MIRROR_SLOPES)
def test_a_constant_in_place_of_the_hash_turns_mirror_red(blender, monkeypatch, m):
    """A frozen random number looks like no noise at all; the Z-test sees that it is the wrong picture."""
    with monkeypatch.context() as patch:
        patch.setattr(osl_script, "source", mutated('return noise("hash", P, w)', "return 0.37"))
        assert not check.furnace_row(check.SETUPS[2], "white", m).passed
    monkeypatch.setattr(random_numbers, "build", frozen)
    assert not check.furnace_row(check.SETUPS[0], "white", m).passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
@pytest.mark.parametrize("m", check.MIRROR_SLOPES)
@pytest.mark.parametrize("setup", [check.SETUPS[0], check.SETUPS[2]], ids=str)
def test_an_error_of_one_percent_in_the_slope_or_weight_turns_mirror_red(blender, monkeypatch, setup, m):
    """G 1 % too large in the weight, in the node group and in OSL."""
    from vgroove.nodegroups import cook_torrance_mirror, fresnel

    original = fresnel.reflectance
    monkeypatch.setattr(cook_torrance_mirror.fresnel, "reflectance", lambda *arguments: original(*arguments) * 0.99)
    monkeypatch.setattr(
        osl_script, "source", mutated("(G2 / G1)", "(0.99 * G2 / G1)")
    ) if setup.backend == "osl" else None
    assert not check.furnace_row(setup, "white", m).passed


@pytest.mark.parametrize("setup", [check.SETUPS[0], check.SETUPS[2]], ids=str)
@pytest.mark.parametrize("fresnel", ["schlick", "dielectric", "conductor", "f82"])
@pytest.mark.parametrize("m", [1e-4, 1e-3, 0.3, 10.0])
@pytest.mark.parametrize("theta_i", [0.0, 89.99])
def test_direct_stays_finite_and_not_negative(instrument, setup, fresnel, m, theta_i):
    """No NaN, infinity or negative value for slopes down to 1e-4 and angles to 89.99 degrees."""
    preset = check.materials()[fresnel].with_parameters(m=m)
    for window in (0.0, 5.0):
        with headless.quiet():
            image = gonio.measure_preset(
                preset, setup.backend, "direct", gonio.Geometry(theta_i, window), shading_osl=setup.shading_osl
            )
        assert np.isfinite(image).all()
        assert image.min() >= 0.0
    assert image.max() > 0.0 or m < 0.3  # narrow lobes fit between two pixels


@pytest.mark.parametrize("estimator", ["direct", "closure", "fit"])
@pytest.mark.parametrize("fresnel", ["schlick", "dielectric", "conductor"])
@pytest.mark.parametrize("m", [0.02, 0.1, 0.3, 1.0])
def test_osl_and_node_groups_agree_with_each_other(instrument, estimator, fresnel, m):
    """Within the bars that each has toward the reference, on the hemisphere and around the mirror direction."""
    preset = check.materials()[fresnel].with_parameters(m=m)
    nodes, osl = check.SETUPS[0], check.SETUPS[2]
    off = max(check.fresnel_approximation(setup, fresnel) for setup in (nodes, osl)) if estimator != "direct" else 0.0
    bar = off or (check.direct_bar(m) if estimator == "direct" else check.closure_bar(m))
    F = Schlick(1.0) if off else preset.reference_fresnel()  # an approximate F is judged against a lobe of F = 1
    for geometry in (gonio.Geometry(45.0), gonio.Geometry(70.0, 5.0)):
        images = [check.measure(preset, setup, estimator, geometry, samples=1) for setup in (nodes, osl)]
        peak = cook_torrance(geometry.wi(), geometry.wo(), m, F).max()
        assert np.abs(images[0] - images[1]).max() <= bar * peak


def test_gonio_pixels_look_where_they_say(instrument):
    """The pixel of the mirror direction is brightest, and phi_o runs from wi's side around."""
    preset = check.materials()["schlick"].with_parameters(m=0.1)
    geometry = gonio.Geometry(45.0)
    with headless.quiet():
        image = gonio.measure_preset(preset, "nodes", "direct", geometry, shading_osl=False)
    expected = cook_torrance(geometry.wi(), geometry.wo(), 0.1, Schlick((0.95, 0.64, 0.54)))
    assert image.shape == (64, 64, 3)
    brightest = np.unravel_index(image[..., 0].argmax(), (64, 64))
    assert brightest[0] == np.unravel_index(expected[..., 0].argmax(), (64, 64))[0]
    assert brightest[1] in {31, 32}  # either side of phi_o = pi


def test_the_instrument_leaves_the_file_as_it_was(blender):
    """Measuring adds no object, material, mesh, camera, light, world or scene."""
    kinds = ("objects", "materials", "meshes", "cameras", "lights", "worlds", "scenes")
    before = [len(getattr(blender.data, kind)) for kind in kinds]
    check.direct_row(check.SETUPS[0], "schlick", 0.3)
    check.sphere_row("schlick", 0.3)
    assert [len(getattr(blender.data, kind)) for kind in kinds] == before
