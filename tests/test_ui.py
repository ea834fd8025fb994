# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel: registers and leaves nothing behind, applies to the selection, and is explained everywhere."""

import pytest

import vgroove
from vgroove.addon import headless

pytestmark = pytest.mark.blender


@pytest.fixture
def extension(blender):
    """The extension switched on in Blender's default scene, with the cube selected."""
    with headless.quiet():
        blender.ops.wm.read_factory_settings()
    vgroove.register()
    yield blender
    vgroove.unregister()


def ours(bpy):
    return sorted(name for name in dir(bpy.types) if name.lower().startswith("vgroove"))


def test_registering_and_unregistering_leaves_nothing_behind(blender):
    """Twice over, classes and the scene's property come and go."""
    before = ours(blender)
    for _ in range(2):
        vgroove.register()
        assert hasattr(blender.types.Scene, "vgroove")
        vgroove.unregister()
        assert not hasattr(blender.types.Scene, "vgroove")
        assert ours(blender) == before


def test_a_failure_half_way_leaves_nothing_behind(blender, monkeypatch):
    """If one class cannot be registered, those before it are taken back."""
    from vgroove.addon.ui import panels

    original = blender.utils.register_class

    def register_class(kind):
        if kind is panels.CLASSES[-1]:
            message = "no"
            raise RuntimeError(message)
        original(kind)

    monkeypatch.setattr(blender.utils, "register_class", register_class)
    before = ours(blender)
    with pytest.raises(RuntimeError, match="no"):
        vgroove.register()
    assert ours(blender) == before
    assert not hasattr(blender.types.Scene, "vgroove")


@pytest.mark.parametrize("backend", ["nodes", "osl"])
@pytest.mark.parametrize("estimator", ["auto", "fit", "closure", "mirror", "direct"])
def test_apply_gives_the_preset_to_selected_objects(extension, backend, estimator):
    """The cube gets it; the unselected camera's scene keeps the rest as it was."""
    stage = extension.context.scene
    stage.vgroove.preset, stage.vgroove.backend, stage.vgroove.estimator = "lecture/copper", backend, estimator
    with headless.quiet():
        assert extension.ops.vgroove.apply() == {"FINISHED"}
    made = extension.context.object.active_material
    assert made.name.startswith("Copper (")
    node = next(node for node in made.node_tree.nodes if node.bl_idname == "ShaderNodeGroup" and "F0" in node.inputs)
    assert tuple(node.inputs["F0"].default_value)[:3] == pytest.approx((0.95, 0.64, 0.54))


def test_apply_gives_hybrid_the_bound_of_the_panel(extension):
    """In percent there, a share in the node."""
    settings = extension.context.scene.vgroove
    settings.preset, settings.estimator, settings.bound = "plastics/red_plastic", "hybrid", 2.0
    with headless.quiet():
        assert extension.ops.vgroove.apply() == {"FINISHED"}
    nodes = extension.context.object.active_material.node_tree.nodes
    node = next(node for node in nodes if node.bl_idname == "ShaderNodeGroup" and "Bound" in node.inputs)
    assert node.inputs["Bound"].default_value == pytest.approx(0.02)


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


def test_advice_is_mended_by_its_button(extension):
    """Every problem of the default scene that has a button is gone after it was pressed."""
    from vgroove.addon.ui import operators

    stage = extension.context.scene
    stage.vgroove.backend, stage.vgroove.estimator = "osl", "mirror"
    stage.render.engine = "BLENDER_WORKBENCH"
    found = operators.current_problems(stage)
    assert {"engine", "osl", "filter", "clamp"} <= {problem.key for problem in found}
    with headless.quiet():
        for problem in found[:2]:
            assert extension.ops.vgroove.mend(key=problem.key) == {"FINISHED"}
        assert extension.ops.vgroove.mend(key="") == {"FINISHED"}  # all that are left
        assert extension.ops.vgroove.mend(key="") == {"CANCELLED"}
    assert [problem for problem in operators.current_problems(stage) if problem.mend] == []


def test_everything_in_the_panel_has_a_tooltip(extension):
    """Properties, their choices and the operators say what they do."""
    from vgroove.addon.ui import operators, preferences, properties

    for kind in (properties.VGrooveSettings, preferences.VGroovePreferences):
        for name in kind.__annotations__:
            assert kind.bl_rna.properties[name].description, name
    for items in (properties.BACKENDS, properties.ESTIMATORS, properties.preset_items(None, None)):
        assert all(item[2] for item in items)
    for operator, call in zip(
        operators.CLASSES, (extension.ops.vgroove.apply, extension.ops.vgroove.mend), strict=True
    ):
        assert call.get_rna_type().description == operator.bl_description
        assert {"REGISTER", "UNDO"} <= operator.bl_options


class Recorder:
    """Stands in for a layout: takes every call, remembers texts and operators, refuses unknown properties."""

    def __init__(self):
        self.texts, self.buttons = [], []

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties

    def label(self, *, text="", icon="NONE"):
        self.texts.append(text)

    def operator(self, name, *, text="", icon="NONE"):
        self.buttons.append((name, text))
        return type("Properties", (), {})()

    def column(self, **_):
        return self

    row = box = split = column


def test_the_panels_draw(extension):
    """Both panels draw with the choices, the source and the advice."""
    from types import SimpleNamespace

    from vgroove.addon.ui import panels

    context = SimpleNamespace(
        scene=extension.context.scene,
        region=SimpleNamespace(width=280),
        preferences=extension.context.preferences,
    )
    extension.context.scene.render.engine = "BLENDER_WORKBENCH"
    for kind in panels.CLASSES:
        layout = Recorder()
        kind.draw(SimpleNamespace(layout=layout), context)
        assert layout.texts
        assert layout.buttons
