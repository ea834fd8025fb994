# SPDX-License-Identifier: GPL-3.0-or-later
"""The microfacet generator in Cycles against NumPy, that every row turns red, and its tables [[distribution]]."""

import json
from dataclasses import asdict

import bpy
import numpy as np
import pytest

from vgroove.addon.blender import material, origin
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets, writing
from vgroove.addon.models import MODELS
from vgroove.addon.reference.facet_distribution import Distribution, Term
from vgroove.addon.reference.generator_fit import beckmann_terms, distance
from vgroove.lab.check import generator as rows
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.nodegroups import facet_density, osl_script, random_numbers
from vgroove.nodegroups._tree import Value

from ..rows import check_that_mirror_counts_lights_once, name

pytestmark = pytest.mark.blender

NODES, _, OSL = SETUPS
MODEL = MODELS["generator"]


@pytest.mark.parametrize("row", rows.plan(), ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row of the plan passes, and is red against a reference 1 % brighter or darker."""
    row = row()
    assert row.passed, row.as_json()
    assert not row.scaled(1.01).passed
    assert not row.scaled(1 / 1.01).passed
    assert not row.is_noisy or row.resolves <= surely_seen(0.01, rows.NOISY_ROWS)


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    assert sum(row.func is not rows.exact_row for row in rows.plan()) == rows.NOISY_ROWS


def test_mirror_with_lights_counts_each_once(instrument):
    for setup in (NODES, OSL):
        check_that_mirror_counts_lights_once(rows.preset("abc", 0.3), setup)


# --- mutants ------------------------------------------------------------------------------------------------------


def mutated(old, new):
    """Texts of the model's shaders with ``new`` in place of ``old``."""
    original = osl_script.source

    def source(shader, tables=None):
        text = original(shader, tables)
        if shader.startswith("generator"):
            assert old in text
            return text.replace(old, new)
        return text

    return source


def more(tree, of, original=facet_density.build):
    """D with 1 % more."""
    original(tree, of)
    sink = tree._output.inputs["D"]
    tree.connect(Value(tree, sink.links[0].from_socket) * 1.01, sink)


@pytest.mark.once
@pytest.mark.parametrize("m", rows.SLOPES)
@pytest.mark.parametrize("shape", rows.SHAPES)
def test_one_percent_in_d_turns_direct_red(blender, monkeypatch, shape, m):
    """Of every shape, as nodes and in OSL."""
    with monkeypatch.context() as patch:
        patch.setattr(facet_density, "build", more)
        assert not rows.exact_row("direct", NODES, shape, m).passed
    monkeypatch.setattr(osl_script, "source", mutated("(D * G /", "(1.01 * D * G /"))
    assert not rows.exact_row("direct", OSL, shape, m).passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
@pytest.mark.parametrize("shape", ["abc", "points"])
def test_one_percent_in_d_or_a_constant_hash_turns_mirror_red(blender, monkeypatch, shape):
    """D over what facets are drawn by is the mirror's weight; a hash that does not change draws one facet."""
    for nodes, osl in (
        ((facet_density, "build", more), ("float share = ", "float share = 1.01 * ")),
        ((random_numbers, "build", frozen), ('return noise("hash", P, w)', "return 0.37")),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(*nodes)
            patch.setattr(osl_script, "source", mutated(*osl))
            assert not rows.furnace_row(NODES, shape, 0.3).passed
            assert not rows.furnace_row(OSL, shape, 0.3).passed
        for group in list(blender.data.node_groups):
            blender.data.node_groups.remove(group)


# --- presets and groups -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", rows.SHAPES)
def test_a_distribution_is_written_read_and_recorded(blender, shape):
    """Through a file, and through the record that a material keeps of what it was built from."""
    of = rows.preset(shape, 0.3)
    assert presets.parse(writing.dumps(of), of.id, "test") == of
    made = build(of, Choice("nodes", "direct"))
    assert material.preset_of(made).distribution == of.distribution
    record = origin.read(made)
    other = rows.preset(shape, 0.2)
    assert record.builds() != origin.Record(**(vars(record) | {"preset": other})).builds()
    assert json.loads(json.dumps(asdict(record)))["preset"]["distribution"]


def test_materials_of_one_distribution_share_groups_and_images(blender):
    """And others have their own; images are packed."""
    one, same, other = (rows.preset("points", m) for m in (0.3, 0.3, 0.2))
    groups = [material.group_of(of, Choice("nodes", "mirror")) for of in (one, same, other)]
    assert groups[0] == groups[1] != groups[2]
    images = [image for image in bpy.data.images if image.name.startswith("VGroove Facet")]
    assert len(images) == 4  # bins and points of both
    assert all(image.packed_file for image in images)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("", '"distribution" is missing; add a table .*beckmann, ggx'),
        ("[[distribution]]\nabc = 1.0", r"\[\[distribution\]\]: abc needs 2 numbers"),
        ("[[distribution]]\ngxx = 0.1", 'unknown key "gxx"; did you mean "ggx"'),
        ("[[distribution]]\nggx = 0.1\nbeckmann = 0.1", "a term has one of .*; got ggx, beckmann"),
        ("[[distribution]]\nweight = 1.0", "a term has one of .*; got none"),
        ('[[distribution]]\nggx = "wide"', "ggx must be a number"),
        ("[[distribution]]\nggx = 50.0", "m of ggx must be between 0.0001 and 10, got 50"),
    ],
)
def test_bad_tables_are_one_line(table, message):
    """File, key, value."""
    text = f'name = "X"\nmodel = "generator"\nalbedo = 0.1\nspecular = 1.0\n{table}\n[fresnel]\neta = 1.5\n'
    with pytest.raises(presets.PresetError, match=message) as caught:
        presets.parse(text + '[source]\ndata = "x"', "t/x", "x.toml")
    assert "\n" not in str(caught.value)


def test_published_fits_are_kept_to_the_digit_and_told():
    """Brass: the published amplitude of D, and the share of its light that Fit's terms do not have."""
    brass = presets.find("merl_fits/brass_merl")
    of = Distribution(brass.distribution)
    assert brass.distribution == (Term("abc", (244597.0, 1.13616)),)
    published = np.array([2975.156982, 1931.137207, 987.87738]) * 4.0 / np.pi  # at the peak: 1/pi there is 1/4 here
    # Six digits of the amplitude and of B and C in the file: 5e-6 each at most
    np.testing.assert_allclose(np.asarray(brass.parameters["specular"]) * of([0.0, 0.0, 1.0]), published, rtol=2e-5)
    told = dict(MODEL.account(brass))
    assert "% of the mirrored light differs" in told["Fit"]


@pytest.mark.once
def test_fit_is_near_most_published_fits():
    """L1 of D by at most six terms: half of the presets within 3 %, nine of ten within 15 %."""
    found = [
        distance(of, beckmann_terms(of))
        for one in presets.shipped().values()
        if one.model == MODEL.name
        for of in [Distribution(one.distribution)]
    ]
    assert len(found) >= 90
    assert np.quantile(found, 0.5) < 0.03
    assert np.quantile(found, 0.9) < 0.15
