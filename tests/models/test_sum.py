# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums of a diffuse and a specular part: in Cycles as in the reference, and never more than arrives."""

import re

import numpy as np
import pytest

from vgroove.addon.blender import material
from vgroove.addon.blender.inputs import value_of
from vgroove.addon.library.presets import PresetError, find, parse
from vgroove.addon.reference import CookTorrance, Dielectric, Lambert, OrenNayar, Schlick, Sum, albedo, spherical
from vgroove.addon.reference.cook_torrance_albedo import quick_albedo
from vgroove.addon.reference.sum import quick_diffuse_share
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.lab.check.sum import NOISY_ROWS, exact_row, plan
from vgroove.nodegroups import cook_torrance_albedo

from ..rows import name

TEXT = """
name = "Sum"
model = "sum"
d = 0.6
s = 0.4
albedo = [0.8, 0.5, 0.2]
sigma = 0.4
m = 0.3
[fresnel]
eta = 1.5
[source]
data = "test"
"""


def preset(**changes):
    return parse(TEXT, "a/sum", "a/sum.toml").with_parameters(**changes)


def test_a_sum_is_that_of_the_reference():
    """With the numbers of the file."""
    assert preset().reference() == Sum(OrenNayar((0.8, 0.5, 0.2), 0.4), CookTorrance(0.3, Dielectric(1.5)), 0.6, 0.4)


def test_weights_that_give_more_than_arrives_are_refused():
    """In the file and when changed, in one line."""
    with pytest.raises(PresetError, match=r"a/sum.toml: d \+ s must be at most 1"):
        parse(TEXT.replace("d = 0.6", "d = 0.7"), "a/sum", "a/sum.toml")
    with pytest.raises(PresetError, match=r"d \+ s must be at most 1"):
        preset(s=0.5)


@pytest.mark.parametrize("name", ["plastics/red_plastic", "plastics/white_plastic"])
def test_no_sum_sends_back_more_than_arrives(name):
    """At every slope and view."""
    wo = spherical(np.radians([0.0, 40.0, 70.0, 85.0, 89.0]))
    for m in (0.0, 0.05, 0.3, 1.0):
        assert np.max(albedo(find(name).with_parameters(m=m).reference(), wo)) <= 1.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("eta = 1.5", "n = 0.2\nk = 3.0", "a coupled sum needs eta or f0"),
        ("eta = 1.5", "f0 = [0.1, 0.2, 0.3]", "a coupled sum needs an f0 without colour"),
        ("m = 0.3", "m = 2.0", "a coupled sum needs m of at most 1, got 2"),
        ("coupled = true", "coupled = 1", "coupled must be true or false, got 1"),
    ],
)
def test_what_cannot_be_coupled_is_refused(old, new, message):
    """A metal, a coloured F0, a slope that no fit reaches; in one line."""
    text = TEXT.replace("d = 0.6", "coupled = true\nd = 0.6")
    assert parse(text, "a/sum", "a/sum.toml").flags == ("coupled",)
    with pytest.raises(PresetError, match=re.escape(f"a/sum.toml: {message}")):
        parse(text.replace(old, new), "a/sum", "a/sum.toml")


@pytest.mark.parametrize(
    ("fresnel", "message"),
    [("eta = 3.1", "eta from 1 to 3, got 3.1"), ("eta = 0.9", "got 0.9"), ("f0 = 0.3", "f0 of at most 0.25")],
)
def test_a_coupled_sum_is_refused_beyond_what_its_albedo_was_fitted_for(fresnel, message):
    """There more light could leave than arrives."""
    text = re.sub(r"\[fresnel\]\n.*", f"[fresnel]\n{fresnel}", TEXT.replace("d = 0.6", "coupled = true\nd = 0.9"))
    with pytest.raises(PresetError, match=message):
        parse(text, "a/sum", "a/sum.toml")


def test_coupled_weights_may_exceed_one():
    """As the diffuse part gets only what the specular one leaves."""
    text = TEXT.replace("d = 0.6", "coupled = true\nd = 0.9").replace("s = 0.4", "s = 1.0")
    assert parse(text, "a/sum", "a/sum.toml").reference().coupled


@pytest.mark.parametrize("eta", [1.1, 1.4, 1.8, 2.5])
def test_three_facets_give_the_albedo(eta):
    """At slopes and views off the tool's grid; the module says 0.003 for dielectrics and 0.007 for F = 1."""
    wo = spherical(np.radians([0.0, 13.0, 37.0, 59.0, 77.0, 85.0, 88.5, 89.7]))
    for m in (0.015, 0.07, 0.13, 0.33, 0.55, 0.77, 0.96):
        for fresnel, bar in ((Dielectric(eta), 0.003), (Schlick(1.0), 0.007)):
            off = np.max(np.abs(quick_albedo(wo, m, fresnel) - albedo(CookTorrance(m, fresnel), wo)))
            assert off <= bar
    wrong = 1.01 * quick_albedo(wo, 0.3, Dielectric(2.5)) - albedo(CookTorrance(0.3, Dielectric(2.5)), wo)
    assert np.max(np.abs(wrong)) > 0.003
    np.testing.assert_allclose(quick_albedo(wo, 0.0, Dielectric(eta)), Dielectric(eta)(wo[:, 2]), atol=0.003)


@pytest.mark.parametrize("fresnel", [Dielectric(1.5), Dielectric(3.0), Schlick(0.02), Schlick(0.25)], ids=repr)
@pytest.mark.parametrize("m", [0.05, 0.3, 1.0])
def test_coupled_sums_as_shaders_have_them_send_back_no_more_than_arrives(m, fresnel):
    """With E_s from three facets, for the brightest bases and the strongest specular parts that presets may have."""
    wo = spherical(np.radians([0.0, 30.0, 60.0, 75.0, 85.0, 89.0]))
    for sigma in (0.0, 0.2, 0.5):
        model = Sum(OrenNayar(0.95, sigma), CookTorrance(m, fresnel), 1.0, 1.0, coupled=True)
        share = quick_diffuse_share(model, wo)
        assert np.max(share * albedo(model.diffuse, wo) + albedo(model.specular, wo)) <= 1.0


def test_only_rough_or_smooth_reflection_can_be_coupled_in_shaders():
    """A clear message for what has no facets."""
    with pytest.raises(TypeError, match="needs a CookTorrance or Smooth specular part, got Lambert"):
        quick_diffuse_share(Sum(Lambert(0.5), Lambert(0.5), 0.5, 0.5, coupled=True), spherical(0.3))


@pytest.mark.blender
@pytest.mark.parametrize("row", plan(), ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row passes, and is red against a reference 1 % brighter or darker."""
    row = row()
    assert row.passed, row.as_json()
    if row.bar < 0.01 or row.is_noisy:  # on 4.5 native Fresnel terms are approximate
        assert not row.scaled(1.01).passed
        assert not row.scaled(1 / 1.01).passed
        assert not row.is_noisy or row.resolves <= surely_seen(0.01, NOISY_ROWS)


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    assert sum(row.func is not exact_row for row in plan()) == NOISY_ROWS


@pytest.mark.once
@pytest.mark.blender
def test_one_percent_in_the_specular_albedo_turns_coupled_sums_red(blender, monkeypatch):
    """The same nodes serve both backends."""
    original = cook_torrance_albedo.directional_albedo
    monkeypatch.setattr(cook_torrance_albedo, "directional_albedo", lambda *given: original(*given) * 1.01)
    for setup in (SETUPS[0], SETUPS[2]):
        assert not exact_row("direct", setup, "coupled", 0.3).passed


@pytest.mark.blender
def test_a_sum_shows_all_inputs_once(blender):
    """Weights, both parts' numbers, one normal, the lamps in their panels."""
    lamp = blender.data.objects.new("Lamp", blender.data.lights.new("Lamp", "SUN"))
    blender.context.scene.collection.objects.link(lamp)
    made = material.build(
        preset(), material.Choice("nodes", "direct", material.lamps_to_bind(blender.context.scene, "direct"))
    )
    node = next(node for node in made.node_tree.nodes if node.type == "GROUP" and "Sum" in node.node_tree.name)
    names = [socket.name for socket in node.inputs]
    shown = ["Diffuse", "Specular", "Base Color", "Diffuse Roughness", "Normal", "IOR", "Roughness"]
    assert sorted(names) == sorted([*shown, "To Lamp 1", "Irradiance 1"])
    assert value_of("sigma", node.inputs["Diffuse Roughness"]) == pytest.approx(0.4)
