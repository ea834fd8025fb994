# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds of every model with grooves, whatever gives their direction."""

from itertools import product

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.blender.material import Choice, build, lamps_to_bind

from .test_registry import EXAMPLES, title

pytestmark = pytest.mark.blender

VIEW = gonio.Geometry(50.0, resolution=(32, 32), phi_i=70.0, tangent=25.0)
GROOVED = [
    of
    for of in EXAMPLES
    if "anisotropy" in of.parameters and not of.spec.parts and "radial" not in of.flags
    if not of.spec.has_fresnel or of.kind == next(iter(of.spec.kinds))
]
BY_OSL = ("fit", "direct")
SETUPS = [
    pytest.param(of, estimator, osl, id=f"{title(of)}-{estimator}{'-osl' * osl}")
    for of in GROOVED
    for osl in (False, True)
    for estimator in (BY_OSL if osl else of.spec.estimators)
]
TANGENTS = ({"tangent": (0.0, 0.0, 1.0)}, {"tangent": (1e30, -1e30, 0.0)}, {"uvs": "zero"}, {"uvs": "none"})


def shown(instrument, of, estimator, tangent=None, uvs="", osl=False):  # noqa: FBT002
    """The patch under the sun: with a constant vector as Tangent, or its UV map removed, or of no extent."""

    def material(scene):
        suns = lamps_to_bind(scene, estimator, of.model)
        made = build(of, Choice("osl" if osl else "nodes", estimator, suns, shadows=False))
        if tangent is not None:
            tree = made.node_tree
            constant = tree.nodes.new("ShaderNodeCombineXYZ")
            for socket, value in zip(constant.inputs, tangent, strict=True):
                socket.default_value = value
            group = next(
                node for node in tree.nodes if node.bl_idname == "ShaderNodeGroup" and "Tangent" in node.inputs
            )
            tree.links.new(constant.outputs[0], group.inputs["Tangent"])
        return made

    with headless.quiet(), gonio.instrument(material, VIEW, shading_osl=True) as scene:
        mesh = next(item.data for item in scene.objects if item.type == "MESH")
        if uvs == "none":
            mesh.uv_layers.remove(mesh.uv_layers[0])
        if uvs == "zero":
            for loop in mesh.uv_layers[0].uv:
                loop.vector = (0.0, 0.0)
        scene.cycles.shading_system = osl
        return gonio.rendered(scene)


def test_models_with_grooves_are_found():
    assert {of.model for of in GROOVED} >= {"anisotropic", "ward", "ashikhmin_shirley"}


@pytest.mark.parametrize(("of", "estimator", "osl"), SETUPS)
def test_nothing_breaks_at_the_ends(instrument, of, estimator, osl):
    """The ends of the slope or exponent, grooved as deeply as can be and not at all: finite, and not negative.

    With tangents along the normal and too long, and UVs of no extent or none.
    """
    (width,) = (one for one in of.spec.parameters if one.label == "Roughness")
    ends = (width.low, width.high)
    cases = [*product((*ends, width.default), (1.0,), TANGENTS), *product(ends, (0.0,), ({},))]
    for value, anisotropy, how in cases:
        at = of.with_parameters(**{width.name: value}, anisotropy=anisotropy, rotation=0.1)
        image = shown(instrument, at, estimator, osl=osl, **how)
        assert np.isfinite(image).all(), (value, anisotropy, how)
        assert image.min() >= -1e-5 * max(image.max(), 1e-30), (value, anisotropy, how)
