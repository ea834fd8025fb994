# SPDX-License-Identifier: GPL-3.0-or-later
"""Anisotropic Cook-Torrance in Cycles: the formula at four azimuths, Blender's own sense of Anisotropy, any tangent."""

from dataclasses import replace

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, principled
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library.presets import all_presets, find, parse
from vgroove.addon.models.anisotropic import MODEL
from vgroove.lab.check import anisotropic as check
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.nodegroups import versions

from ..rows import name
from .test_tangents import VIEW, shown

PLAN = check.plan()
NOISY = {check.furnace_row, check.sun_row}
OF_SVM = [row for row in PLAN if SETUPS[0] in row.args]
# All shapes and turns of the formula itself, and of the others one row each
CHOSEN = [row for row in OF_SVM if "direct" in row.args or row.args[-1] == 0.3 or "sun" in row.func.__name__]
CHOSEN += [row for row in PLAN if SETUPS[2] in row.args and row.args[-1] == 0.3 and "schlick" in row.args]
ROWS = [pytest.param(row, marks=[] if row in CHOSEN else [pytest.mark.more]) for row in PLAN]


def test_the_plan_has_as_many_noisy_rows_as_it_says():
    """By which Sidak's correction is made."""
    assert sum(row.func in NOISY for row in PLAN) == check.NOISY_ROWS


@pytest.mark.blender
@pytest.mark.parametrize("row", ROWS, ids=name)
def test_cycles_agrees_with_the_reference(instrument, row):
    """And would not with one that is 1 % brighter or darker, but where float32 cannot tell."""
    row = row()
    assert row.passed, row.error
    assert not row.is_noisy or row.resolves <= surely_seen(0.01, check.NOISY_ROWS)
    if row.bar < 0.01 or row.is_noisy:
        assert not row.scaled(1.01).passed
        assert not row.scaled(0.99).passed


def test_presets_have_grooves_of_both_kinds():
    """Along the UV map and around the axis."""
    brushed = [preset for preset in all_presets().values() if preset.model == MODEL.name]
    assert len(brushed) > 50
    assert {preset.flags for preset in brushed} == {(), ("radial",)}


# --- Blender's own sense --------------------------------------------------------------------------------------------

TEXT = 'name = "T"\nmodel = "anisotropic"\nm = {}\nanisotropy = {}\nrotation = {}\nradial = {}\n'
TEXT += '[fresnel]\nf0 = [0.9, 0.5, 0.3]\n[source]\ndata = "test"'


def preset(m=0.2, anisotropy=0.8, rotation=0.1, *, radial=False):
    return parse(TEXT.format(m, anisotropy, rotation, str(radial).lower()), "test/t", "test")


def metallic(data, rotation, tangent):
    """Blender's Metallic BSDF; ``tangent``: the type of a Tangent node, none if empty."""
    material = versions.empty_material("Metallic")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    node, output = nodes.new("ShaderNodeBsdfMetallic"), nodes.new("ShaderNodeOutputMaterial")
    node.distribution, node.fresnel_type = "BECKMANN", "F82"
    values = {"Base Color": (0.9, 0.5, 0.3, 1.0), "Edge Tint": (1.0,) * 4, "Roughness": 0.2**0.5, "Anisotropy": 0.8}
    for key, value in (values | {"Rotation": rotation}).items():
        node.inputs[key].default_value = value
    if tangent:
        source = nodes.new("ShaderNodeTangent")
        source.direction_type = tangent
        links.new(source.outputs[0], node.inputs["Tangent"])
    links.new(node.outputs[0], output.inputs[0])
    return material


@pytest.mark.blender
@pytest.mark.parametrize("rotation", [0.0, 0.1, 0.3])
@pytest.mark.parametrize(("radial", "tangent"), [(False, "UV_MAP"), (True, "")])
def test_anisotropy_rotation_and_tangent_are_those_of_metallic_bsdf(instrument, radial, tangent, rotation):
    """``closure`` is that node, to rounding: by the UV map, and radial as the node is where nothing is linked."""
    with headless.quiet():
        expected = gonio.measure(metallic(instrument.data, rotation, tangent), VIEW, shading_osl=False)
        other = gonio.measure(metallic(instrument.data, rotation + 0.01, tangent), VIEW, shading_osl=False)
        got = gonio.measure_preset(
            preset(rotation=rotation, radial=radial), "nodes", "closure", VIEW, shading_osl=False
        )
    assert np.abs(got - expected).max() < 1e-5 * expected.max()
    assert np.abs(got - other).max() > 1e-2 * expected.max()


@pytest.mark.blender
@pytest.mark.parametrize("estimator", ["fit", "direct"])
def test_a_linked_tangent_is_taken_at_any_length_and_one_of_none_is_as_unlinked(instrument, estimator):
    """Along x as a UV map along x; of no length as the group's own, by UV map or radial."""
    of = preset(rotation=0.0)
    along_x = gonio.Geometry(50.0, resolution=(32, 32), phi_i=70.0)
    with headless.quiet():
        by_uv = gonio.measure_preset(of, "nodes", estimator, along_x, shading_osl=False)
        by_own = gonio.measure_preset(of, "nodes", estimator, VIEW, shading_osl=False)
        radial = gonio.measure_preset(preset(rotation=0.0, radial=True), "nodes", estimator, VIEW, shading_osl=False)
    peak = by_uv.max()
    for tangent in ((1.0, 0.0, 0.0), (1e-3, 0.0, 0.0), (100.0, 0.0, 300.0)):
        assert np.abs(shown(instrument, of, estimator, tangent) - by_uv).max() < 1e-4 * peak
    assert np.abs(shown(instrument, of, estimator, (0.0, 0.0, 0.0)) - by_own).max() < 1e-4 * peak
    around = shown(instrument, preset(rotation=0.0, radial=True), estimator, (0.0, 0.0, 0.0))
    assert np.abs(around - radial).max() < 1e-4 * peak
    assert np.abs(by_uv - by_own).max() > 0.1 * peak


@pytest.mark.blender
@pytest.mark.parametrize("estimator", ["fit", "closure", "corrected", "direct"])
def test_without_anisotropy_it_is_the_isotropic_model(instrument, estimator):
    """In Cycles as in the reference, to what float32 rounds."""
    of = preset(0.3, 0.0, 0.2)
    numbers = {key: of.parameters[key] for key in ("m", "f0")}
    isotropic = replace(of, model="cook_torrance", parameters=numbers)
    with headless.quiet():
        got, expected = (
            gonio.measure_preset(one, "nodes", estimator, VIEW, shading_osl=False) for one in (of, isotropic)
        )
    assert np.abs(got - expected).max() < 1e-5 * expected.max()


@pytest.mark.blender
@pytest.mark.parametrize("identity", ["finished_metals/copper_hair_line", "plastics/vinyl_record"])
def test_exports_have_the_same_two_numbers(blender, identity):
    """As Principled's, which glTF writes as KHR_materials_anisotropy."""
    of = find(identity)
    inputs = principled.describe(build(of, Choice("nodes", "fit")))
    for socket, key in (("Anisotropic", "anisotropy"), ("Anisotropic Rotation", "rotation")):
        assert inputs[socket].value == pytest.approx(of.parameters[key], abs=1e-6)
    assert inputs["Roughness"].value == pytest.approx(of.parameters["m"] ** 0.5, abs=1e-6)
