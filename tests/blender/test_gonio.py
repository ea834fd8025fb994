# SPDX-License-Identifier: GPL-3.0-or-later
"""The gonioreflectometer looks where it says, lights from where it says, and turns the tangent as it says."""

from dataclasses import replace

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.reference import Schlick, cook_torrance
from vgroove.lab.check.cook_torrance import direct_row, materials, sphere_row
from vgroove.lab.check.rows import SETUPS
from vgroove.lab.check.views import closure_bar
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender

ALPHA, ANISOTROPY = 0.3, 0.5
METAL_ASPECT = np.sqrt(1.0 - 0.9 * ANISOTROPY)
# Slopes along the tangent and across it, as Cycles makes them from Roughness^2 = ALPHA and Anisotropy.
STRETCHED = {
    "Metallic": (ALPHA / METAL_ASPECT, ALPHA * METAL_ASPECT),
    "Anisotropic": (ALPHA * (1.0 - ANISOTROPY), ALPHA / (1.0 - ANISOTROPY)),  # the Glossy BSDF
}
TURNS = [(0.0, 0.0), (90.0, 0.0), (0.0, 35.0), (200.0, 290.0)]  # phi_i, tangent


def anisotropic_beckmann(wi, wo, ax, ay):
    """f of a perfectly reflecting Beckmann surface with height-correlated Smith shadowing, in 1/sr, (...).

    D = exp(-((hx/ax)^2 + (hy/ay)^2) / hz^2) / (pi ax ay hz^4); f = D / (4 |n.wi| |n.wo| (1 + L(wi) + L(wo)));
    L(w) = (1 - 1.259 a + 0.396 a^2) / (3.535 a + 2.181 a^2) for a < 1.6, else 0, with
    a = wz / sqrt((ax wx)^2 + (ay wy)^2).
    wi, wo: unit vectors (..., 3) in the frame of tangent, bitangent and normal; 0 unless both are above the surface.
    Sources: Walter et al. 2007 for D and the rational L; Heitz 2014, eqs. 80, 86 and 99, for stretching and for G.
    """
    wi = np.broadcast_to(wi, wo.shape)
    up = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    wi, wo = (np.where(up[..., None], w, [0.0, 0.0, 1.0]) for w in (wi, wo))
    h = (wi + wo) / np.linalg.norm(wi + wo, axis=-1, keepdims=True)
    D = np.exp(-((h[..., 0] / ax) ** 2 + (h[..., 1] / ay) ** 2) / h[..., 2] ** 2) / (np.pi * ax * ay * h[..., 2] ** 4)

    def smith(w):
        a = w[..., 2] / np.maximum(np.hypot(ax * w[..., 0], ay * w[..., 1]), 1e-300)
        return np.where(a < 1.6, (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)

    return np.where(up, D / (4.0 * wi[..., 2] * wo[..., 2] * (1.0 + smith(wi) + smith(wo))), 0.0)


def in_tangent_frame(w, degrees):
    """Directions (..., 3) seen from axes that are turned about the normal."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.stack([c * w[..., 0] + s * w[..., 1], c * w[..., 1] - s * w[..., 0], w[..., 2]], axis=-1)


def stretched(blender, kind):
    """A white anisotropic closure of Blender's whose tangent is the UV map's u axis."""
    material = blender.data.materials.new("Probe")
    tree = versions.nodes_of(material)
    tree.nodes.clear()
    shader, tangent, output = (
        tree.nodes.new(name) for name in (f"ShaderNodeBsdf{kind}", "ShaderNodeTangent", "ShaderNodeOutputMaterial")
    )
    shader.distribution = "BECKMANN"
    if kind == "Metallic":
        shader.fresnel_type = "F82"
        shader.inputs["Base Color"].default_value = shader.inputs["Edge Tint"].default_value = (1.0, 1.0, 1.0, 1.0)
    else:
        shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    shader.inputs["Roughness"].default_value, shader.inputs["Anisotropy"].default_value = ALPHA**0.5, ANISOTROPY
    tangent.direction_type = "UV_MAP"
    tree.links.new(tangent.outputs["Tangent"], shader.inputs["Tangent"])
    tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    return material


def difference(blender, kind, geometry, shown, *, shading_osl):
    """The largest difference of ``geometry``'s image from the formula in the geometry ``shown``, over its maximum."""
    with headless.quiet():
        image = gonio.measure(stretched(blender, kind), geometry, shading_osl=shading_osl)
    wi, wo = (in_tangent_frame(w, shown.tangent) for w in (shown.wi(), shown.wo()))
    expected = anisotropic_beckmann(wi, wo, *STRETCHED[kind])
    return np.max(np.abs(image - expected[..., None])) / np.max(expected)


@pytest.mark.parametrize("kind", STRETCHED)
@pytest.mark.parametrize("turns", TURNS)
@pytest.mark.parametrize("window", [0.0, 20.0])
@pytest.mark.parametrize("shading_osl", [False, True], ids=["SVM", "OSL"])
def test_anisotropic_closures_follow_the_azimuths_of_light_and_tangent(blender, kind, turns, window, shading_osl):
    """An anisotropic closure is its formula; one degree off in either azimuth, or ax and ay swapped, it is not."""
    phi_i, tangent = turns
    geometry = gonio.Geometry(40.0, window, (32, 32), phi_i=phi_i, tangent=tangent)
    bar = closure_bar(min(STRETCHED[kind]))
    assert difference(blender, kind, geometry, geometry, shading_osl=shading_osl) <= bar
    for other in ({"phi_i": phi_i + 1.0}, {"tangent": tangent + 1.0}, {"tangent": tangent + 90.0}):
        assert difference(blender, kind, geometry, replace(geometry, **other), shading_osl=shading_osl) > 10.0 * bar


@pytest.mark.parametrize("window", [0.0, 5.0])
def test_phi_i_turns_the_sun_and_the_window_with_it(window):
    """wi turns about the normal; a window turns with it, pixels of the hemisphere stay at their phi_o."""
    flat, turned = gonio.Geometry(50.0, window), gonio.Geometry(50.0, window, phi_i=30.0)
    np.testing.assert_allclose(turned.wi(), in_tangent_frame(flat.wi(), -30.0), atol=1e-15)
    expected = in_tangent_frame(flat.wo(), -30.0) if window else flat.wo()
    assert turned.wo().shape == (64, 64, 3)
    np.testing.assert_allclose(turned.wo(), expected, atol=1e-15)


@pytest.mark.parametrize("window", [0.0, 5.0])
@pytest.mark.parametrize("shading_osl", [False, True], ids=["SVM", "OSL"])
def test_an_isotropic_material_does_not_depend_on_the_common_azimuth(instrument, window, shading_osl):
    """In the window, where light and views turn together, nothing changes but by rounding; on the hemisphere 1/8."""
    preset = materials()["schlick"].with_parameters(m=0.1)
    images = []
    for phi_i in (0.0, 45.0):
        with headless.quiet():
            images.append(
                gonio.measure_preset(
                    preset, "nodes", "direct", gonio.Geometry(40.0, window, phi_i=phi_i), shading_osl=shading_osl
                )
            )
    same = images[0] if window else np.roll(images[0], 8, axis=1)
    assert np.max(np.abs(images[1] - same)) <= 2.0 * 2e-5 * np.max(same)  # each is within 2e-5 of the formula


def test_gonio_pixels_look_where_they_say(instrument):
    """The pixel of the mirror direction is brightest, and phi_o runs from wi's side around."""
    preset = materials()["schlick"].with_parameters(m=0.1)
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
    direct_row(SETUPS[0], "schlick", 0.3)
    sphere_row("schlick", 0.3)
    assert [len(getattr(blender.data, kind)) for kind in kinds] == before
