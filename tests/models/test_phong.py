# SPDX-License-Identifier: GPL-3.0-or-later
"""Phong and Blinn-Phong in Cycles against NumPy, and that every row turns red."""

from dataclasses import replace

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.library import presets
from vgroove.addon.models import MODELS
from vgroove.lab.check import phong as phong_rows
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.lab.check.views import measure
from vgroove.nodegroups import blinn_phong, cosine_power, osl_script, phong, phong_table, random_numbers, smith_lobe
from vgroove.nodegroups._tree import Value

from ..rows import check_that_mirror_counts_lights_once, name

pytestmark = pytest.mark.blender

NODES, _, OSL = SETUPS
LOBES = {"phong": phong.PHONG, "blinn_phong": blinn_phong.BLINN_PHONG}
BOTH = pytest.mark.parametrize("model", LOBES)


@pytest.mark.parametrize("row", [row for model in LOBES for row in phong_rows.plan(model)], ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row of both plans passes, and is red against a reference 1 % brighter or darker."""
    row = row()
    assert row.passed, row.as_json()
    assert not row.scaled(1.01).passed
    assert not row.scaled(1 / 1.01).passed
    assert not row.is_noisy or row.resolves <= surely_seen(0.01, phong_rows.NOISY_ROWS)


@BOTH
def test_the_limit_for_noisy_rows_counts_them_all(model):
    """Sidak's correction is for as many rows as a plan has."""
    rows = phong_rows.plan(model)
    assert sum(row.func is not phong_rows.exact_row for row in rows) == phong_rows.NOISY_ROWS


@BOTH
def test_mirror_with_lights_counts_each_once(instrument, model):
    for setup in (NODES, OSL):
        check_that_mirror_counts_lights_once(phong_rows.preset(model, 0.5), setup)


# --- mutants ------------------------------------------------------------------------------------------------------


def more(module, output):
    """A group's build with 1 % more of what it puts out."""
    original = module.build

    def build(tree):
        original(tree)
        sink = tree._output.inputs[output]
        tree.connect(Value(tree, sink.links[0].from_socket) * 1.01, sink)

    return build


def mutated(old, new, within="phong"):
    """Shader texts with ``new`` in place of ``old``."""
    original = osl_script.source

    def source(shader, tables=None):
        text = original(shader, tables)
        if shader.startswith(within):
            assert old in text
        return text.replace(old, new)

    return source


@pytest.mark.once
@BOTH
@pytest.mark.parametrize("roughness", phong_rows.ROUGHNESSES)
def test_one_percent_in_the_lobe_turns_direct_red(blender, monkeypatch, model, roughness):
    """In the power, as nodes and in OSL, at every roughness that ``direct`` claims."""
    with monkeypatch.context() as patch:
        patch.setattr(cosine_power, "build", more(cosine_power, "Power"))
        assert not phong_rows.exact_row(model, "direct", NODES, roughness).passed
    monkeypatch.setattr(osl_script, "source", mutated("return exp(-0.5 * n", "return 1.01 * exp(-0.5 * n"))
    assert not phong_rows.exact_row(model, "direct", OSL, roughness).passed


@pytest.mark.once
@BOTH
def test_one_percent_in_what_is_subtracted_turns_corrected_red(blender, monkeypatch, model):
    """Cycles' lobe as a formula, in the node group and in OSL."""
    with monkeypatch.context() as patch:
        patch.setattr(smith_lobe, "build", more(smith_lobe, "f cos"))
        assert not phong_rows.exact_row(model, "corrected", NODES, 0.3).passed
    monkeypatch.setattr(osl_script, "source", mutated("ni - weight", "ni - 1.01 * weight", "phong_correction"))
    assert not phong_rows.exact_row(model, "corrected", OSL, 0.3).passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
@BOTH
@pytest.mark.parametrize("roughness", phong_rows.MIRROR_ROUGHNESSES)
def test_one_percent_in_the_weight_or_a_constant_hash_turns_mirror_red(blender, monkeypatch, model, roughness):
    """Of what is drawn the weight 1 % larger, then a number that does not change from sample to sample."""
    module, lobe = {"phong": phong, "blinn_phong": blinn_phong}[model], LOBES[model]

    def heavier(*given):
        h, weight = lobe.draw(*given)
        return h, weight * 1.01

    def variant(_form):
        return "", {"of": replace(lobe, draw=heavier)}

    for nodes, osl in (
        ((module, "variant", variant), ("+ weight * specular", "+ 1.01 * weight * specular")),
        ((random_numbers, "build", frozen), ('return noise("hash", P, w)', "return 0.37")),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(*nodes)
            patch.setattr(osl_script, "source", mutated(*osl))
            assert not phong_rows.furnace_row(model, NODES, roughness).passed
            assert not phong_rows.furnace_row(model, OSL, roughness).passed
        for group in list(blender.data.node_groups):
            blender.data.node_groups.remove(group)


# --- the groups ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shader", ["closure", "correction", "direct", "mirror"])
def test_every_shader_compiles_and_has_the_ranges_of_its_group(blender, shader, tmp_path):
    """With the numbers of either lobe; defaults and ranges are those of the spec."""
    import _cycles
    import oslquery

    for model in LOBES:
        path = tmp_path / f"{model}.osl"
        text = osl_script.source(f"phong_{shader}", {phong_table.NAME: phong_table.header(model)})
        path.write_text(text, encoding="utf-8")
        with headless.quiet():
            assert _cycles.osl_compile(str(path), str(path.with_suffix(".oso")))
        found = {one.name: one for one in oslquery.OSLQuery(str(path.with_suffix(".oso"))).parameters}
        for one in MODELS["phong"].parameters:
            about = {meta.name: meta.value for meta in found[one.name].metadata}
            np.testing.assert_allclose(np.ravel(found[one.name].value)[:3], one.default, rtol=1e-6)
            assert about["label"] == (one.symbol or one.label)
            if not one.is_rgb:
                assert [about["min"], about["max"]] == [one.low, one.high]


@BOTH
def test_closure_is_lambert_where_nothing_is_specular(instrument, model):
    """Whatever the exponent, to the rounding of float32."""
    of = phong_rows.preset(model, 0.5).with_parameters(specular=(0.0, 0.0, 0.0))
    for setup in (NODES, OSL):
        image = measure(of, setup, "closure", gonio.Geometry(30.0, resolution=(8, 8)))
        np.testing.assert_allclose(image, of.parameters["albedo"][0] / np.pi, rtol=1e-6)


def test_colours_that_add_up_to_more_than_one_are_refused():
    """In one line, with the numbers."""
    red = presets.find("phong/phong_red_plastic")
    with pytest.raises(presets.PresetError, match=r"albedo \+ specular must be at most 1, .*; got 1.2"):
        red.with_parameters(specular=(0.7, 0.2, 0.2))
