# SPDX-License-Identifier: GPL-3.0-or-later
"""The universal material shows what the material as built shows, with far more in it; its cells say so in numbers."""

import json
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import material
from vgroove.addon.blender.course import Play
from vgroove.addon.choose import explain
from vgroove.addon.library import presets
from vgroove.addon.models import parameter
from vgroove.lab.bench import any_fresnel, left_out, record, universal, universal_data
from vgroove.lab.bench.cells import LeftOut, OmittedPart
from vgroove.nodegroups import cook_torrance_closure, fresnel

pytestmark = pytest.mark.blender
SIZE, SAMPLES = 16, 64
BACKEND = left_out._backend()  # that of a report: nodes of the universal material do not fit in 4.5


def compared(preset, scene, backend, estimator="auto", changes=(dict,), samples=SAMPLES, size=SIZE):
    """The picture of the material as built against those of the universal one, of data that ``changes`` alter."""
    with headless.quiet():
        shown = left_out.stage(scene, size)
        shown.cycles.shading_system = backend == "osl"
        play = Play("age", 1.0, left_out.LENGTH) if preset.time else None
        choice = replace(explain.chosen(preset, shown, backend, estimator)[0], play=play)
        data = universal_data.data_of(preset, (left_out.FRAME - 1.0) / left_out.LENGTH, play)
        built, _ = left_out._render(shown, material.build(preset, choice), {}, samples)
        made, found = universal.build(choice), []
        for change in changes:
            left_out._ball(shown).active_material = None
            found.append(left_out._render(shown, made, change(data), samples)[0])
    assert built.mean() > 1e-3
    return [left_out._compared(built, one, samples, independent=left_out._redraws(preset, choice)) for one in found]


@pytest.mark.parametrize(
    ("name", "scene", "backend", "estimator"),
    [
        ("plastics/abs_plastic", "lamps", BACKEND, "auto"),
        ("glasses/frosted_glass", "environment", BACKEND, "auto"),
        ("car_paints/blue", "softbox", BACKEND, "auto"),
        ("metals/copper", "environment", "osl", "closure"),
        ("time_varying/rusting_iron", "softbox", BACKEND, "auto"),
    ],
)
def test_universal_material_shows_the_same_picture(blender, name, scene, backend, estimator):
    """Of the same seed: what the material as built does without does not matter."""
    (found,) = compared(presets.find(name), scene, backend, estimator)
    assert found["same"], found


@pytest.mark.once
@pytest.mark.parametrize("samples", sorted(left_out.SAMPLES.values()))
def test_a_universal_material_that_is_off_by_a_hundredth_is_seen(blender, samples):
    """The comparison is finer than 1 % of a weight, and a kind of Fresnel term that is not the preset's is seen."""

    def dimmer(data):
        return data | {f"vgroove s {end}": 0.99 for end in ("before", "after")}

    def other(data):
        return data | {"vgroove fresnel": 0.0}  # Schlick's, whose F0 a conductor has not

    changes = (dict, dimmer, other)
    exact, *wrong = compared(
        presets.find("metals/copper"), "environment", BACKEND, "mirror", changes, samples, left_out.SIZE
    )
    assert exact["same"], exact
    assert not any(one["same"] for one in wrong), wrong


def test_kinds_of_shaders_come_from_the_data(blender):
    """Also beside the inputs for lamps, which stand in panels of their own."""
    made = universal.build(material.Choice("osl", "mirror"))
    (group,) = (node.node_tree for node in made.node_tree.nodes if node.label == universal.NAME)
    parts = [node.node_tree for node in group.nodes if node.bl_idname == "ShaderNodeGroup"]
    specular = next(part for part in parts if part.name.startswith("VGroove Universal Cook-Torrance"))
    scripts = [node for node in specular.nodes if node.bl_idname == "ShaderNodeScript"]
    assert len(scripts) == 9  # a mirror and eight lamps
    for script in scripts:
        (link,) = script.inputs["kind" if "kind" in script.inputs else "Fresnel"].links
        assert link.from_socket.name == "kind"


def test_what_is_put_back_does_nothing_and_is_there(blender):
    """Each thing that was left out adds nodes and leaves the picture as it is."""
    preset = presets.find("lecture/copper")
    with headless.quiet():
        shown = left_out.stage("environment", SIZE)
        shown.cycles.shading_system = BACKEND == "osl"
        account = explain.explain(preset, shown, BACKEND)
        found, named = left_out._lines(shown, preset, account), left_out._lines(shown, preset, account, most=0)
    assert [line.what.partition(":")[0] for line in found] == [
        "closure beside it", "Fresnel terms", "time", "diffuse part", "transmission", "random numbers", "lamp terms"
    ]  # fmt: skip
    assert named == tuple(OmittedPart(what=line.what, why=line.why) for line in found)
    assert all(line.same for line in found), found
    assert all(line.nodes > 0 for line in found[1:]), found
    assert found[0].nodes == 0  # Cycles drops what only EEVEE shows


def test_switches_are_not_folded(blender):
    """They are read from the object as it is rendered: one material, two presets, two pictures."""
    with headless.quiet():
        shown = left_out.stage("environment", SIZE)
        made = universal.build(material.Choice("nodes", "closure"))
        found = []
        for name in ("metals/copper", "diffuse/clay"):
            left_out._ball(shown).active_material = None
            found.append(left_out._render(shown, made, universal_data.data_of(presets.find(name)), SAMPLES)[0])
    assert left_out._compared(*found, SAMPLES)["difference"] > 0.1


def test_no_kind_of_fresnel_term_stays_behind(blender):
    """What the builders of the universal material add for themselves is gone after it, also where one fails."""
    before, lobe = dict(fresnel.KINDS), cook_torrance_closure.lobe
    with suppress(OSError), any_fresnel.any_kind(osl=False):
        assert set(fresnel.KINDS) - set(before) == {any_fresnel.ANY}
        raise OSError
    assert before == fresnel.KINDS
    assert cook_torrance_closure.lobe is lobe


def test_instructions_are_those_of_the_bytecode(blender):
    """One for each indented line of code, and none for symbols."""
    text = (
        "OpenShadingLanguage 1.00\nshader a\nparam\tfloat\tx\nconst\tint\tc\t1\n"
        "code x\n\tassign\tx c\t%filename\ncode ___main___\n\tadd\ty x c\n\tmul\ty y x\n\tend\n"
    )
    assert explain._instructions(text) == 4
    made = material.build(presets.find("lecture/copper"), material.Choice("osl", "mirror"))
    size = explain.size_of(made)
    # the script, the output, five that give the seed, three that hold inputs to their ranges, and one that squares m's
    assert size.nodes == 11
    assert 100 < size.instructions < 2000


@pytest.mark.parametrize("name", sorted(left_out.CASES))
def test_data_hold_every_parameter(name):
    """As floats or triples, for each parameter that a preset has; what it does not have is neutral."""
    preset = presets.find(left_out.CASES[name])
    data, nothing = universal_data.data_of(preset), universal_data.data_of(None)
    assert data.keys() == nothing.keys()
    for key, value in preset.parameters.items():
        known = key.removesuffix("_1")
        if known == "abbe":
            continue  # that material spreads no colours
        if f"vgroove {known}" in data:
            np.testing.assert_array_equal(data[f"vgroove {known}"], value)
        else:
            np.testing.assert_array_equal(data[f"vgroove {known} after"], parameter(key).scale.to_input(value))


def test_cells_are_the_same_in_each_run():
    assert left_out.names(quick=False) == list(left_out.CASES)
    assert set(left_out.names(quick=True)) < set(left_out.CASES)


def test_a_cell_is_what_json_can_hold(blender, monkeypatch):
    """Every number that the page needs, of a setup in small."""
    monkeypatch.setattr(left_out, "SIZE", 8)
    monkeypatch.setattr(left_out, "SAMPLES", {"nodes": 2})
    found = left_out.setup("glass", presets.find("glasses/frosted_glass"), "lamps", "nodes", 1)
    kept = json.loads(json.dumps(record.CODEC.unstructure(found), allow_nan=False))
    assert record.CODEC.structure(kept, LeftOut).nodes == found.nodes
    assert found.nodes[1] > 10 * found.nodes[0]
    assert found.same


def test_explain_has_the_numbers_as_json():
    """Lines and counts, of the material as built and of the universal one."""
    from typer.testing import CliRunner

    from vgroove import cli

    done = CliRunner().invoke(cli.app, ["explain", "copper", "--estimator", "closure", "--backend", "osl", "--json"])
    assert done.exit_code == 0
    found = json.loads(done.stdout.splitlines()[-1])
    assert {line["what"] for line in found["lines"] if not line["kept"]} >= {"time", "transmission"}
    size = found["size"]
    for what in ("nodes", "instructions"):
        assert size["universal"][what] > 2 * size["built"][what] > 0


def test_explain_says_what_the_universal_material_cannot_do(blender, monkeypatch):
    """Absorption; more lamps than it has terms for; and to be built of nodes where SVM has no room."""
    from vgroove import cli

    for room in (True, False):
        monkeypatch.setattr(universal, "fits", lambda room=room: room)
        nodes, native, osl = (
            cli.explain.universal_caption(material.Choice(*of))
            for of in (("nodes", "corrected"), ("nodes", "closure"), ("osl", "corrected"))
        )
        assert all("except absorption" in said for said in (nodes, native, osl))
        assert "terms for 1 light" in nodes
        assert "lights" not in native
        assert "terms for 8 lights" in osl
        assert ["does not fit in this Blender" in said for said in (nodes, native, osl)] == [
            not room, not room, False
        ]  # fmt: skip
