# SPDX-License-Identifier: GPL-3.0-or-later
"""Ward's model in Cycles against NumPy, that every row turns red, and what presets may not have."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.library import presets
from vgroove.lab.check import ward as rows
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.lab.check.views import measure
from vgroove.nodegroups import anisotropic_d, osl_script, random_numbers, smith_lobe, ward

from ..rows import check_that_mirror_counts_lights_once, name
from .test_phong import frozen, more, mutated

NODES, _, OSL = SETUPS
KINDS = pytest.mark.parametrize("kind", rows.KINDS)


@pytest.mark.blender
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


@pytest.mark.blender
@KINDS
def test_mirror_with_lights_counts_each_once(instrument, kind):
    for setup in (NODES, OSL):
        check_that_mirror_counts_lights_once(rows.material(kind, 0.3, 0.5, 0.1, 0.25), setup)


@pytest.mark.blender
@pytest.mark.parametrize("estimator", ["fit", "closure"])
def test_it_is_lambert_where_nothing_is_specular(instrument, estimator):
    """To the rounding of float32."""
    of = rows.material("bounded", 0.2, 0.5, 0.0, 0.25).with_parameters(specular=(0.0, 0.0, 0.0))
    for setup in (NODES, OSL):
        image = measure(of, setup, estimator, gonio.Geometry(30.0, resolution=(8, 8)))
        np.testing.assert_allclose(image, 0.25 / np.pi, rtol=1e-6)


# --- mutants ------------------------------------------------------------------------------------------------------


@pytest.mark.blender
@pytest.mark.once
@KINDS
@pytest.mark.parametrize(("m", "anisotropy"), rows.SHAPES[:3])
def test_one_percent_in_the_lobe_turns_direct_red(blender, monkeypatch, kind, m, anisotropy):
    """In D, as nodes and in OSL."""
    with monkeypatch.context() as patch:
        patch.setattr(anisotropic_d, "build", more(anisotropic_d, "D"))
        assert not rows.exact_row("direct", NODES, kind, anisotropy, 1, m).passed
    monkeypatch.setattr(osl_script, "source", mutated("float D = aniso", "float D = 1.01 * aniso", "ward"))
    assert not rows.exact_row("direct", OSL, kind, anisotropy, 1, m).passed


@pytest.mark.blender
@pytest.mark.once
@KINDS
def test_one_percent_in_what_is_subtracted_turns_corrected_red(blender, monkeypatch, kind):
    """Cycles' lobes as a formula, in the node group and in OSL."""
    with monkeypatch.context() as patch:
        patch.setattr(smith_lobe, "build", more(smith_lobe, "f cos"))
        assert not rows.exact_row("corrected", NODES, kind, 0.8, 1, 0.2).passed
    wrong = mutated("lacking -= lobes", "lacking -= 1.01 * lobes", "ward_correction")
    monkeypatch.setattr(osl_script, "source", wrong)
    assert not rows.exact_row("corrected", OSL, kind, 0.8, 1, 0.2).passed


@pytest.mark.blender
@pytest.mark.once
@KINDS
def test_one_percent_in_the_weight_or_a_constant_hash_turns_mirror_red(blender, monkeypatch, kind):
    """Of a drawn facet the weight 1 % larger, then a number that does not change from sample to sample."""
    draw = ward.Inputs.draw

    def heavier(*given):
        h, weight = draw(*given)
        return h, weight * 1.01

    for nodes, osl in (
        ((ward.Inputs, "draw", heavier), ("+ weight * specular", "+ 1.01 * weight * specular")),
        ((random_numbers, "build", frozen), ('return noise("hash", P, w)', "return 0.37")),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(*nodes)
            patch.setattr(osl_script, "source", mutated(*osl, "ward_mirror"))
            for setup in (NODES, OSL):
                assert not rows.furnace_row(setup, kind, 0.6, 0.1, 0.3).passed
        for group in list(blender.data.node_groups):
            blender.data.node_groups.remove(group)


# --- presets ------------------------------------------------------------------------------------------------------


@pytest.mark.blender
@pytest.mark.parametrize("shader", ["closure", "correction", "direct", "fit", "mirror"])
def test_every_shader_compiles(blender, shader, tmp_path):
    """As its own text."""
    import _cycles

    path = tmp_path / "ward.osl"
    path.write_text(osl_script.source(f"ward_{shader}"), encoding="utf-8")
    with headless.quiet():
        assert _cycles.osl_compile(str(path), str(path.with_suffix(".oso")))


def test_what_would_gain_energy_is_refused():
    """In one line: Duer's form of 2006, and colours that add up to more than 1."""
    with pytest.raises(presets.PresetError, match='kind of ward must be one of bounded, ward_1992, got "duer_2006"'):
        rows.material("duer_2006", 0.2, 0.5, 0.0)
    with pytest.raises(presets.PresetError, match=r"albedo \+ specular must be at most 1, .*; got 1.025"):
        rows.material("bounded", 0.2, 0.5, 0.0, 0.4)
    with pytest.raises(presets.PresetError, match=r"albedo \+ 1.07 specular must be at most 1, .*; got 1.01875"):
        rows.material("ward_1992", 0.2, 0.5, 0.0, 0.35)
