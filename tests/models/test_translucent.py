# SPDX-License-Identifier: GPL-3.0-or-later
"""Translucent bodies: Cycles' subsurface scattering under a coat of V-grooves, never more than arrives."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import material
from vgroove.addon.choose import advice
from vgroove.addon.library.presets import PresetError, parse
from vgroove.addon.reference import CookTorrance, Dielectric, Lambert, Sum, albedo
from vgroove.lab.check.rows import SETUPS
from vgroove.lab.check.seeds import furnace_directions
from vgroove.lab.check.translucent import NOISY_ROWS, furnace_row, plan
from vgroove.lab.check.views import furnace, measure
from vgroove.nodegroups import translucent

TEXT = """
name = "Milk"
model = "translucent"
reflectance = [0.9, 0.5, 0.2]
mean_free_path = [0.0004, 0.0003, 0.0002]
m = 0.3
[fresnel]
eta = 1.3
[source]
data = "test"
"""


def preset(**changes):
    return parse(TEXT, "a/milk", "a/milk.toml").with_parameters(**changes)


def test_a_large_body_under_even_light_is_a_coupled_sum():
    """What the coat leaves is sent back in every direction alike."""
    coat = CookTorrance(0.3, Dielectric(1.3))
    assert preset().reference() == Sum(Lambert((0.9, 0.5, 0.2)), coat, 1.0, 1.0, coupled=True)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("eta = 1.3", "n = 0.2\nk = 3.0", "a translucent body needs eta or f0: no light passes a metal"),
        ("eta = 1.3", "eta = 4.0", "a translucent body needs eta from 1 to 3, got 4"),
        ("[0.0004, 0.0003, 0.0002]", "-1.0", "mean_free_path must be between 0 and 10, got -1"),
        ("reflectance = [0.9, 0.5, 0.2]", "reflectance = 1.2", "reflectance must be between 0 and 1, got 1.2"),
    ],
)
def test_a_bad_body_is_one_line(old, new, message):
    """What is wrong, and what it may be."""
    with pytest.raises(PresetError, match=f"^a/milk.toml: {message}"):
        parse(TEXT.replace(old, new), "a/milk", "a/milk.toml")


def sent_back(of, setup, estimator):
    """Under a white sky, (32, 3): for each of ``furnace_directions``."""
    return np.mean([measure(of, setup, estimator, furnace(), 256, seed).mean(axis=1) for seed in range(2)], axis=0)


@pytest.mark.blender
@pytest.mark.parametrize("estimator", material.BUILDERS["translucent"])
@pytest.mark.parametrize("setup", [SETUPS[0], SETUPS[2]], ids=str)
def test_a_white_furnace_is_near_the_sum_and_never_brightens(instrument, setup, estimator):
    """Cycles sends less back toward the normal and more toward grazing than Lambert's law does: up to 20 %.

    Over all views, weighted by the cosine, the two lie within 5 %, and by as much light more as the coat of native
    lobes may be off on this Blender.
    """
    seen, expected = sent_back(preset(), setup, estimator), albedo(preset().reference(), furnace_directions())
    up = furnace_directions()[:, 2] > 0.1
    assert seen.max() <= 1.0
    assert np.abs(seen / expected - 1.0)[up].max() < 0.2
    theta = np.arccos(furnace_directions()[:, 2])
    weight = (np.sin(theta) * np.cos(theta))[:, None]
    off = advice.native_fresnel_error("dielectric", setup.backend)
    bound = 0.05 * np.sum(weight * expected, axis=0) + off * weight.sum()
    assert (np.abs(np.sum(weight * (seen - expected), axis=0)) <= bound).all()


@pytest.mark.blender
def test_the_coat_is_that_of_the_estimator(instrument):
    """Over a black body there is nothing but the coat: ``mirror`` gives its albedo, by Z-test."""
    row = furnace_row(SETUPS[0], 0.3)
    assert row.passed, row.as_json()
    assert not row.scaled(1.03).passed


@pytest.mark.blender
def test_light_leaves_beside_where_it_came_in(blender):
    """The mean free path reaches the closure in Cycles' own measure: Radius / (4 pi); and the inputs read back."""
    made = material.build(preset(), material.Choice("nodes", "fit"))
    node = next(n for n in made.node_tree.nodes if n.type == "GROUP" and translucent.NAME in n.node_tree.name)
    assert tuple(node.inputs["Subsurface Radius"].default_value) == pytest.approx((0.0004, 0.0003, 0.0002))
    inner = next(n for n in node.node_tree.nodes if n.bl_idname == "ShaderNodeSubsurfaceScattering")
    assert inner.falloff == "RANDOM_WALK"
    factor = inner.inputs["Radius"].links[0].from_node.inputs[1].default_value
    assert tuple(factor) == pytest.approx((4 * np.pi,) * 3)
    read = material.origin_of(made).preset.parameters
    assert read == {key: pytest.approx(value) for key, value in preset().parameters.items()}


@pytest.mark.blender
def test_there_is_no_direct(blender):
    """As light from below the surface is no formula at a lamp."""
    with (
        headless.quiet(),
        pytest.raises(material.MaterialError, match='no estimator "direct"; use one of fit, closure'),
    ):
        material.build(preset(), material.Choice("nodes", "direct"))


def test_a_row_is_judged_by_the_size_of_its_own_plan():
    """Sidak's correction counts the noisy rows of the plan."""
    assert sum(row.func is furnace_row for row in plan()) == NOISY_ROWS
