# SPDX-License-Identifier: GPL-3.0-or-later
"""Steps of an artist that hypothesis chooses: no exception, no invalid driver, nothing left behind, and materials that
equal new ones and render like them."""

import tempfile
from collections import Counter
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule, run_state_machine_as_test

import vgroove
from vgroove import headless, nodegroups
from vgroove.addon.blender import gonio, material, origin, rebuild, roles
from vgroove.addon.library import presets
from vgroove.headless import scene
from vgroove.nodegroups import trajectory

pytestmark = pytest.mark.blender

RUNS, STEPS = 11, 50  # hypothesis begins with a run that is as simple as can be
SIZE, SAMPLES, RENDERED = (
    16,
    2,
    3,
)  # pixels a side, samples per pixel, and at most so many materials at the end of a run
AWAY = 1000.0  # metres to the stage on which materials are rendered, out of sight of what the artist made
PRESETS = ("lecture/copper", "plastics/red_plastic", "glasses/bk7_crown_glass", "time_varying/yellowing_paper")
ESTIMATORS = ("closure", "mirror", "direct", "auto", "hybrid")  # others take the same ways through the builder
KINDS = ("SUN", "POINT", "SPOT", "AREA")
CHOICES = st.randoms(use_true_random=False)


class Artist:
    """Takes steps in Blender's default scene; ``log`` tells them when a test fails.

    random: what a step leaves open is chosen by it; each step brings its own, so that hypothesis can shorten a failure.
    """

    def __init__(self, folder):
        self.bpy, self.random, self.folder, self.log, self.applied = bpy, None, folder, [], set()

    # What there is

    @property
    def scene(self):
        return self.bpy.context.scene

    def meshes(self):
        return [item for item in self.scene.objects if item.type == "MESH"]

    def lights(self):
        return [item for item in self.scene.objects if item.type == "LIGHT" and item.is_editable]

    def ours(self):
        return [one for one in self.bpy.data.materials if one.library is None and material.is_ours(one)]

    def operator(self, name, **settings):
        """Press a button; what it refuses it must refuse in words."""
        try:
            getattr(self.bpy.ops.vgroove, name)(**settings)
        except RuntimeError as error:
            if "Traceback" in str(error):
                raise
            self.log.append(f"  refused: {str(error).strip().splitlines()[-1]}")

    # Steps

    def select(self):
        item = self.random.choice(self.meshes())
        for other in self.bpy.context.selected_objects:
            other.select_set(state=False)
        for chosen in {item, self.random.choice([*self.meshes(), *self.lights()])}:
            chosen.select_set(state=True)
        self.bpy.context.view_layer.objects.active = item

    def apply(self):
        settings, course = self.scene.vgroove, self.scene.vgroove_course
        settings.preset, settings.estimator = self.random.choice(PRESETS), self.random.choice(ESTIMATORS)
        self.applied.add(settings.estimator)
        settings.backend = "osl" if self.random.random() < 0.1 else "nodes"
        course.play, course.driving = self.random.random() < 0.7, self.random.choice(("curves", "age"))
        self.operator("apply")

    def quality(self):
        self.scene.vgroove.estimator = self.random.choice(ESTIMATORS)
        self.operator(self.random.choice(("update", "apply")))

    def press(self):
        names = ("reset", "mend", "course_add", "course_retime", "course_reverse", "course_bake", "course_remove")
        self.operator(self.random.choice(names))

    def edit(self):
        for made in self.random.sample(self.ours(), min(1, len(self.ours()))):
            for socket in material.parameter_sockets(made).values():
                if socket.type == "VALUE":
                    socket.default_value = self.random.uniform(0.1, 1.0)

    def texture(self):
        for made in self.random.sample(self.ours(), min(1, len(self.ours()))):
            sockets = list(material.parameter_sockets(made).values())
            if sockets:
                noise = made.node_tree.nodes.new("ShaderNodeTexNoise")
                made.node_tree.links.new(noise.outputs[0], self.random.choice(sockets))

    def mix(self):
        for made in self.random.sample(self.ours(), min(1, len(self.ours()))):
            output, node = roles.node(made, roles.OUTPUT), roles.node(made, roles.MODEL)
            if output and node:
                mixed = made.node_tree.nodes.new("ShaderNodeMixShader")
                made.node_tree.links.new(node.outputs[0], mixed.inputs[1])
                made.node_tree.links.new(mixed.outputs[0], output.inputs["Surface"])

    def key(self):
        for made in self.random.sample(self.ours(), min(1, len(self.ours()))):
            for socket in list(material.parameter_sockets(made).values())[:1]:
                socket.keyframe_insert("default_value", frame=self.random.randint(1, 100))

    def take_away(self):
        for made in self.random.sample(self.ours(), min(1, len(self.ours()))):
            found = [node for node in made.node_tree.nodes if node.get(roles.KEY)]
            if found:
                made.node_tree.nodes.remove(self.random.choice(found))

    def duplicate(self):
        item = self.random.choice(self.meshes()).copy()
        if self.random.random() < 0.5:
            item.data = item.data.copy()
        self.scene.collection.objects.link(item)

    def add_light(self):
        data = self.bpy.data.lights.new("Lamp", self.random.choice(KINDS))
        if data.type in {"POINT", "SPOT"}:
            data.shadow_soft_size = self.random.choice((0.0, 0.1))
        self.scene.collection.objects.link(self.bpy.data.objects.new("Lamp", data))

    def rename_light(self):
        for item in self.lights()[:1]:
            item.name = f"Light {self.random.randint(0, 99)}"

    def retype_light(self):
        for item in self.lights()[:1]:
            item.data.type = self.random.choice(KINDS)

    def delete_light(self):
        for item in self.lights()[:1]:
            self.bpy.data.objects.remove(item)

    def undo(self):
        self._history("undo")

    def redo(self):
        self._history("redo")

    def _history(self, name):
        operator = getattr(self.bpy.ops.ed, name)
        if operator.poll():
            operator()

    def reload(self):
        path = str(self.folder / "steps.blend")
        self.bpy.ops.wm.save_as_mainfile(filepath=path)
        self.bpy.ops.wm.open_mainfile(filepath=path)

    def append(self):
        self._take(link=False)

    def override(self):
        for item in self._take(link=True):
            if item.type == "MESH":
                if item not in self.scene.collection.objects[:]:  # 5.3 overrides what is in use alone
                    self.scene.collection.objects.link(item)
                self.scene.collection.objects.link(item.override_create())

    def _take(self, *, link):
        """Objects of the file saved last, appended or linked."""
        path = self.folder / "library.blend"
        if not path.exists():
            self.bpy.data.libraries.write(str(path), {*self.meshes()[:1]})
        if self.bpy.data.filepath == str(path):
            return []
        with self.bpy.data.libraries.load(str(path), link=link) as (there, wanted):
            wanted.objects = there.objects[:1]
        for item in wanted.objects:
            if item.name not in self.scene.collection.objects:
                self.scene.collection.objects.link(item)
        return wanted.objects

    # What holds

    def step(self, name, chosen_by):
        self.random = chosen_by
        self.log.append(name)
        before = self.orphans()
        getattr(self, name)()
        if name in {"apply", "quality", "press"}:
            assert self.orphans() <= before, self.log
        if name not in {"undo", "redo"}:
            self.bpy.ops.ed.undo_push(message=name)
        self.check()

    def check(self):
        """No invalid driver, and no node whose group is gone."""
        for made in self.ours():
            data = made.node_tree.animation_data
            assert all(curve.data_path and curve.is_valid for curve in (data.drivers if data else ())), self.log
            assert all(node.node_tree for node in roles.nodes(made, roles.MODEL)), self.log

    def orphans(self):
        """Actions and courses that nothing uses; materials and shared groups without users Blender drops by itself."""
        groups = [one for one in self.bpy.data.node_groups if one.name.startswith(trajectory.NAME)]
        return {one.name for one in (*self.bpy.data.actions, *groups) if not one.users}

    def compare(self):
        """Each material, once updated, equals a new one of its preset and numbers, except for what the artist did.

        The first few of different kinds that the artist left as they were built also render like the new ones.
        """
        rendered = set()
        for made in self.ours():
            if material.locked(made):
                continue
            rebuild.reset(made, self.scene)
            rebuild.rebuild(made, self.scene)
            record = origin.read(made)
            lamps = material.lamps_to_bind(self.scene, record.estimator, record.preset.model)
            choice = material.Choice(
                record.backend, record.estimator, lamps, record.shadows, record.bound, record.play
            )  # fmt: skip
            new = material.build(record.preset, choice, self.bpy.data.materials.new("New"))
            nodes = [roles.node(one, roles.MODEL) for one in (made, new)]
            assert nodes[0].node_tree == nodes[1].node_tree, self.log
            sockets = [material.parameter_sockets(one) for one in (made, new)]
            for name, socket in sockets[1].items():
                free = not (sockets[0].get(name, socket).is_linked or socket.is_linked or material.curves(made))
                if name in sockets[0] and free:
                    values = [_plain(of[name].default_value) for of in sockets]
                    assert values[0] == pytest.approx(values[1]), (self.log, made.name, name)
            assert len(roles.nodes(made, roles.LIGHT)) == len(lamps), self.log
            settings = [(one.cycles.use_bump_map_correction, one.cycles.emission_sampling) for one in (made, new)]
            assert settings[0] == settings[1], self.log
            kind = (record.preset.id, record.estimator, record.backend)
            if not _is_changed(made, new):
                assert _links(made) == _links(new), (self.log, made.name)
                if len(rendered) < RENDERED and kind not in rendered:
                    rendered.add(kind)
                    self.render_alike(made, new)
            self.bpy.data.materials.remove(new)
        return rendered

    def render_alike(self, made, new):
        with probe(self.scene) as render:
            got, wanted = render(made), render(new)
        assert np.isfinite(got).all(), (self.log, made.name)
        # The same nodes, numbers and seed: what a number's last digit does to a float32 render, and no more.
        np.testing.assert_allclose(got, wanted, rtol=1e-4, atol=1e-4 * wanted.max(), err_msg=str((self.log, made.name)))


@contextmanager
def probe(shown):
    """A function that renders a material on a ball far from the artist's objects, by the artist's lights."""
    shown.render.engine, shown.cycles.samples, shown.cycles.seed = "CYCLES", SAMPLES, 0
    shown.cycles.use_denoising = shown.cycles.use_adaptive_sampling = False
    shown.render.resolution_x = shown.render.resolution_y = SIZE
    shown.render.resolution_percentage = 100
    shown.render.image_settings.file_format, shown.render.image_settings.color_depth = "OPEN_EXR", "32"
    camera = bpy.data.objects.new("Probe", bpy.data.cameras.new("Probe"))
    ball = bpy.data.objects.new("Probe", scene.ball_mesh(16, 8))
    ball.location, camera.location = (0.0, 0.0, -AWAY), (0.0, 0.0, 4.0 - AWAY)
    camera.data.lens = 80.0
    for item in (camera, ball):
        shown.collection.objects.link(item)
    ball.data.materials.append(None)
    shown.camera = camera

    def render(made):
        ball.data.materials[0] = made
        shown.cycles.shading_system = origin.read(made).backend == "osl"
        return gonio.rendered(shown)

    try:
        yield render
    finally:
        for item in (camera, ball):
            bpy.data.objects.remove(item)


def _is_changed(made, new):
    """Whether an artist added nodes, took some away, or set keys: all of that is kept."""
    return _roles(made) != _roles(new) or bool(material.curves(made))


def _roles(made):
    """Of each node but frames; None for an artist's own."""
    return Counter(node.get(roles.KEY) for node in made.node_tree.nodes if node.bl_idname != "NodeFrame")


def _links(made):
    return sorted(
        (one.from_node.bl_idname, one.from_socket.name, one.to_node.bl_idname, one.to_socket.name)
        for one in made.node_tree.links
    )


def _plain(value):
    return list(value) if hasattr(value, "__len__") else value


OFTEN = ("edit", "select", "apply", "quality", "press", "undo")  # half of all steps
RARE = (
    "texture", "mix", "key", "take_away", "duplicate", "add_light", "rename_light", "retype_light", "delete_light",
    "redo", "reload", "append", "override",
)  # fmt: skip


class Session(RuleBasedStateMachine):
    """A session of Blender, of which there is one: it begins with factory settings and ends with the comparison."""

    done, applied, rendered = 0, set(), set()

    def __init__(self):
        super().__init__()
        self.folder = tempfile.TemporaryDirectory(prefix="vgroove-")
        with headless.quiet():
            bpy.ops.wm.read_factory_settings()
            vgroove.register()
            bpy.ops.ed.undo_push(message="start")
        self.artist, self.failed = Artist(Path(self.folder.name)), False

    def take(self, name, chosen_by):
        Session.done += 1
        with self.told():
            self.artist.step(name, chosen_by)

    @contextmanager
    def told(self):
        """What went before, in what a failure says."""
        try:
            with headless.quiet():
                yield
        except Exception as error:
            self.failed = True
            error.add_note("\n".join(self.artist.log))
            raise

    @initialize(chosen_by=CHOICES)
    def begin(self, chosen_by):
        self.take("apply", chosen_by)

    @rule(name=st.sampled_from(OFTEN), chosen_by=CHOICES)
    def often(self, name, chosen_by):
        self.take(name, chosen_by)

    @rule(name=st.sampled_from(RARE), chosen_by=CHOICES)
    def rarely(self, name, chosen_by):
        self.take(name, chosen_by)

    def teardown(self):
        try:
            if not self.failed:
                with self.told():
                    Session.rendered |= self.artist.compare()
        finally:
            Session.applied |= self.artist.applied
            vgroove.unregister()
            self.folder.cleanup()


def test_random_steps_go_well(blender):
    """Some 500 in all, the same whenever the test runs; a failure is shortened to the steps that it takes."""
    Session.done, Session.applied, Session.rendered = 0, set(), set()
    run_state_machine_as_test(
        Session,
        settings=settings(
            max_examples=RUNS, stateful_step_count=STEPS, derandomize=True, database=None, deadline=None,
            phases=(Phase.generate, Phase.shrink), report_multiple_bugs=False, suppress_health_check=list(HealthCheck),
        ),
    )  # fmt: skip
    assert Session.done > RUNS * STEPS * 0.8
    assert Session.applied == set(ESTIMATORS)
    assert len(Session.rendered) > RENDERED


def test_groups_are_found_by_what_they_were_built_as(blender):
    """The steps above compare by group: one whose sockets an artist changed is not taken for ours."""
    made = material.build(presets.find("lecture/copper"), material.Choice("nodes", "closure"))
    group = roles.node(made, roles.MODEL).node_tree
    group.interface.remove(group.interface.items_tree["Roughness"])
    assert "m" not in material.parameter_sockets(made)
    new = material.build(presets.find("lecture/copper"), material.Choice("nodes", "closure"))
    assert roles.node(new, roles.MODEL).node_tree != group
    assert set(nodegroups.inputs(roles.node(new, roles.MODEL))) == {"Base Color", "Roughness", "Normal"}
