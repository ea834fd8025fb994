# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums of a diffuse and a specular part: in Cycles as in the reference, and never more than arrives."""

import numpy as np
import pytest

from vgroove.addon import check, gonio, headless, material
from vgroove.addon.presets import PresetError, find, parse
from vgroove.addon.reference import CookTorrance, Dielectric, OrenNayar, Sum, albedo, spherical

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


def image(of, setup, estimator, geometry, samples=1, seed=0):
    with headless.quiet():
        return gonio.measure_preset(
            of, setup.backend, estimator, geometry, samples=samples, seed=seed, shading_osl=setup.shading_osl
        ).astype(float)


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


@pytest.mark.blender
@pytest.mark.parametrize("setup", check.SETUPS, ids=str)
def test_direct_is_the_sum_of_the_reference(blender, setup):
    """Under the bar of broad lobes; a part of 1 % more is seen."""
    for theta_i in (0.0, 45.0, 80.0):
        geometry = gonio.Geometry(theta_i)
        expected = preset().reference().evaluate(geometry.wi(), geometry.wo())
        off = np.abs(image(preset(), setup, "direct", geometry) - expected).max() / expected.max()
        assert off <= check.direct_bar(0.3)
        brighter = Sum(OrenNayar((0.8, 0.5, 0.2), 0.4), CookTorrance(0.3, Dielectric(1.5)), 0.6, 0.396)
        wrong = brighter.evaluate(geometry.wi(), geometry.wo())
        assert np.abs(image(preset(), setup, "direct", geometry) - wrong).max() / expected.max() > check.direct_bar(0.3)


@pytest.mark.blender
@pytest.mark.parametrize("estimator", ["fit", "closure"])
@pytest.mark.parametrize("setup", [check.SETUPS[0], check.SETUPS[2]], ids=str)
def test_native_sums_are_the_weighted_sum_of_their_parts(blender, setup, estimator):
    """Each part is held against its own reference elsewhere; here one image against two. Rounding of three terms."""
    geometry = gonio.Geometry(60.0)
    diffuse, specular = (image(part, setup, estimator, geometry) for part in preset().parts().values())
    both = image(preset(), setup, estimator, geometry)
    np.testing.assert_allclose(both, 0.6 * diffuse + 0.4 * specular, atol=1e-6 * both.max())
    assert np.abs(both - 0.606 * diffuse - 0.4 * specular).max() > 1e-6 * both.max()


@pytest.mark.blender
@pytest.mark.parametrize("setup", [check.SETUPS[0], check.SETUPS[2]], ids=str)
def test_mirror_gives_the_albedo_of_the_sum(blender, setup):
    """White sky; the pixels of one theta_o differ by noise alone, which gives the variance. 4.5 sigma of 96 numbers."""
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32))
    seen = np.concatenate([image(preset(), setup, "mirror", geometry, 256, seed) for seed in range(3)], axis=1)
    cosine = geometry.wo()[:, 0, 2]
    wo = np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], axis=-1)
    expected = albedo(preset().reference(), wo)
    error = np.std(seen, axis=1, ddof=1) / np.sqrt(seen.shape[1])
    assert np.max(np.abs(seen.mean(axis=1) - expected) / error) < 4.5
    assert np.abs((seen.mean(axis=1) - 1.01 * expected) / error).max() > 4.5


@pytest.mark.blender
def test_a_sum_shows_all_inputs_once(blender):
    """Weights, both parts' numbers, one normal, the lamps in their panels; and no estimator that a part lacks."""
    lamp = blender.data.objects.new("Lamp", blender.data.lights.new("Lamp", "SUN"))
    blender.context.scene.collection.objects.link(lamp)
    made = material.build(preset(), material.Choice("nodes", "direct", (lamp,)))
    node = next(node for node in made.node_tree.nodes if node.type == "GROUP" and "Sum" in node.node_tree.name)
    names = [socket.name for socket in node.inputs]
    shown = ["Diffuse", "Specular", "Base Color", "Sigma", "Normal", "IOR", "Slope m"]
    assert sorted(names) == sorted([*shown, "To Lamp 1", "Irradiance 1"])
    assert node.inputs["Sigma"].default_value == pytest.approx(0.4)
    for estimator in ("corrected", "hybrid"):
        with pytest.raises(material.MaterialError, match=f'has no estimator "{estimator}"'):
            material.build(preset(), material.Choice("nodes", estimator))
