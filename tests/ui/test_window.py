# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel: registers and leaves nothing behind, applies to the selection, and is explained everywhere."""

import pytest

import vgroove
from vgroove import headless
from vgroove.addon.blender import material

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
    assert made.name.startswith("Copper")
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


def test_everything_in_the_panel_has_a_tooltip(extension):
    """Properties, their choices and the operators say what they do."""
    from vgroove.addon.ui import operators, preferences, properties

    for kind in (properties.VGrooveSettings, preferences.VGroovePreferences):
        for name in kind.__annotations__:
            assert kind.bl_rna.properties[name].description, name
    settings = extension.context.scene.vgroove
    items = [properties.BACKENDS, properties.ESTIMATORS, properties.QUALITIES]
    items += [properties.family_items(settings, None), properties.shown_items(settings, None)]
    assert all(item[2] for of in items for item in of)
    for operator in (*operators.CLASSES, *preferences.CLASSES[:1]):
        family, name = operator.bl_idname.split(".")
        kind = getattr(getattr(extension.ops, family), name).get_rna_type()
        assert kind.description == operator.bl_description
        for one in kind.properties:
            hidden = one.is_hidden or one.identifier == "rna_type" or one.identifier in FILE_SELECTOR
            assert one.description or hidden, (operator, one.identifier)


def test_what_changes_the_file_is_undone(extension):
    """And what does not makes no step to undo."""
    from vgroove.addon.ui import operators

    change = {
        "vgroove.apply",
        "vgroove.update",
        "vgroove.mend",
        "vgroove.reset",
        "vgroove.save_preset",
        "vgroove.import_preset",
    }
    assert {one.bl_idname for one in operators.CLASSES if "UNDO" in one.bl_options} == change


FILE_SELECTOR = {"filepath", "check_existing"}


class Recorder:
    """Stands in for a layout: takes every call, remembers texts and operators, refuses unknown properties."""

    def __init__(self):
        self.texts, self.buttons, self.props = [], [], []

    def prop(self, owner, name, **_):
        assert name in owner.bl_rna.properties
        self.props.append(name)

    def label(self, *, text="", icon="NONE"):
        self.texts.append(text)

    def operator(self, name, *, text="", icon="NONE"):
        self.buttons.append((name, text))
        return type("Properties", (), {})()

    def template_icon_view(self, owner, name, **_):
        assert name in owner.bl_rna.properties

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
        object=extension.context.object,
    )
    with headless.quiet():
        extension.ops.vgroove.apply()
    extension.context.scene.render.engine = "BLENDER_WORKBENCH"
    for kind in panels.CLASSES:
        layout = Recorder()
        kind.draw(SimpleNamespace(layout=layout), context)
        assert layout.texts
        assert layout.buttons


def drawn(extension, kind):
    """What a panel shows."""
    from types import SimpleNamespace

    context = SimpleNamespace(
        scene=extension.context.scene,
        region=SimpleNamespace(width=280),
        preferences=extension.context.preferences,
        object=extension.context.object,
    )
    layout = Recorder()
    kind.draw(SimpleNamespace(layout=layout), context)
    return layout


def test_panels_read_the_scene_once_per_change(extension, monkeypatch):
    """No redraw reads it again, until something is changed, the frame is, or another file is opened."""
    from vgroove.addon.blender import facts
    from vgroove.addon.ui import panels

    read, of = [], facts.of

    def counted(scene, **more):
        read.extend([scene] * (not isinstance(scene, facts.SceneFacts)))
        return of(scene, **more)

    monkeypatch.setattr(facts, "of", counted)

    def reads():
        read.clear()
        for kind in panels.CLASSES:
            drawn(extension, kind)
        return len(read)

    stage = extension.context.scene
    stage.vgroove.estimator = "corrected"
    extension.context.view_layer.update()
    reads()
    assert reads() == 0
    extension.data.objects["Light"].data.energy = 7.0
    extension.context.view_layer.update()
    assert (reads(), reads()) == (1, 0)
    stage.frame_set(2)
    assert (reads(), reads()) == (1, 0)
    with headless.quiet():
        extension.ops.wm.read_homefile(use_factory_startup=True)
    assert (reads(), reads()) == (1, 0)


def test_a_redraw_is_quicker_than_one_walk_over_the_scene(extension):
    """With 1000 objects, 21 lights and 15 materials, however the material is built.

    Redraws that read the scene took four walks and more; what is left depends on the panel's texts alone and takes a
    fifth of a walk. The bound is one: between these by a factor of four either way.
    """
    from statistics import median
    from time import process_time

    from vgroove.addon.blender import lamps
    from vgroove.addon.library import presets
    from vgroove.addon.ui import panels

    stage = extension.context.scene
    copper = presets.find("lecture/copper")
    made = [material.build(copper, material.Choice("nodes", "mirror")).copy() for _ in range(15)]
    mesh = extension.data.meshes.new("Triangle")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    for index in range(1000):
        item = extension.data.objects.new("Triangle", mesh if index >= 15 else mesh.copy())
        if index < 15:
            item.data.materials.append(made[index])
        stage.collection.objects.link(item)
    for index in range(20):
        light = extension.data.lights.new("Light", ("POINT", "SUN", "AREA")[index % 3])
        stage.collection.objects.link(extension.data.objects.new("Light", light))
    extension.context.view_layer.update()

    def seconds(act):
        start = process_time()
        act()
        return process_time() - start

    def redraw():
        for kind in panels.CLASSES:
            drawn(extension, kind)

    for estimator in ("auto", "corrected", "mirror"):
        stage.vgroove.estimator = estimator
        redraw()
        ratios = [seconds(redraw) / seconds(lambda: lamps.of_scene(stage)) for _ in range(7)]
        assert median(ratios) < 1.0, estimator


def test_nothing_watches_after_the_extension_is_off(blender):
    from vgroove.addon.ui import watch

    for _ in range(2):
        vgroove.register()
        assert all(watch.forget in getattr(blender.app.handlers, name) for name in watch.CHANGES)
        vgroove.unregister()
        assert not any(watch.forget in getattr(blender.app.handlers, name) for name in watch.CHANGES)


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


# Choosing


def test_the_search_offers_what_it_finds(extension):
    """In all families, the best first; what is shown is one of the hits, and Apply applies it."""
    from vgroove.addon.ui import properties

    settings = extension.context.scene.vgroove
    assert (settings.family, settings.preset, settings.shown) == ("Metals", "metals/copper", "metals/copper")
    settings.search = "gold SATIN"
    gold, purple = "finished_metals/gold_satin", "finished_metals/purple_gold_aual2_satin"
    assert [preset.id for preset in properties.matching(settings)] == [gold, purple]
    assert [item[0] for item in properties.shown_items(settings, None)] == [gold, purple]
    assert settings.shown == settings.preset == gold
    settings.shown = purple
    settings.search = "purple"
    assert settings.preset == purple  # still a hit
    settings.search = ""
    assert settings.preset != purple  # the family Metals has it not
    settings.preset = "gems/diamond"
    assert settings.shown == "gems/diamond"  # a script's choice stands


def test_another_family_shows_one_of_its_own(extension):
    from vgroove.addon.ui import properties

    settings = extension.context.scene.vgroove
    settings.family = "Gems"
    assert settings.preset.startswith("gems/")
    settings.family = properties.ALL
    assert settings.preset.startswith("gems/")


def test_a_search_without_hits_applies_nothing(extension):
    """It says so, shows no picture, and Apply is refused in words."""
    from vgroove.addon.ui import panels, properties

    settings = extension.context.scene.vgroove
    settings.search = "no such thing"
    assert properties.matching(settings) == []
    told = drawn(extension, panels.VGROOVE_PT_material)
    assert "Nothing found" in " ".join(told.texts)
    assert not extension.ops.vgroove.apply.poll()
    settings.search = "copper"
    assert "12 found" in " ".join(drawn(extension, panels.VGROOVE_PT_material).texts)
    assert extension.ops.vgroove.apply.poll()


def test_what_is_chosen_is_kept_by_name(extension, tmp_path):
    """Through a saved file, whatever presets come or go; one that is not there gives the first."""
    from vgroove.addon.library.presets import all_presets
    from vgroove.addon.ui import properties

    assert len({properties.number(identity) for identity in all_presets()}) == len(all_presets())
    extension.context.scene.vgroove.preset = "gems/diamond"
    with headless.quiet():
        extension.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
        extension.ops.wm.read_factory_settings(use_empty=True)
        extension.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    settings = extension.context.scene.vgroove
    assert settings.shown == settings.preset == "gems/diamond"
    settings.preset = "mine/lost"
    assert settings.shown == properties.chosen_preset(settings).id == "metals/copper"


def test_pictures_are_read_when_they_are_drawn(extension, tmp_path, monkeypatch):
    """Each once, a little later; one that is not there leaves no icon. (Without a window no icon has a number.)"""
    from vgroove.addon.library.presets import find
    from vgroove.addon.ui import thumbnails

    monkeypatch.setattr(thumbnails, "FOLDER", tmp_path)
    (pictures,) = thumbnails._pictures
    assert thumbnails.icon(find("gems/diamond")) == 0
    assert not pictures
    (tmp_path / "gems").mkdir()
    image = extension.data.images.new("Picture", 8, 8)
    image.file_format, image.filepath_raw = "WEBP", str(tmp_path / "gems" / "diamond.webp")
    image.save()
    for _ in range(2):
        thumbnails.icon(find("gems/diamond"))
    assert set(pictures) == {"gems/diamond"}
    assert thumbnails._waiting == ["gems/diamond"]
    assert extension.app.timers.is_registered(thumbnails._read_some)
    assert thumbnails._read_some() is None  # as Blender's timer does, when it has time
    assert not thumbnails._waiting
    assert min(pictures["gems/diamond"].image_size) >= 8
    thumbnails.icon(find("gems/diamond"))
    assert not thumbnails._waiting


# Editing


def test_edited_numbers_are_reset(extension):
    """To those of the preset that the material was built from."""
    from vgroove.addon.ui import operators

    extension.context.scene.vgroove.preset = "metals/gold"
    with headless.quiet():
        extension.ops.vgroove.apply()
    made = operators.ours(extension.context)
    assert set(material.parameter_sockets(made)) == {"m", "n", "k"}
    assert not material.is_edited(made)
    material.parameter_sockets(made)["m"].default_value = 0.4
    assert material.is_edited(made)
    assert extension.ops.vgroove.reset() == {"FINISHED"}
    assert not material.is_edited(made)
    extension.context.object.active_material = None
    with pytest.raises(RuntimeError, match="active material came from this panel"):
        extension.ops.vgroove.reset()


@pytest.fixture
def own_folder(extension, tmp_path, monkeypatch):
    from vgroove.addon.library import presets

    monkeypatch.setenv(presets.USER_FOLDER, str(tmp_path))
    presets.reread()
    yield tmp_path
    presets.reread()


def test_an_edited_material_is_saved_as_a_preset(extension, own_folder):
    """It is chosen at once, says what it was edited from, and never replaces another."""
    from vgroove.addon.library import presets
    from vgroove.addon.ui import operators

    settings = extension.context.scene.vgroove
    settings.preset = "metals/gold"
    with headless.quiet():
        extension.ops.vgroove.apply()
        material.parameter_sockets(operators.ours(extension.context))["m"].default_value = 0.4
        assert extension.ops.vgroove.save_preset(name="Old Gold") == {"FINISHED"}
        assert settings.preset == settings.shown == "mine/old_gold"
        with pytest.raises(RuntimeError, match="give this one another name"):
            extension.ops.vgroove.save_preset(name="Old Gold")
        with pytest.raises(RuntimeError, match="name must be 1 to 60 printable characters"):
            extension.ops.vgroove.save_preset(name=" ")
        assert extension.ops.vgroove.apply() == {"FINISHED"}
    kept = presets.find("mine/old_gold")
    assert kept.m == pytest.approx(0.4)
    assert kept.source["data"].startswith("edited from metals/gold, whose source is: Johnson and Christy 1972")
    assert "metal" in kept.tags
    assert [path.name for path in own_folder.iterdir()] == ["old_gold.toml"]


def test_a_preset_goes_out_to_a_file_and_comes_back(extension, own_folder, tmp_path_factory):
    """Export and Import; a file that is no preset is refused in one line, and nothing is kept of it."""
    from vgroove.addon.library import presets

    settings = extension.context.scene.vgroove
    settings.preset = "car_paints/blue"
    path = tmp_path_factory.mktemp("sent") / "paint.toml"
    with headless.quiet():
        assert extension.ops.vgroove.export_preset(filepath=str(path)) == {"FINISHED"}
        assert extension.ops.vgroove.import_preset(filepath=str(path)) == {"FINISHED"}
        path.write_text("name = 3", encoding="utf-8")
        with pytest.raises(RuntimeError, match="name must be a text, got 3"):
            extension.ops.vgroove.import_preset(filepath=str(path))
        with pytest.raises(RuntimeError, match="cannot be written"):
            extension.ops.vgroove.export_preset(filepath=str(path.parent / "nowhere" / "x.toml"))
    assert settings.preset == "mine/blue_car_paint"
    assert presets.find("mine/blue_car_paint").parameters == presets.find("car_paints/blue").parameters
    assert [found.name for found in own_folder.iterdir()] == ["blue_car_paint.toml"]


def test_a_folder_of_malformed_presets_does_not_keep_the_extension_from_registering(extension, own_folder):
    """The panel says why one is left out."""
    from types import SimpleNamespace

    from vgroove.addon.library import presets
    from vgroove.addon.ui import panels

    for index, text in enumerate(("", "name = 3", "[[[", "\x00")):
        (own_folder / f"bad_{index}.toml").write_text(text, encoding="utf-8")
    presets.reread()
    vgroove.unregister()
    vgroove.register()
    layout = Recorder()
    context = SimpleNamespace(scene=extension.context.scene, region=SimpleNamespace(width=280))
    panels.VGROOVE_PT_material.draw(SimpleNamespace(layout=layout), context)
    assert "Preset skipped:" in " ".join(layout.texts)


def test_the_source_recommends_a_roughness(extension):
    """As Blender's sliders have it: the square roots of the preset's slopes m."""
    from vgroove.addon.library.presets import all_presets
    from vgroove.addon.ui import panels

    preset = next(one for one in all_presets().values() if one.m_range)
    extension.context.scene.vgroove.preset = preset.id
    text = " ".join(drawn(extension, panels.VGROOVE_PT_source).texts)
    low, high = (f"{m**0.5:.2g}" for m in preset.m_range)
    assert f"Recommended roughness: {low} to {high}" in text


def test_a_citation_says_what_and_whence():
    from vgroove.addon.library.presets import find
    from vgroove.addon.ui import operators

    text = operators.citation(find("metals/gold"))
    assert text.startswith("Gold [metals/gold]: Johnson and Christy 1972: P. B. Johnson and R. W. Christy.")
    assert text.endswith("main/Au/nk/Johnson.yml (CC0-1.0).")


# The asset library


def test_the_asset_library_is_registered_by_its_button_alone(extension, tmp_path, monkeypatch):
    """This Blender's, or that of the nearest earlier one; and it goes away again."""
    from vgroove.addon.blender import assets

    libraries = extension.context.preferences.filepaths.asset_libraries
    before = [one.name for one in libraries]
    monkeypatch.setattr(assets, "FOLDER", tmp_path)
    with headless.quiet(), pytest.raises(RuntimeError, match="came without its asset library"):
        extension.ops.vgroove.asset_library(shown=True)
    for version in ("3.6", "4.5", "99.0"):
        (tmp_path / version).mkdir()
        (tmp_path / version / assets.FILE).touch()
    with headless.quiet():
        for _ in range(2):  # once is enough, twice does no harm
            assert extension.ops.vgroove.asset_library(shown=True) == {"FINISHED"}
        assert [one.name for one in libraries] == [*before, "V-Groove"]
        assert libraries[-1].path == str(tmp_path / "4.5")
        assert libraries[-1].import_method == "APPEND"
        for _ in range(2):
            assert extension.ops.vgroove.asset_library(shown=False) == {"FINISHED"}
    assert [one.name for one in libraries] == before


# Materials that change


@pytest.fixture
def rusting(extension):
    """The cube with rusting iron, played by what the panel has."""
    stage = extension.context.scene
    stage.vgroove.preset, stage.vgroove.estimator = "time_varying/rusting_iron", "fit"

    def apply(**settings):
        for name, value in settings.items():
            setattr(stage.vgroove_course, name, value)
        with headless.quiet():
            assert extension.ops.vgroove.apply() == {"FINISHED"}
        return extension.context.object.active_material

    return apply


def slope(extension, made, frame):

    extension.context.scene.frame_set(frame)
    return material.parameter_sockets(made)["m"].default_value


def test_apply_plays_a_preset_that_changes(extension, rusting):
    """By curves, by Age, or not at all where the panel says so."""
    from vgroove.addon.blender import course

    made = rusting(start=10.0, length=100.0)
    assert [slope(extension, made, frame) for frame in (1, 10, 110, 200)] == pytest.approx([0.0645] * 2 + [0.27153] * 2)
    assert course.trajectory_node(rusting(driving="age")) is not None
    assert not material.plays(rusting(play=False))


def test_start_and_length_are_in_seconds_or_frames(extension):
    """At the scene's own frame rate."""
    stage, settings = extension.context.scene, extension.context.scene.vgroove_course
    stage.render.fps, stage.render.fps_base = 30, 1.001
    settings.start_seconds, settings.length_seconds = 1.0, 10.0
    assert settings.start == pytest.approx(30.0 / 1.001)
    assert settings.length == pytest.approx(300.0 / 1.001)
    settings.length = 60.0
    assert settings.length_seconds == pytest.approx(2.002)


def test_courses_are_retimed_reversed_baked_removed_and_added_again(extension, rusting):
    """On every selected object at once."""
    from vgroove.addon.blender import course

    made = rusting(driving="age")
    other = extension.data.objects.new("Other", extension.data.meshes.new("Other"))
    other.data.materials.append(made.copy())
    extension.context.collection.objects.link(other)
    other.select_set(state=True)
    both = [made, other.active_material]
    ops, settings = extension.ops.vgroove, extension.context.scene.vgroove_course
    with headless.quiet():
        assert ops.course_bake() == {"FINISHED"}
        assert not any(course.trajectory_node(one) for one in both)
        settings.start, settings.length = 5.0, 10.0
        assert ops.course_retime() == {"FINISHED"}
        assert [course.span_of(material.curves(one)) for one in both] == [(5.0, 15.0)] * 2
        assert ops.course_reverse() == {"FINISHED"}
    assert [slope(extension, one, 15) for one in both] == pytest.approx([0.0645] * 2)
    with headless.quiet():
        assert ops.course_remove() == {"FINISHED"}
        assert not any(material.plays(one) for one in both)
        assert len(extension.data.actions) == 0
        assert ops.course_add() == {"FINISHED"}
    assert all(course.trajectory_node(one) for one in both)


@pytest.mark.parametrize(
    "operator", ["apply", "course_add", "course_retime", "course_reverse", "course_bake", "course_remove"]
)
def test_each_change_of_a_course_is_one_undo_step(extension, rusting, operator):
    """One Ctrl-Z, and the curves are as before."""

    made = rusting(driving="age" if operator == "course_bake" else "curves", play=operator != "course_add")

    def state():
        one = extension.data.materials[name]
        return material.state_of(one), [group.name for group in extension.data.node_groups], len(extension.data.actions)

    name = made.name
    extension.context.scene.vgroove_course.length = 33.0
    with headless.quiet():
        extension.ops.ed.undo_push(message="before")
        before = state()
        getattr(extension.ops.vgroove, operator)()
        extension.ops.ed.undo_push(message="after")
        assert operator == "apply" or state() != before
        extension.ops.ed.undo()
    assert state() == before


def test_courses_refuse_in_words(extension, rusting):
    """What has none, and a clock that comes from a texture."""
    from vgroove.addon.blender import course

    ops = extension.ops.vgroove
    with pytest.raises(RuntimeError, match="came from this panel and changes over time"):
        ops.course_reverse()
    with pytest.raises(RuntimeError, match="came from a preset that changes over time"):
        ops.course_add()
    made = rusting(driving="age")
    noise = made.node_tree.nodes.new("ShaderNodeTexNoise")
    made.node_tree.links.new(noise.outputs[0], course.trajectory_node(made).inputs["Rate"])
    with headless.quiet(), pytest.raises(RuntimeError, match="come from a texture, which no curve can follow"):
        ops.course_bake()
    assert course.trajectory_node(made) is not None


def test_the_panel_says_how_a_preset_changes(extension, rusting):
    """What changes over what time, how it is known, and how many keys it takes."""
    from types import SimpleNamespace

    from vgroove.addon.ui import course

    stage = extension.context.scene
    context = SimpleNamespace(
        scene=stage, region=SimpleNamespace(width=280), selected_objects=extension.context.selected_objects
    )
    assert course.VGROOVE_PT_course.poll(context)
    rusting(driving="age")
    layout = Recorder()
    course.VGROOVE_PT_course.draw(SimpleNamespace(layout=layout), context)
    text = " ".join(layout.texts)
    for part in ("Rusting Iron (measured) changes over its whole duration", "60 keys"):
        assert part in text
    stage.vgroove.preset = "lecture/copper"
    context.selected_objects = []
    assert not course.VGROOVE_PT_course.poll(context)


@pytest.mark.parametrize("driving", ["curves", "age"])
def test_a_course_that_was_edited_is_saved_with_the_preset(extension, own_folder, rusting, driving):
    """Its keys as they are now; one that was not keeps its laws."""
    from vgroove.addon.blender import course
    from vgroove.addon.library import presets

    made = rusting(driving=driving)
    with headless.quiet():
        extension.ops.vgroove.save_preset(name="As It Was")
    assert presets.find("mine/as_it_was").time == presets.find("time_varying/rusting_iron").time
    if driving == "curves":
        socket = material.parameter_sockets(made)["m"]
        curve = next(c for c in material.curves(made) if c.data_path == socket.path_from_id("default_value"))
        curve.keyframe_points[-1].co.y = 0.66
    else:
        group = course.trajectory_node(made).node_tree
        output = next(node for node in group.nodes if node.bl_idname == "NodeGroupOutput")
        output.inputs["Slope m"].links[0].from_node.inputs["After"].default_value = 0.66
    with headless.quiet():
        extension.ops.vgroove.save_preset(name="Edited")
    edited = presets.find("mine/edited")
    assert edited.at(1.0).m == pytest.approx(0.66)
    for time in (0.0, 0.33, 0.7):
        assert edited.at(time).m == pytest.approx(presets.find("time_varying/rusting_iron").at(time).m, rel=2e-3)
        albedo = presets.find("time_varying/rusting_iron").at(time).parameters["albedo"]
        assert edited.at(time).parameters["albedo"] == pytest.approx(albedo, abs=1e-3)
    assert edited.source["data"].startswith("edited from time_varying/rusting_iron")
