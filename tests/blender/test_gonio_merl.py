# SPDX-License-Identifier: GPL-3.0-or-later
"""The sphere that gives every entry of a MERL table, against the reference at the cells' centres."""

import bpy
import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio_merl
from vgroove.addon.blender.material import Choice, build, lamps_to_bind
from vgroove.addon.library import presets
from vgroove.addon.measured import merl
from vgroove.addon.reference import rendered
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender

LAST = gonio_merl.BANDS - 1


def of_preset(name, estimator, backend="nodes", **changes):
    preset = presets.find(name).with_parameters(**changes)

    def make(scene):
        suns = lamps_to_bind(scene, estimator, preset.model)
        return build(preset, Choice(backend, estimator, suns, shadows=False))

    return preset, make


def band(make, index, **options):
    with headless.quiet():
        return next(gonio_merl.bands(make, first=index, **options))


def centres(index):
    """wi and wo (10, 90, 180, 3) of a band."""
    held = list(merl.rows(180))[index * gonio_merl.BAND : (index + 1) * gonio_merl.BAND]
    return (np.stack(one) for one in zip(*held, strict=True))


@pytest.mark.parametrize("index", [0, 4, LAST])
@pytest.mark.parametrize(("estimator", "backend"), [("direct", "nodes"), ("closure", "nodes"), ("direct", "osl")])
def test_each_entry_is_the_model_at_the_centre_of_its_cell(blender, estimator, backend, index):
    """As near as the flat patch is, where both directions are over 6 degrees above the horizon.

    The point where a ray meets the sphere rounds by 2^-23, which turns the normal by 2^-23 / cos theta_o, and n.l and
    n.v with it: relative 2^-23 / cos^2, 1.2e-5 at a cosine of 0.1, in n.l once more by the division. Beside it stand
    the bars of ``direct`` and ``closure``, 2e-5 and 2e-4 of the largest value, or of what exp() leaves of the peak.
    """
    preset, make = of_preset("lecture/copper", estimator, backend, m=0.2)
    found = band(make, index, shading_osl=backend == "osl")
    wi, wo = centres(index)
    f = rendered(preset.reference(), estimator)
    expected = np.moveaxis(f(wi, wo), -1, 0)
    high = np.minimum(wi[..., 2], wo[..., 2]) > 0.1
    bar = 2e-5 if estimator == "direct" and backend == "nodes" else 2e-4
    scale = max(expected[:, high].max(), 2.0**-64 * f([0, 0, 1], [0, 0, 1]).max())
    np.testing.assert_allclose(found[:, high], expected[:, high], rtol=4e-5, atol=bar * scale)
    np.testing.assert_array_equal(found[0] < 0, (wi[..., 2] <= 0) | (wo[..., 2] <= 0))


def principled(**inputs):
    def make(_scene):
        material = versions.empty_material("Probe")
        tree = material.node_tree
        node, output = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
        for name, value in inputs.items():
            node.inputs[name.replace("_", " ")].default_value = value
        tree.links.new(node.outputs[0], output.inputs["Surface"])
        return material

    return make


def test_a_plain_surface_of_blenders_own_is_reciprocal_lambert(blender):
    """Principled without a reflection is Lambert: 0.8 / pi at every entry above 1 degree, whatever the azimuth."""
    found = band(principled(Base_Color=(0.8, 0.4, 0.2, 1.0), Specular_IOR_Level=0.0), 4)
    wi, wo = centres(4)
    high = np.minimum(wi[..., 2], wo[..., 2]) > 0.02
    for channel, color in zip(found, (0.8, 0.4, 0.2), strict=True):
        np.testing.assert_allclose(channel[high], color / np.pi, rtol=3e-4)  # 2^-23 / 0.02^2


def test_what_depends_on_the_azimuth_is_refused(blender):
    """A material whose colour depends on the place, and anisotropic ones: Blender's, one within a group, and ours."""

    def textured(scene):
        material = principled()(scene)
        noise = material.node_tree.nodes.new("ShaderNodeTexNoise")
        noise.inputs["Scale"].default_value = 40.0
        node = material.node_tree.nodes["Principled BSDF"]
        material.node_tree.links.new(noise.outputs[1], node.inputs["Base Color"])
        return material

    with pytest.raises(gonio_merl.AnisotropicError, match="when it is turned"):
        band(textured, 0)
    brushed = principled(Metallic=1.0, Roughness=0.4, Anisotropic=0.8)

    def grouped(scene):
        inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
        inner.interface.new_socket("BSDF", in_out="OUTPUT", socket_type="NodeSocketShader")
        node, out = inner.nodes.new("ShaderNodeBsdfAnisotropic"), inner.nodes.new("NodeGroupOutput")
        node.inputs["Anisotropy"].default_value, node.inputs["Roughness"].default_value = 0.8, 0.4
        inner.links.new(node.outputs[0], out.inputs[0])
        material = principled()(scene)
        group, tree = material.node_tree.nodes.new("ShaderNodeGroup"), material.node_tree
        group.node_tree = inner
        tree.links.new(group.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        return material

    of = next(one for one in presets.shipped().values() if one.model == "anisotropic")
    _, ours = of_preset(of.id, "closure", anisotropy=0.8)
    for one in (brushed, grouped, ours):
        with pytest.raises(gonio_merl.AnisotropicError, match="set its Anisotropic"):
            band(one, 0)
    assert gonio_merl.is_anisotropic(brushed(None))
    assert not gonio_merl.is_anisotropic(principled(Metallic=1.0)(None))


def test_nothing_is_left_behind(blender):
    """No scene, object, mesh, camera, lamp or material."""
    before = {name: set(getattr(blender.data, name)) for name in ("scenes", "objects", "cameras", "materials")}
    band(principled(), LAST)
    assert {name: set(getattr(blender.data, name)) for name in before} == before
