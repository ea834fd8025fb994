# SPDX-License-Identifier: GPL-3.0-or-later
"""Car paint: a base and several lobes, in Cycles as in the reference, and never more than arrives."""

import numpy as np
import pytest

from vgroove.addon.blender import material
from vgroove.addon.library.presets import PresetError, parse
from vgroove.addon.reference import F82, CarPaint, CookTorrance, OrenNayar, albedo, rendered, spherical
from vgroove.lab.check.car_paint import ESTIMATORS, NOISY_ROWS, TEXT, exact_row, furnace_row, plan
from vgroove.lab.check.rows import SETUPS
from vgroove.nodegroups import car_paint


def preset(**changes):
    return parse(TEXT, "a/paint", "a/paint.toml").with_parameters(**changes)


def test_a_paint_is_that_of_the_reference():
    """With the numbers of the file, each lobe its own."""
    lobes = (
        CookTorrance(0.6, F82((0.6, 0.4, 0.2), (0.8, 0.9, 1.0))),
        CookTorrance(0.2, F82((0.5, 0.5, 0.5), (1.0, 1.0, 1.0))),
    )
    assert preset().reference() == CarPaint(OrenNayar((0.3, 0.1, 0.05), 0.2), lobes, (0.3, 0.2))
    assert preset(m_2=0.1).reference().lobes[1].m == 0.1
    assert preset().m == 0.6


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("s = 0.3", "s = 0.6", "albedo and all s must together be at most 1, .* got 0.3 \\+ 0.8"),
        ("s = 0.3", "s = 1.5", "lobe 1: s must be between 0 and 1, got 1.5"),
        ("m = 0.2", "k = 0.2", 'lobe 2: unknown key "k"'),
        ("m = 0.2\n", "", 'lobe 2: "m" is missing; a lobe has s, m, f0, f82_tint'),
        ("sigma = 0.2", "", '"sigma" is missing; add sigma = 0.3'),
        ("f0 = 0.5", "f0 = [0.5, 0.5]", "lobe 2: f0 must be one number or three"),
    ],
)
def test_a_bad_paint_is_one_line(old, new, message):
    """What is wrong, and in which lobe."""
    with pytest.raises(PresetError, match=f"^a/paint.toml: {message}"):
        parse(TEXT.replace(old, new), "a/paint", "a/paint.toml")


@pytest.mark.parametrize("lobes", ["lobes = []", "lobes = 3", "lobes = [3]"])
def test_lobes_must_be_tables(lobes):
    """One at least."""
    text = TEXT[: TEXT.index("[[lobes]]")] + lobes + '\n[source]\ndata = "test"\n'
    with pytest.raises(PresetError, match="lobes"):
        parse(text, "a/paint", "a/paint.toml")


def test_a_weight_must_be_there_for_each_lobe():
    """And within 0 and 1."""
    base = OrenNayar(0.5, 0.0)
    with pytest.raises(ValueError, match="a weight for each of the 1 lobes, got 0"):
        CarPaint(base, (CookTorrance(0.3, F82(0.5, 1.0)),), ())
    with pytest.raises(ValueError, match="s must be between 0 and 1"):
        CarPaint(base, (CookTorrance(0.3, F82(0.5, 1.0)),), (1.1,))


def test_samples_give_the_albedo():
    """The mean weight of 400,000 draws, within four standard errors, and not if the lobes' weights were 2 % off."""
    model = preset().reference()
    u = np.random.default_rng(5).random((400_000, 4))
    for degrees in (0.0, 60.0):
        wo = spherical(np.radians(degrees))
        _, weight = model.sample(wo, u)
        off = weight.mean(axis=0) - albedo(model, wo)
        error = weight.std(axis=0) / np.sqrt(len(u))
        assert np.all(np.abs(off) < 4 * error)
        assert np.all(4 * error < 0.02 * albedo(model, wo))


@pytest.mark.blender
@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize("setup", SETUPS, ids=str)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, setup, estimator):
    """On the hemisphere, at every theta_i; red as well if one lobe alone has 1 % more."""
    row = exact_row(estimator, setup, 0.2)
    assert row.passed, row.as_json()
    for factor in (1.01, 1 / 1.01):
        assert not row.scaled(factor).passed
    evaluate = rendered(preset(s_2=0.202).reference(), estimator if estimator in material.NATIVE else "direct")
    view = row.views[1]
    assert np.max(np.abs(evaluate(view.geometry.wi(), view.geometry.wo()) - view.expected)) > view.bar * view.scale


@pytest.mark.blender
@pytest.mark.parametrize("setup", [SETUPS[0], SETUPS[2]], ids=str)
def test_mirror_sends_back_the_albedo(instrument, setup):
    """In a white furnace, by Z-test; a lobe with 2 % less would show."""
    row = furnace_row(setup, 0.2)
    assert row.passed, row.as_json()
    assert not row.scaled(1.01).passed
    assert not row.scaled(1 / 1.01).passed


@pytest.mark.blender
def test_each_lobe_shows_its_inputs_in_a_panel_of_its_own(blender):
    """One normal and one set of lamps for all; the numbers are those of the preset, and are read back."""
    lamp = blender.data.objects.new("Lamp", blender.data.lights.new("Lamp", "SUN"))
    blender.context.scene.collection.objects.link(lamp)
    bound = material.lamps_to_bind(blender.context.scene, "direct")
    made = material.build(preset(), material.Choice("nodes", "direct", bound))
    node = next(node for node in made.node_tree.nodes if node.type == "GROUP" and car_paint.NAME in node.node_tree.name)
    lobe = ("Specular", "Color", "Edge Tint", "Roughness")
    names = {"Base Color", "Diffuse Roughness", "Normal", "To Lamp 1", "Irradiance 1"}
    names |= {f"Lobe {k} {name}" for k in (1, 2) for name in lobe}
    assert {socket.name for socket in node.inputs} == names
    assert len(node.inputs) == len(names)
    panels = {item.name: item.parent.name for item in node.node_tree.interface.items_tree if item.item_type == "SOCKET"}
    assert {panels[f"Lobe 2 {name}"] for name in lobe} == {"Lobe 2"}
    assert node.inputs["Lobe 2 Roughness"].default_value == pytest.approx(0.2**0.5)
    read = material.origin_of(made).preset.parameters
    assert read == {key: pytest.approx(value) for key, value in preset().parameters.items()}


def test_a_row_is_judged_by_the_size_of_its_own_plan():
    """Sidak's correction counts the noisy rows of the plan."""
    assert sum(row.func is furnace_row for row in plan()) == NOISY_ROWS
