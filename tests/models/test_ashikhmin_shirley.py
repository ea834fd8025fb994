# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin & Shirley's model in Cycles against NumPy, that every row turns red, and Blender's own sense of it."""

from dataclasses import replace

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.lab.check import ashikhmin_shirley as check
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.nodegroups import ashikhmin_lobe, ashikhmin_shirley, osl_script, smith_lobe, versions
from vgroove.nodegroups._tree import Value

from ..rows import check_that_mirror_counts_lights_once, name
from .test_tangents import VIEW

pytestmark = pytest.mark.blender

NODES, _, OSL = SETUPS
PLAN = check.plan()
# All shapes and turns of the formula itself in SVM, and of all others one row each
CHOSEN = [row for row in PLAN if NODES in row.args and ("direct" in row.args or row.args[-1] in {0.3, 0.6})]
CHOSEN += [row for row in PLAN if OSL in row.args and row.args[-1] in {0.3, 0.6}]
ROWS = [pytest.param(row, marks=[] if row in CHOSEN else [pytest.mark.more]) for row in PLAN]


@pytest.mark.parametrize("row", ROWS, ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row of the plan passes, and is red against a reference 1 % brighter or darker."""
    row = row()
    assert row.passed, row.as_json()
    assert not row.is_noisy or row.resolves <= surely_seen(0.01, check.NOISY_ROWS)
    if row.bar < 0.01 or row.is_noisy:
        assert not row.scaled(1.01).passed
        assert not row.scaled(1 / 1.01).passed


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    assert sum(row.func is not check.exact_row for row in PLAN) == check.NOISY_ROWS


def test_mirror_with_lights_counts_each_once(instrument):
    for setup in (NODES, OSL):
        check_that_mirror_counts_lights_once(check.material(0.7, 0.5, 0.1), setup)


# --- mutants ------------------------------------------------------------------------------------------------------


def more(module, output):
    """A group's build with 1 % more of what it puts out."""
    original = module.build

    def build(tree):
        original(tree)
        sink = tree._output.inputs[output]
        tree.connect(Value(tree, sink.links[0].from_socket) * 1.01, sink)

    return build


def mutated(old, new):
    """Shader texts with ``new`` in place of ``old``, which one of them has to have."""
    original = osl_script.source
    return lambda shader, tables=None: original(shader, tables).replace(old, new)


@pytest.mark.once
@pytest.mark.parametrize("roughness", [0.6, 0.3, 0.1])
def test_one_percent_in_the_lobe_turns_direct_red(blender, monkeypatch, roughness):
    """As nodes and in OSL."""
    with monkeypatch.context() as patch:
        patch.setattr(ashikhmin_lobe, "build", more(ashikhmin_lobe, "f cos"))
        assert not check.exact_row("direct", NODES, 0.5, 0, roughness).passed
    monkeypatch.setattr(osl_script, "source", mutated("* power / (8", "* 1.01 * power / (8"))
    assert not check.exact_row("direct", OSL, 0.5, 0, roughness).passed


@pytest.mark.once
def test_one_percent_in_what_is_subtracted_turns_corrected_red(blender, monkeypatch):
    """The Beckmann lobe as a formula, as nodes and in OSL."""
    with monkeypatch.context() as patch:
        patch.setattr(smith_lobe, "build", more(smith_lobe, "f cos"))
        assert not check.exact_row("corrected", NODES, 0.5, 1, 0.3).passed
    monkeypatch.setattr(osl_script, "source", mutated("lacking -= part", "lacking -= 1.01 * part"))
    assert not check.exact_row("corrected", OSL, 0.5, 1, 0.3).passed


@pytest.mark.once
def test_one_percent_in_the_exponent_or_the_weight_turns_mirror_red(blender, monkeypatch):
    """An exponent that is off by 30 %, as the albedo hardly knows it; the weight 1 % larger; in nodes F 1 % larger."""
    for old, new in (("vector h = ashikhmin_facet(n0, T, B, n_u,", "vector h = ashikhmin_facet(n0, T, B, 1.3 * n_u,"),
                     ("* share * reflection(h)", "* 1.01 * share * reflection(h)")):  # fmt: skip
        with monkeypatch.context() as patch:
            patch.setattr(osl_script, "source", mutated(old, new))
            assert not check.furnace_row(OSL, 0.6, 0.1, 0.6).passed
    original = ashikhmin_shirley.reflectance
    monkeypatch.setattr(ashikhmin_shirley, "reflectance", lambda *given: original(*given) * 1.01)
    assert not check.furnace_row(NODES, 0.6, 0.1, 0.6).passed


# --- Blender's own sense --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rotation", [0.0, 0.3])
def test_with_a_flat_f_it_is_cycles_own_glossy_bsdf(instrument, rotation):
    """Roughness, Rotation and Tangent as of that node; Anisotropy by the slopes of Metallic BSDF."""
    of = check.material(0.5, 0.8, rotation, deep=(0.0,) * 3).with_parameters(specular=(1.0, 1.0, 1.0))
    material = versions.empty_material("Glossy")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    node, output, tangent = (
        nodes.new(f"ShaderNode{kind}") for kind in ("BsdfAnisotropic", "OutputMaterial", "Tangent")
    )
    node.distribution, tangent.direction_type = "ASHIKHMIN_SHIRLEY", "UV_MAP"
    values = {"Color": (1.0,) * 4, "Roughness": 0.5, "Anisotropy": (1.0 - 0.9 * 0.8) ** 0.5 - 1.0, "Rotation": rotation}
    for key, value in values.items():
        node.inputs[key].default_value = value
    links.new(tangent.outputs[0], node.inputs["Tangent"])
    links.new(node.outputs[0], output.inputs[0])
    with headless.quiet():
        expected = gonio.measure(material, VIEW, shading_osl=False)
        images = [
            gonio.measure_preset(of, "nodes", one, VIEW, shading_osl=False) for one in ("fit", "closure", "direct")
        ]
    for image in images:
        assert np.abs(image - expected).max() < 3e-5 * expected.max()  # of direct 2e-5, and 6e-6 of the node itself


def test_radial_grooves_go_around_the_axis(instrument):
    """Whatever UV map there is: as the reference turned to the azimuth of each point, not as by the UV map."""
    of = check.material(0.4, 0.9, 0.0)
    radial = replace(of, flags=("radial",))
    with headless.quiet():
        by_uv, around = (gonio.measure_preset(one, "nodes", "fit", VIEW, shading_osl=False) for one in (of, radial))
        exact = gonio.measure_preset(radial, "nodes", "direct", VIEW, shading_osl=False)
    assert np.abs(by_uv - around).max() > 0.1 * around.max()
    lit = VIEW.wo()[..., 2] > 0.5
    assert np.abs(exact - around)[lit].max() < 0.05 * exact.max()
