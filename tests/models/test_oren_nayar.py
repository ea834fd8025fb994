# SPDX-License-Identifier: GPL-3.0-or-later
"""Oren-Nayar 1994 in Cycles against NumPy, and that every row turns red."""

from functools import partial

import numpy as np
import pytest

from vgroove import headless, nodegroups
from vgroove.addon.blender import gonio
from vgroove.addon.blender.material import BUILDERS
from vgroove.addon.models.oren_nayar import ALBEDO, SIGMA
from vgroove.addon.reference import oren_nayar as reference
from vgroove.addon.reference import oren_nayar_fit as reference_fit
from vgroove.addon.reference import spherical
from vgroove.lab.check.oren_nayar import (
    MIRROR_SIGMAS,
    NOISY_ROWS,
    SIGMAS,
    exact_row,
    furnace_row,
    hybrid_furnace_row,
    plan,
    preset,
)
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.lab.check.views import measure
from vgroove.nodegroups import (
    cycles_diffuse,
    oren_nayar,
    oren_nayar_closure,
    oren_nayar_corrected,
    oren_nayar_fit,
    oren_nayar_hybrid,
    osl_script,
    random_numbers,
)
from vgroove.nodegroups._tree import Value

from ..rows import name

pytestmark = pytest.mark.blender

NODES, _, OSL = SETUPS
ESTIMATORS = {module.NAME: module for module in BUILDERS["oren_nayar"].values()}
UNLAMPED = (oren_nayar_closure, oren_nayar_fit)
ROUGH = SIGMAS[1:]


@pytest.mark.parametrize("row", plan(), ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row of the plan passes, and is red against a reference 1 % brighter or darker."""
    row = row()
    assert row.passed, row.as_json()
    assert not row.scaled(1.01).passed
    assert not row.scaled(1 / 1.01).passed
    assert not row.is_noisy or row.resolves <= surely_seen(0.01, NOISY_ROWS)


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    assert sum(row.func is not exact_row for row in plan()) == NOISY_ROWS


@pytest.mark.parametrize("setup", SETUPS, ids=str)
@pytest.mark.parametrize("estimator", ["closure", "fit", "hybrid", "mirror"])
@pytest.mark.parametrize("sigma", [1e-6, 1e-4, 2e-3])
def test_facets_that_hardly_tilt_are_lamberts(instrument, sigma, estimator, setup):
    """By every estimator under a white sky, to 10 sigma^2; Cycles' own Oren-Nayar would be black in OSL."""
    of = preset("full", sigma)
    sky = gonio.Geometry(furnace=True, resolution=(8, 2))
    image = measure(of, setup, estimator, sky, 64)
    np.testing.assert_allclose(image, np.broadcast_to(of.parameters["albedo"], image.shape), rtol=1e-4)


# --- mutants ------------------------------------------------------------------------------------------------------


def with_constant(constant):
    """The BRDF's group with 1 % more in each node that holds ``constant``."""
    original = oren_nayar.build

    def build(tree, kind):
        original(tree, kind)
        found = [
            socket
            for node in tree.node_tree.nodes
            if node.bl_idname == "ShaderNodeMath"
            for socket in node.inputs
            if not socket.is_linked and socket.default_value == pytest.approx(constant, rel=1e-6)
        ]
        assert found
        for socket in found:
            socket.default_value *= 1.01

    return build


def mutated(old, new):
    """Shader texts with ``new`` in place of ``old``."""
    original = osl_script.source

    def source(shader):
        text = original(shader)
        if shader.startswith("oren_nayar"):
            assert old in text
        return text.replace(old, new)

    return source


@pytest.mark.once
@pytest.mark.parametrize("sigma", ROUGH)
@pytest.mark.parametrize(
    ("kind", "constant", "osl"),
    [
        ("full", 0.45, "0.45 * facing"),  # C2
        ("full", 0.125, "0.125 * facing"),  # C3
        ("full", 0.17, "0.17 * s2"),  # interreflection
        ("full", 0.5, "0.5 * s2"),  # C1
        ("qualitative", 0.45, "0.45 * facing"),
        ("qualitative", 0.5, "0.5 * s2"),
    ],
)
def test_one_percent_in_one_term_turns_direct_red(blender, monkeypatch, kind, constant, osl, sigma):
    """In C1, C2, C3 and the interreflection, as nodes and in OSL, at every sigma that ``direct`` claims."""
    with monkeypatch.context() as patch:
        patch.setattr(oren_nayar, "build", with_constant(constant))
        assert not exact_row("direct", NODES, kind, sigma).passed
    monkeypatch.setattr(osl_script, "source", mutated(osl, f"1.01 * {osl}"))
    assert not exact_row("direct", OSL, kind, sigma).passed


@pytest.mark.once
@pytest.mark.parametrize("kind", oren_nayar.KINDS)
@pytest.mark.parametrize("sigma", MIRROR_SIGMAS)
def test_one_percent_in_the_weight_or_a_constant_hash_turns_mirror_red(blender, monkeypatch, kind, sigma):
    """The weight 1 % smaller, then a number that does not change from sample to sample."""
    brdf = oren_nayar.brdf
    for nodes, osl in (
        ((oren_nayar, "brdf", lambda *given: brdf(*given) * 0.99), ("BSDF = M_PI", "BSDF = 0.99 * M_PI")),
        ((random_numbers, "build", frozen), ('return noise("hash", P, w)', "return 0.37")),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(*nodes)
            patch.setattr(osl_script, "source", mutated(*osl))
            assert not furnace_row(NODES, kind, sigma).passed
            assert not furnace_row(OSL, kind, sigma).passed
        for group in list(blender.data.node_groups):
            blender.data.node_groups.remove(group)


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
@pytest.mark.parametrize("sigma", ROUGH)
@pytest.mark.parametrize("kind", oren_nayar.KINDS)
def test_one_percent_in_the_tables_turns_closure_and_fit_red(blender, monkeypatch, kind, sigma):
    """k of the closure's roughness, P and W of the fit: the shaders' numbers against the reference's."""
    for estimator, field in (("closure", "roughness"), ("fit", "albedo"), ("fit", "retro")):
        if field == "roughness" and reference_fit.closure_roughness(sigma, qualitative=kind == "qualitative") == 1.0:
            continue
        table = reference_fit.table(kind)
        more = tuple(
            value * (1.01 if field != "roughness" or i == 0 else 1) for i, value in enumerate(getattr(table, field))
        )
        with monkeypatch.context() as patch:
            wrong = type(table)(**{**vars(table), field: more})
            for module in (oren_nayar_closure, oren_nayar_fit, nodegroups.oren_nayar_table):
                patch.setattr(module, "table", lambda name, of=wrong: of if name == kind else reference_fit.table(name))
            for setup in (NODES, OSL):
                assert not exact_row(estimator, setup, kind, sigma).passed
        for group in list(blender.data.node_groups):
            blender.data.node_groups.remove(group)


def one_percent_more(tree):
    """What is subtracted, 1 % too large."""
    cycles_diffuse_build(tree)
    sink = tree._output.inputs["f"]
    tree.connect(Value(tree, sink.links[0].from_socket) * 1.01, sink)


cycles_diffuse_build = cycles_diffuse.build


@pytest.mark.once
@pytest.mark.parametrize("estimator", ["corrected", "hybrid"])
@pytest.mark.parametrize("kind", oren_nayar.KINDS)
def test_one_percent_in_what_is_subtracted_turns_lamps_red(blender, monkeypatch, kind, estimator):
    """Cycles' closure as a formula, in the node group and in OSL."""
    monkeypatch.setattr(cycles_diffuse, "build", one_percent_more)
    assert not exact_row(estimator, NODES, kind, 0.6).passed
    monkeypatch.setattr(
        osl_script, "source", mutated_if_there("return c * once + again", "return 1.01 * (c * once + again)")
    )
    assert not exact_row(estimator, OSL, kind, 0.6).passed


def mutated_if_there(old, new):
    original = osl_script.source
    assert old in original("oren_nayar_correction")
    return lambda shader: original(shader).replace(old, new)


@pytest.mark.once
def test_a_constant_hash_or_a_tenth_more_of_the_random_part_turns_hybrid_red(blender, monkeypatch):
    """The mirror carries a tenth or so at this sigma: a tenth of it is 1 % of the whole."""
    with monkeypatch.context() as patch:
        patch.setattr(random_numbers, "build", frozen)
        assert not hybrid_furnace_row(NODES, "full", 1.0).passed
    for group in list(blender.data.node_groups):
        blender.data.node_groups.remove(group)
    ray = oren_nayar_hybrid.mirror.ray
    monkeypatch.setattr(oren_nayar_hybrid.mirror, "ray", lambda tree, *given: tree.weighted(ray(tree, *given), 0.9))
    assert not hybrid_furnace_row(NODES, "full", 1.0).passed


# --- the groups ---------------------------------------------------------------------------------------------------


@pytest.fixture
def f(blender, empty_material):
    """A function that renders the BRDF group for given directions, as plain nodes."""

    def value(kind, wi, wo, albedo, sigma):
        made = empty_material()
        tree = made.node_tree
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = nodegroups.ensure(f"Test {kind}", 1, partial(oren_nayar.build, kind=kind))
        for label, given in (("To Light", wi), ("To Viewer", wo), ("N", (0, 0, 1)), ("Base Color", (*albedo, 1.0))):
            node.inputs[label].default_value = given
        node.inputs["Sigma"].default_value = sigma
        emission, sink = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(node.outputs["f"], emission.inputs["Color"])
        tree.links.new(emission.outputs[0], sink.inputs["Surface"])
        with headless.quiet():
            return gonio.measure(made, gonio.Geometry(resolution=(4, 4)), shading_osl=False)[1, 1]

    return value


@pytest.mark.parametrize("kind", oren_nayar.KINDS)
def test_group_is_lambert_to_the_last_bit_without_roughness(f, kind):
    """Whatever the directions, along the normal and grazing."""
    albedo = (0.25, 0.5, 1.0)
    values = [
        f(kind, spherical(i), spherical(o, p), albedo, 0.0)
        for i, o, p in ((0.0, 0.0, 0.0), (0.7, 0.7, 3.0), (1.5, 0.3, 1.0), (1.57, 1.57, 3.1))
    ]
    assert (np.ptp(values, axis=0) == 0.0).all()
    np.testing.assert_allclose(values[0], np.array(albedo) / np.pi, rtol=2.0**-22)


@pytest.mark.parametrize("kind", oren_nayar.KINDS)
def test_group_is_right_along_the_normal_below_the_surface_and_where_the_fit_is_negative(f, kind):
    """0 / 0 of the azimuth gives no NaN; 0 for light from below; no negative value.

    A map may turn the normal away from the viewer: that is a grazing view, as by Cycles' own closures.
    """
    up, albedo, sigma = spherical(0.0), (0.25, 0.5, 1.0), 1.5
    for wi, wo in ((up, up), (up, spherical(0.8)), (spherical(0.8), up), (spherical(1.5, 0.1), spherical(1.5, 3.2))):
        wi, wo = (np.float64(np.float32(w)) for w in (wi, wo))  # noqa: PLW2901 - as sockets store them
        expected = reference(wi, wo, albedo, sigma, qualitative=kind == "qualitative")
        np.testing.assert_allclose(f(kind, wi, wo, albedo, sigma), expected, rtol=3e-6, atol=1e-6)
    assert f(kind, -up, up, albedo, sigma).tolist() == [0.0, 0.0, 0.0]
    grazing = reference(up, spherical(np.pi / 2 - 1e-6), albedo, sigma, qualitative=kind == "qualitative")
    np.testing.assert_allclose(f(kind, up, spherical(1.6), albedo, sigma), grazing, rtol=0.05)  # 1.6 is 0.03 beyond
    assert f("full", spherical(1.56), spherical(1.56, np.pi), (0.01, 0.1, 0.4), sigma).tolist() == [0.0, 0.0, 0.0]


def all_groups():
    """Every Oren-Nayar group by name; the last word says which backend."""
    made = {}
    for label, module in ESTIMATORS.items():
        for kind in oren_nayar.KINDS:
            for build in (module.build, module.build_osl):
                more = {} if module in UNLAMPED else {"lamps": 2}
                title = f"{label} {kind} {build.__name__}"
                made[title] = nodegroups.ensure(title, 1, partial(build, kind=kind, **more))
    return made


def sockets_of(group):
    return [item for item in group.interface.items_tree if item.item_type == "SOCKET"]


def test_sockets_are_the_same_in_both_backends_and_explained(blender):
    """Base Color, Roughness from 0 to 1, Normal, then lamps; each with a tooltip."""
    made = all_groups()
    for title, group in made.items():
        sockets = sockets_of(group)
        assert all(item.description for item in sockets), title
        assert [item.name for item in sockets if item.in_out == "INPUT"][:3] == ["Base Color", "Roughness", "Normal"]
        roughness = group.interface.items_tree["Roughness"]
        assert roughness.subtype == "FACTOR"
        assert (roughness.min_value, roughness.max_value) == (0.0, pytest.approx(1.0))
        if title.endswith(" build"):
            twin = sockets_of(made[f"{title}_osl"])
            assert [(i.name, i.socket_type, i.description) for i in sockets] == [
                (i.name, i.socket_type, i.description) for i in twin
            ]


def test_nodes_do_not_lie_on_top_of_each_other(blender):
    """Columns from left to right, no two nodes in one place, in the BRDF's groups as well."""
    all_groups()
    for group in blender.data.node_groups:
        places = [tuple(node.location) for node in group.nodes if node.bl_idname != "NodeFrame"]
        assert len(places) == len(set(places)), group.name
        for link in group.links:
            assert link.from_node.location_absolute.x < link.to_node.location_absolute.x, group.name


SHADERS = [module for module in ESTIMATORS.values() if module is not oren_nayar_corrected]  # which has that of fit


@pytest.mark.parametrize("module", SHADERS, ids=lambda module: module.NAME)
def test_every_shader_compiles_and_has_the_ranges_of_its_group(blender, module, tmp_path):
    """Defaults, labels and ranges of OSL parameters and group inputs agree."""
    import _cycles
    import oslquery

    shader = module.__name__.rpartition(".")[2]
    path = tmp_path / f"{shader}.osl"
    path.write_text(osl_script.source(shader), encoding="utf-8")
    with headless.quiet():
        assert _cycles.osl_compile(str(path), str(tmp_path / f"{shader}.oso"))
    parameters = {p.name: p for p in oslquery.OSLQuery(str(tmp_path / f"{shader}.oso")).parameters}
    more = {} if module in UNLAMPED else {"lamps": 0}
    group = nodegroups.ensure(shader, 1, partial(module.build_osl, kind="full", **more))
    for one, parameter in ((ALBEDO, parameters["albedo"]), (SIGMA, parameters["sigma"])):
        given, metadata = np.ravel(parameter.value)[:3], {meta.name: meta.value for meta in parameter.metadata}
        item, of_input = group.interface.items_tree[one.label], one.scale.of_input
        np.testing.assert_allclose(of_input(np.ravel(item.default_value)[: len(given)]), given, rtol=1e-6)
        assert metadata["label"] == (one.symbol or one.label)
        if one is SIGMA:
            ends = [of_input(end) for end in (item.min_value, item.max_value)]
            assert [metadata["min"], metadata["max"]] == pytest.approx(ends)
