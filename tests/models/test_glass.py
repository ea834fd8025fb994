# SPDX-License-Identifier: GPL-3.0-or-later
"""Glass in Cycles against NumPy: every row passes, and turns red on deliberate errors."""

from functools import partial

import numpy as np
import pytest
from scipy import stats

from vgroove import headless, nodegroups
from vgroove.addon.blender import gonio, material
from vgroove.addon.library.presets import parse
from vgroove.addon.models import MODELS
from vgroove.addon.reference import fresnel_dielectric
from vgroove.addon.reference.glass import pane
from vgroove.lab.check.glass import NOISY_ROWS, SLOPES, furnace_row, measure_probe, plan, probe, sun_row
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.nodegroups import glass, glass_closure, glass_mirror, osl_script, random_numbers

from ..rows import name

pytestmark = pytest.mark.blender

NODES, OSL = SETUPS[0], SETUPS[2]
BOTH = pytest.mark.parametrize("setup", [NODES, OSL], ids=str)


@pytest.mark.parametrize("row", plan(), ids=name)
def test_glass_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row passes, and is red against a reference 1 % brighter or darker."""
    row = row()
    assert row.passed, row.as_json()
    assert not row.scaled(1.01).passed
    assert not row.scaled(1 / 1.01).passed
    assert not row.is_noisy or row.resolves <= surely_seen(0.01, NOISY_ROWS)  # red on any machine's noise


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    noisy = {furnace_row, sun_row}
    assert sum(row.func in noisy for row in plan()) == NOISY_ROWS


def test_a_window_is_around_the_refracted_ray():
    """Light from below leaves where Snell's law says; total reflection has no such direction."""
    geometry = gonio.Geometry(160.0, 5.0, resolution=(65, 65), eta=1.5)
    sine = 1.5 * np.sin(np.radians(160.0))
    np.testing.assert_allclose(geometry.wo()[32, 32], [-sine, 0.0, np.sqrt(1 - sine**2)], atol=1e-12)
    with pytest.raises(ValueError, match="reflected totally"):
        gonio.Geometry(120.0, 5.0, eta=1.5).wo()


# --- deliberate errors ----------------------------------------------------------------------------------------------


def mutated(old, new):
    original = osl_script.source

    def source(shader):
        text = original(shader)
        assert shader == "gonio_camera" or old in text
        return text.replace(old, new)

    return source


def scaled(function):
    return lambda *arguments, **more: function(*arguments, **more) * 0.99


@pytest.mark.once
@pytest.mark.parametrize("m", SLOPES)
@BOTH
def test_one_percent_in_the_shadow_of_what_is_refracted_turns_the_furnace_red(blender, monkeypatch, setup, m):
    """G2t, in the node group and in OSL."""
    monkeypatch.setattr(glass_mirror, "_share_below", scaled(glass_mirror._share_below))
    monkeypatch.setattr(osl_script, "source", mutated("return max(0, G1 - (1 -", "return 0.99 * max(0, G1 - (1 -"))
    assert not furnace_row(setup, 1.5, m, "all").passed


@pytest.mark.once
@pytest.mark.parametrize("m", SLOPES)
@BOTH
def test_one_percent_in_the_weight_of_the_mirror_turns_the_furnace_red(blender, monkeypatch, setup, m):
    """F G2/G1, where most of the light is reflected: inside diamond."""
    split = glass.split
    monkeypatch.setattr(glass, "split", lambda tree, h, R, *rest, **more: split(tree, h, R * 0.99, *rest, **more))
    monkeypatch.setattr(osl_script, "source", mutated("BSDF = F * (G2 / G1)", "BSDF = 0.99 * F * (G2 / G1)"))
    assert not furnace_row(setup, 1.0 / 2.42, m, "all").passed


@pytest.mark.once
@pytest.mark.parametrize("m", SLOPES)
@BOTH
def test_a_constant_in_place_of_the_hash_turns_the_furnace_red(blender, monkeypatch, setup, m):
    """One facet for all samples."""
    monkeypatch.setattr(random_numbers, "build", frozen)
    monkeypatch.setattr(osl_script, "source", mutated('return noise("hash", P, w)', "return 0.37"))
    assert not furnace_row(setup, 1.5, m, "all").passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
@BOTH
def test_the_index_of_the_wrong_side_turns_every_view_from_inside_red(blender, monkeypatch, setup):
    """Backfacing not asked for."""
    monkeypatch.setattr(glass, "index_ahead", lambda _tree, eta: eta)
    monkeypatch.setattr(osl_script, "source", mutated("backfacing()", "0"))
    assert not furnace_row(setup, 1.5, 0.3, "all", inside=True).passed
    assert not furnace_row(setup, 1.5, 0.3, "below", inside=True).passed


# --- m = 0 ----------------------------------------------------------------------------------------------------------


@BOTH
def test_smooth_glass_reflects_all_light_beyond_the_critical_angle(instrument, setup):
    """From inside, pixel by pixel: nothing passes beyond asin(1/1.5), and all comes back."""
    beyond = np.degrees(np.arccos(gonio.Geometry(resolution=(32, 32)).wo()[..., 2])) > np.degrees(np.arcsin(1 / 1.5))
    for lit, expected in (("below", 0.0), ("above", 1.0)):
        geometry = gonio.Geometry(furnace=True, lit=lit, inside=True, resolution=(32, 32))
        image = measure_probe(probe(setup, "mirror", 1.5, 0.0), setup, geometry, 16)
        np.testing.assert_allclose(image[beyond], expected, atol=2e-7)
        assert 0.0 < image[~beyond].mean() < 1.0


@pytest.mark.parametrize("estimator", ["closure", "mirror"])
@pytest.mark.parametrize("thin", [False, True])
@BOTH
def test_tint_colours_what_passes_alone(instrument, setup, estimator, thin):
    """Smooth, in a white world: F + tint (1 - F), each sample F/p or tint (1 - F)/(1 - p) by Cycles' choice."""
    tint, samples = np.array([0.2, 0.5, 1.0]), 1024
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32))
    made = probe(setup, estimator, 1.5, 0.0, thin=thin, tint=tuple(tint))
    image = measure_probe(made, setup, geometry, samples)
    F = fresnel_dielectric(geometry.wo()[..., 2], 1.5)[..., None]
    R, T = (pane(F), 1 - pane(F)) if thin else (F, 1 - F)
    p = R / (R + T * tint.mean())
    variance = (R**2 / p + (tint * T) ** 2 / (1 - p) - (R + tint * T) ** 2) / samples
    z = (image - R - tint * T) / np.sqrt(variance + 1e-12)
    assert np.abs(z).max() < stats.norm.isf(0.005 / z.size)


@pytest.mark.parametrize("m", [0.1, 0.6])
def test_osl_closure_keeps_reflection_white(instrument, m):
    """Where Blender's Glass BSDF would tint it too; lit from above there is nothing but reflection."""
    for setup, tinted in ((OSL, False), (NODES, True)):
        geometry = gonio.Geometry(30.0, 5.0)
        image = measure_probe(probe(setup, "closure", 1.5, m, tint=(0.5, 1.0, 1.0)), setup, geometry, 1)
        np.testing.assert_allclose(image[..., 0], image[..., 1] * (0.5 if tinted else 1.0), rtol=1e-5)


@pytest.mark.parametrize("m", [1e-4, 0.3, 10.0])
@pytest.mark.parametrize("eta", [0.1, 1.0, 10.0])
@BOTH
def test_mirror_stays_finite_and_gains_nothing(instrument, setup, eta, m):
    """At the ends of every range, from both sides."""
    for inside in (False, True):
        for thin in (False, True):
            geometry = gonio.Geometry(furnace=True, resolution=(16, 16), inside=inside)
            made = probe(setup, "mirror", eta, m, thin=thin)
            image = measure_probe(made, setup, geometry, 16)
            assert np.isfinite(image).all()
            assert image.min() >= 0.0
            assert image.max() <= 1.0 + 1e-5


# --- what artists see -----------------------------------------------------------------------------------------------


def groups():
    for module in (glass_closure, glass_mirror):
        for thin in (False, True):
            for smooth in (False, True):
                yield [
                    nodegroups.ensure(
                        f"{module.NAME} {build.__name__}", 10 * thin + smooth, partial(build, thin=thin, smooth=smooth)
                    )
                    for build in (module.build, module.build_osl)
                ]


def test_glass_groups_explain_their_inputs_and_are_alike(blender):
    """Both backends show the same sockets, each with a tooltip, each number with a range; nodes lie in columns."""
    for pair in groups():
        sockets = [[item for item in group.interface.items_tree if item.item_type == "SOCKET"] for group in pair]
        looks = [[(i.name, i.socket_type, i.in_out, i.description) for i in items] for items in sockets]
        assert looks[0] == looks[1]
        for item in sockets[0]:
            assert item.description
            if item.in_out == "INPUT" and item.socket_type == "NodeSocketFloat":
                assert item.min_value <= item.default_value <= item.max_value < float("inf")
        for group in pair:
            places = [tuple(node.location) for node in group.nodes if node.bl_idname != "NodeFrame"]
            assert len(places) == len(set(places))


@pytest.mark.parametrize("module", [glass_closure, glass_mirror])
def test_glass_shaders_have_the_groups_ranges_and_defaults(blender, module, tmp_path):
    """By Cycles' own compiler."""
    import _cycles
    import oslquery

    shader = module.__name__.rpartition(".")[2]
    path = tmp_path / f"{shader}.osl"
    path.write_text(osl_script.source(shader), encoding="utf-8")
    with headless.quiet():
        assert _cycles.osl_compile(str(path), str(tmp_path / f"{shader}.oso"))
    parameters = {p.name: p for p in oslquery.OSLQuery(str(tmp_path / f"{shader}.oso")).parameters}
    group = nodegroups.ensure(module.NAME, module.REVISION, module.build_osl)
    sockets = {item.name: item for item in group.interface.items_tree if item.in_out == "INPUT"}
    for key in ("eta", "m", "tint"):
        one = MODELS["glass"].parameter(key)
        found, item, of_input = parameters[key], sockets[one.label], one.scale.of_input
        metadata = {meta.name: meta.value for meta in found.metadata}
        given = np.ravel(found.value)[:3]
        np.testing.assert_allclose(of_input(np.ravel(item.default_value)[: len(given)]), given, rtol=1e-6)
        assert metadata["label"] == (one.symbol or one.label)
        if item.socket_type == "NodeSocketFloat":
            ends = [of_input(end) for end in (item.min_value, item.max_value)]
            assert [metadata["min"], metadata["max"]] == pytest.approx(ends)


AMBER = 'name = "Amber"\nmodel = "glass"\nm = 0.0\neta = 1.5\nabsorption = [0.5, 2.0, 6.0]\n[source]\ndata = "test"\n'


@pytest.mark.parametrize("backend", material.BACKENDS)
@pytest.mark.parametrize("depth", [0.1, 0.5])
def test_a_body_absorbs_by_the_way_through_it(blender, backend, depth):
    """Straight through a slab: (1 - F)^2 exp(-a d), and what is reflected inside twice, over white light."""
    with headless.quiet(), gonio.stage((8, 8), samples=16, seed=0, shading_osl=backend == "osl") as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        stage.cycles.max_bounces = stage.cycles.transmission_bounces = stage.cycles.glossy_bounces = 12
        made = material.build(parse(AMBER, "a/amber", "a/amber"), material.Choice(backend, "mirror"))
        blender.ops.mesh.primitive_cube_add(size=1.0, scale=(50.0, 50.0, depth))
        slab = blender.context.object
        blender.context.collection.objects.unlink(slab)
        stage.collection.objects.link(slab)
        slab.data.materials.append(made)
        gonio.look_down(stage, 0.1, (0.1, 0.2, 3.0))
        image = gonio.rendered(stage).astype(float).mean(axis=(0, 1))
    F, T = 0.04, np.exp(-np.array([0.5, 2.0, 6.0]) * depth)
    # All orders: reflected F + (1-F)^2 F T^2 / (1 - F^2 T^2), passed (1-F)^2 T / (1 - F^2 T^2), both of white light.
    expected = F + (1 - F) ** 2 * (F * T**2 + T) / (1 - F**2 * T**2)
    # A choice between reflection and refraction at each face leaves noise: 1024 paths, each 0 to 1 by F (1 - F).
    assert image == pytest.approx(expected, abs=4 * np.sqrt(F * (1 - F) / 1024))
    assert np.abs(image - 1.0).max() > 0.3


def test_what_absorbs_nothing_has_no_volume(blender):
    """Nor has a sheet; and an artist's absorption is read back."""
    amber = parse(AMBER, "a/amber", "a/amber")
    for preset in (amber.with_parameters(absorption=(0, 0, 0)), parse('kind = "thin"\n' + AMBER, "a/b", "a/b")):
        made = material.build(preset, material.Choice("nodes", "mirror"))
        assert not any(node.label == "Absorption" for node in made.node_tree.nodes)
    made = material.build(amber, material.Choice("nodes", "mirror"))
    node = next(node for node in made.node_tree.nodes if node.label == "Absorption")
    node.inputs[0].default_value = (1.0, 2.0, 3.0, 1.0)
    assert material.origin_of(made).preset.parameters["absorption"] == (1.0, 2.0, 3.0)
