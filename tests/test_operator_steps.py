# SPDX-License-Identifier: GPL-3.0-or-later
"""Random steps of an artist: no exception, no invalid driver, nothing left behind, materials like new ones."""

import random
from pathlib import Path

import pytest

import vgroove
from vgroove import nodegroups
from vgroove.addon import headless, material, origin, presets, rebuild, roles
from vgroove.nodegroups import trajectory

pytestmark = pytest.mark.blender

RUNS, STEPS = 10, 50
PRESETS = ("lecture/copper", "plastics/red_plastic", "glasses/bk7_crown_glass", "time_varying/yellowing_paper")
ESTIMATORS = ("closure", "mirror", "direct", "auto")  # of which groups are built in a moment; mirror binds lights too
KINDS = ("SUN", "POINT", "SPOT", "AREA")


class Artist:
    """Takes steps in Blender's default scene; ``log`` tells them when a test fails."""

    def __init__(self, bpy, seed, folder):
        self.bpy, self.random, self.folder, self.log = bpy, random.Random(seed), folder, [f"seed {seed}"]  # noqa: S311 - steps, not secrets

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

    def step(self):
        often = [self.select, self.apply, self.quality, self.press, self.edit, self.undo]
        rest = [
            self.texture, self.mix, self.key, self.take_away, self.duplicate, self.add_light, self.rename_light,
            self.retype_light, self.delete_light, self.redo, self.reload, self.append, self.override,
        ]  # fmt: skip
        chosen = self.random.choice(often if self.random.random() < 0.5 else rest)
        self.log.append(chosen.__name__)
        before = self.orphans()
        chosen()
        if chosen.__name__ in {"apply", "quality", "press"}:
            assert self.orphans() <= before, self.log
        if chosen.__name__ not in {"undo", "redo"}:
            self.bpy.ops.ed.undo_push(message=chosen.__name__)
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
        """Each material, once updated, equals a new one of its preset and numbers, except for what the artist did."""
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
            self.bpy.data.materials.remove(new)


def _plain(value):
    return list(value) if hasattr(value, "__len__") else value


@pytest.mark.parametrize("seed", range(RUNS))
def test_random_steps_go_well(blender, tmp_path, seed):
    """500 in all; the log of a failure tells what to do to see it."""
    with headless.quiet():
        blender.ops.wm.read_factory_settings()
    vgroove.register()
    try:
        artist = Artist(blender, seed, Path(tmp_path))
        with headless.quiet():
            blender.ops.ed.undo_push(message="start")
            for _ in range(STEPS):
                artist.step()
            artist.compare()
    except Exception as error:
        error.add_note("\n".join(artist.log))
        raise
    finally:
        vgroove.unregister()


def test_groups_are_found_by_what_they_were_built_as(blender):
    """The steps above compare by group: one whose sockets an artist changed is not taken for ours."""
    made = material.build(presets.find("lecture/copper"), material.Choice("nodes", "closure"))
    group = roles.node(made, roles.MODEL).node_tree
    group.interface.remove(group.interface.items_tree["Slope m"])
    assert "m" not in material.parameter_sockets(made)
    new = material.build(presets.find("lecture/copper"), material.Choice("nodes", "closure"))
    assert roles.node(new, roles.MODEL).node_tree != group
    assert set(nodegroups.inputs(roles.node(new, roles.MODEL))) == {"F0", "Slope m", "Normal"}
