# SPDX-License-Identifier: GPL-3.0-or-later
"""Apply gives the preset to the selection by the quality that was chosen; buttons fix what the advice names."""

import pytest

from vgroove import headless
from vgroove.addon.blender import material

from .panel import Recorder, drawn

pytestmark = pytest.mark.blender


@pytest.mark.parametrize("backend", ["nodes", "osl"])
@pytest.mark.parametrize("estimator", ["auto", "fit", "closure", "mirror", "direct"])
def test_apply_gives_the_preset_to_selected_objects(extension, backend, estimator):
    """The cube gets it; the unselected camera's scene keeps the rest as it was."""
    stage = extension.context.scene
    stage.vgroove.preset, stage.vgroove.backend, stage.vgroove.estimator = "lecture/copper", backend, estimator
    with headless.quiet():
        assert extension.ops.vgroove.apply() == {"FINISHED"}
    made = extension.context.object.active_material
    assert made.name.startswith("Copper")
    node = next(
        node for node in made.node_tree.nodes if node.bl_idname == "ShaderNodeGroup" and "Base Color" in node.inputs
    )
    assert tuple(node.inputs["Base Color"].default_value)[:3] == pytest.approx((0.95, 0.64, 0.54))


def test_apply_gives_hybrid_the_bound_of_the_panel(extension):
    """In percent there, a share in the node."""
    settings = extension.context.scene.vgroove
    settings.preset, settings.estimator, settings.bound = "plastics/red_plastic", "hybrid", 2.0
    with headless.quiet():
        assert extension.ops.vgroove.apply() == {"FINISHED"}
    nodes = extension.context.object.active_material.node_tree.nodes
    node = next(node for node in nodes if node.bl_idname == "ShaderNodeGroup" and "Bound" in node.inputs)
    assert node.inputs["Bound"].default_value == pytest.approx(0.02)


def test_dispersion_is_a_switch_that_is_off(extension):
    """Shown for what has an Abbe number, usable where Cycles can; applying again changes the material in place."""
    from vgroove.addon.blender import origin
    from vgroove.addon.models.glass import ABBE
    from vgroove.addon.ui import panels
    from vgroove.nodegroups import versions

    settings = extension.context.scene.vgroove
    settings.preset = "glasses/window"
    assert "disperses" not in drawn(extension, panels.VGROOVE_PT_material).props
    settings.preset = "gems/diamond"
    assert "disperses" in drawn(extension, panels.VGROOVE_PT_material).props
    assert "Abbe number: 55.3" in drawn(extension, panels.VGROOVE_PT_source).texts
    assert not settings.disperses
    made = []
    for settings.disperses in (False, True):
        with headless.quiet():
            assert extension.ops.vgroove.apply() == {"FINISHED"}
        made.append(extension.context.object.active_material)
        assert origin.read(made[-1]).disperses is settings.disperses
        groups = [node for node in made[-1].node_tree.nodes if node.bl_idname == "ShaderNodeGroup"]
        assert any(ABBE.label in node.inputs for node in groups) is (settings.disperses and versions.DISPERSES)
    assert made[0] == made[1]


def test_multiple_scattering_is_a_switch_that_is_on(extension):
    """Shown for rough metals outside the Laboratory alone; others go without, whatever it says."""
    from vgroove.addon.blender import origin
    from vgroove.addon.ui import panels

    settings = extension.context.scene.vgroove

    def applied():
        with headless.quiet():
            assert extension.ops.vgroove.apply() == {"FINISHED"}
        return extension.context.object.active_material

    for settings.preset in ("lecture/copper", "metals/copper", "plastics/red_plastic"):
        assert "bounces" not in drawn(extension, panels.VGROOVE_PT_material).props
        assert not origin.read(applied()).bounces
    smooth = applied()
    settings.preset = "finished_metals/copper_sandblasted"
    assert "bounces" in drawn(extension, panels.VGROOVE_PT_material).props
    assert settings.bounces
    made = []
    for settings.bounces in (True, False):
        made.append(applied())
        assert origin.read(made[-1]).bounces is settings.bounces
    assert made[0] == made[1] != smooth


def test_update_adds_it_to_a_metal_that_was_made_rough(extension):
    """By the material's present slope."""
    from vgroove.addon.blender import origin

    stage = extension.context.scene
    stage.vgroove.preset = "metals/copper"
    with headless.quiet():
        extension.ops.vgroove.apply()
        made = extension.context.object.active_material
        assert not origin.read(made).bounces
        material.parameter_sockets(made)["m"].default_value = 0.7
        assert extension.ops.vgroove.update() == {"FINISHED"}
    assert origin.read(made).bounces


def test_apply_is_one_undo_step(extension):
    """One Ctrl-Z gives the cube its old material back."""
    stage = extension.context.scene
    old = extension.context.object.active_material.name
    stage.vgroove.preset = "lecture/copper"
    with headless.quiet():
        extension.ops.ed.undo_push(message="before")
        extension.ops.vgroove.apply()
        extension.ops.ed.undo_push(message="after")  # the window does this for operators that it runs
        extension.ops.ed.undo()
    assert extension.data.objects["Cube"].active_material.name == old


def test_apply_without_a_selection_says_so(extension):
    for item in extension.context.selected_objects:
        item.select_set(state=False)
    with pytest.raises(RuntimeError, match="Select the objects"):
        extension.ops.vgroove.apply()


def spoiled(extension):
    """The default scene with Workbench, for Reference in OSL: much to fix."""
    stage = extension.context.scene
    stage.vgroove.backend, stage.vgroove.estimator = "osl", "mirror"
    stage.render.engine = "BLENDER_WORKBENCH"
    return stage


def test_advice_is_fixed_by_its_button(extension):
    """Every problem of the default scene that has a button is gone after it was pressed."""
    from vgroove.addon.ui import operators

    stage = spoiled(extension)
    found = operators.current_problems(stage)
    assert {"engine", "osl", "filter", "clamp"} <= {problem.key for problem in found}
    with headless.quiet():
        for problem in found:
            if problem.fix:
                assert extension.ops.vgroove.mend(key=problem.key) == {"FINISHED"}
    assert [problem for problem in operators.current_problems(stage) if problem.fix] == []


def test_fix_all_leaves_out_what_has_side_effects(extension):
    """A light keeps its size, the scene its clamps, filter, noise threshold and caustics; each has its own button."""
    from vgroove.addon.ui import operators

    stage, light = spoiled(extension), extension.data.objects["Light"].data
    stage.cycles.caustics_reflective, stage.cycles.sample_clamp_direct = False, 1.0
    light.cycles.use_multiple_importance_sampling = False

    def kept():
        names = ("use_adaptive_sampling", "blur_glossy", "sample_clamp_indirect", "sample_clamp_direct")
        return [light.shadow_soft_size, stage.cycles.caustics_reflective, *(getattr(stage.cycles, n) for n in names)]

    before = kept()
    with headless.quiet():
        assert extension.ops.vgroove.mend(key="") == {"FINISHED"}
        assert kept() == before
        assert extension.ops.vgroove.mend(key="") == {"CANCELLED"}
    assert (stage.render.engine, stage.cycles.shading_system) == ("CYCLES", True)
    assert light.cycles.use_multiple_importance_sampling
    left = [problem for problem in operators.current_problems(stage) if problem.fix]
    assert {"small", "adaptive", "filter", "clamp", "caustics", "denoiser"} == {problem.key for problem in left}
    assert all(problem.costs for problem in left)


def test_fix_all_lists_what_it_will_change_and_what_it_leaves(extension):
    from types import SimpleNamespace

    from vgroove.addon.ui import operators

    stage = spoiled(extension)
    asked = []
    manager = SimpleNamespace(invoke_props_dialog=lambda operator, **_: asked.append(operator) or {"RUNNING_MODAL"})
    button = SimpleNamespace(key="", layout=Recorder())
    context = SimpleNamespace(scene=stage, window_manager=manager)
    assert operators.VGROOVE_OT_mend.invoke(button, context, None) == {"RUNNING_MODAL"}
    assert asked == [button]
    assert stage.render.engine == "BLENDER_WORKBENCH"  # nothing is changed before it is confirmed
    operators.VGROOVE_OT_mend.draw(button, context)
    texts = button.layout.texts
    left = texts.index("Not included, use their own buttons:")
    assert {"Use Cycles", "Switch OSL On"} <= set(texts[:left])
    assert "Set Filter Glossy to 0. Side effect: more fireflies" in texts[left:]


# Quality


@pytest.mark.parametrize(
    ("quality", "estimator"), [("standard", "auto"), ("exact", "corrected"), ("reference", "mirror")]
)
def test_each_quality_is_kept_as_an_estimator(extension, quality, estimator):
    """So that files of earlier versions keep their meaning."""
    settings = extension.context.scene.vgroove
    settings.quality = quality
    assert (settings.estimator, settings.quality) == (estimator, quality)


@pytest.mark.parametrize("estimator", ["fit", "closure", "hybrid", "direct"])
def test_a_file_that_chose_another_estimator_keeps_it(extension, tmp_path, estimator):
    """The panel shows it by name then; else names are shown only if the preferences say so."""
    from vgroove.addon.ui import operators, panels

    settings = extension.context.scene.vgroove
    assert "estimator" not in drawn(extension, panels.VGROOVE_PT_material).props
    settings.estimator = estimator
    with headless.quiet():
        extension.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
        extension.ops.wm.read_factory_settings(use_empty=True)
        extension.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    shown = extension.context.scene
    assert operators.chosen_estimator(shown) == shown.vgroove.estimator == estimator
    props = drawn(extension, panels.VGROOVE_PT_material).props
    assert "estimator" in props
    assert "quality" not in props


def test_the_six_names_are_behind_a_preference(extension, monkeypatch):
    from types import SimpleNamespace

    from vgroove.addon.ui import memory, panels

    for shown in (False, True):
        kept = SimpleNamespace(show_estimators=shown, favourites="", recent="")
        monkeypatch.setattr(memory, "preferences", lambda kept=kept: kept)
        props = drawn(extension, panels.VGROOVE_PT_material).props
        assert ("estimator" in props, "quality" in props) == (shown, not shown)


@pytest.mark.parametrize(
    ("preset", "quality", "expected"),
    [
        ("glasses/frosted_glass", "exact", "closure"),
        ("glasses/fused_silica", "exact", "mirror"),
        ("glasses/frosted_glass", "reference", "mirror"),
    ],
)
def test_a_model_that_lacks_a_quality_gets_standard_and_the_panel_says_so(extension, preset, quality, expected):
    from vgroove.addon.ui import operators, panels

    stage = extension.context.scene
    stage.vgroove.preset, stage.vgroove.quality = preset, quality
    picked = operators.pick(stage)
    assert picked.estimator == expected
    said = "has no Exact Lights; Standard is used" in " ".join(drawn(extension, panels.VGROOVE_PT_material).texts)
    assert said == (quality == "exact")
    with headless.quiet():
        assert extension.ops.vgroove.apply() == {"FINISHED"}
    assert material.origin_of(extension.context.object.active_material).estimator == expected
