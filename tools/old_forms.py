# SPDX-License-Identifier: GPL-3.0-or-later
"""One .blend with a material of each form that an earlier version made, for the tests that open and upgrade it.

python tools/old_forms.py FILE.blend        in a checkout of that version, on Blender 4.5, so that 4.5 and 5.2 open it

tests/data/format_1.blend was written this way at commit 61e7897. There, what a material was built from is a list of
texts and numbers in its property "vgroove", its inputs as built are in "vgroove_state", its course is in
"vgroove_time", and nodes are told apart by their labels.

The materials are the slots of one object. Node groups keep their sockets and lose their contents, which would take 50
times the room; only courses driven by Age stay whole. `zstd -dc FILE | zstd --ultra -22` makes the file smaller still.
What they looked like is in FILE.toml, as 5.2 renders it: with --looks, that is written in place of the .blend.
"""

from __future__ import annotations

import sys
from pathlib import Path

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()
import numpy as np  # noqa: E402

from vgroove.addon.blender import gonio, material  # noqa: E402
from vgroove.addon.blender.course import Play  # noqa: E402
from vgroove.addon.blender.material import BACKENDS, ESTIMATORS, Choice, lamps_to_bind  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.headless import scene  # noqa: E402
from vgroove.nodegroups import trajectory  # noqa: E402

OTHERS = (
    ("plastics/red_plastic", "nodes", "corrected"),
    ("lecture/plastic", "osl", "fit"),
    ("car_paints/blue", "nodes", "direct"),
    ("glasses/frosted_glass", "nodes", "mirror"),
    ("glasses/bk7_crown_glass", "osl", "closure"),
    ("translucent/marble", "nodes", "fit"),
)
LIT = ("nodes corrected", "osl mirror", "nodes hybrid")  # bound to the light; drivers take most of the room
CHANGING = "time_varying/yellowing_paper"
PIXELS, SPACING = 16, 2.5  # of a picture of a ball of radius 1


def add(name: str, preset: presets.Preset, choice: Choice) -> bpy.types.Material:
    """A material of this name, in a slot of the one object."""
    made = material.build(preset, choice).copy()
    made.name = name
    bpy.data.meshes["Body"].materials.append(made)
    return made


def chosen(preset: presets.Preset, backend: str, estimator: str, play: Play | None = None) -> Choice:
    lamps = lamps_to_bind(bpy.context.scene, estimator, preset.model) if f"{backend} {estimator}" in LIT else ()
    return Choice(backend, estimator, lamps, bound=0.01, play=play)


def model_node(made: bpy.types.Material) -> bpy.types.Node:
    return next(node for node in made.node_tree.nodes if "Slope m" in node.inputs)


def fill() -> None:
    """A light and the materials."""
    light = bpy.data.lights.new("Point", "POINT")
    light.shadow_soft_size = 0.0
    for name, data in (("Point", light), ("Body", bpy.data.meshes.new("Body"))):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, data))
    copper = presets.find("lecture/copper")
    for backend in BACKENDS:
        for estimator in ESTIMATORS:
            add(f"copper {backend} {estimator}", copper, chosen(copper, backend, estimator))
    for identity, backend, estimator in OTHERS:
        preset = presets.find(identity)
        add(f"{preset.id} {backend} {estimator}", preset, chosen(preset, backend, estimator))
    changing = presets.find(CHANGING)
    for driving, backend in (("curves", "nodes"), ("age", "nodes"), ("age", "osl")):
        add(f"{driving} {backend}", changing, chosen(changing, backend, "fit", Play(driving, tolerance=0.05)))
    edited = add("edited", copper, chosen(copper, "nodes", "fit"))
    model_node(edited).inputs["Slope m"].default_value = 0.45
    textured = add("textured and mixed", copper, chosen(copper, "nodes", "hybrid"))
    nodes, link = textured.node_tree.nodes, textured.node_tree.links.new
    model = model_node(textured)
    link(nodes.new("ShaderNodeTexNoise").outputs["Color"], model.inputs["F0"])
    mix = nodes.new("ShaderNodeMixShader")
    link(model.outputs[0], mix.inputs[1])
    link(nodes.new("ShaderNodeBsdfDiffuse").outputs[0], mix.inputs[2])
    shown = next(node for node in nodes if node.bl_idname == "ShaderNodeOutputMaterial" and node.target == "CYCLES")
    link(mix.outputs[0], shown.inputs["Surface"])


def empty_groups() -> None:
    """Take the insides out of all groups that materials are made of, and what then is unused out of the file."""
    used = {node.node_tree for one in bpy.data.materials for node in one.node_tree.nodes if "Group" in node.bl_idname}
    for group in used:
        if not group.name.startswith(trajectory.NAME):
            group.nodes.clear()
    for text in bpy.data.texts:
        text.use_fake_user = False
    bpy.data.orphans_purge(do_recursive=True)


def looks() -> str:
    """The mean colour of a ball of each material below a white sky, its light hidden, as lines of TOML."""
    bpy.data.objects["Point"].hide_render = True
    across = (np.arange(PIXELS) + 0.5) * SPACING / PIXELS - SPACING / 2.0
    within = np.hypot(*np.meshgrid(across, across)) < 0.95
    lines = ["# SPDX-License-Identifier: GPL-3.0-or-later", "# Written by tools/old_forms.py --looks: linear Rec.709"]
    for made in bpy.data.meshes["Body"].materials:
        means = [picture(made, seed)[within].mean(axis=0) for seed in range(4)]
        lines.append(f'"{made.name}" = {[round(float(x), 5) for x in np.mean(means, axis=0)]}')
    return "\n".join(lines) + "\n"


def picture(made: bpy.types.Material, seed: int) -> np.ndarray:
    """As the fixture ``balls`` of tests/conftest.py has it, (PIXELS, PIXELS, 3)."""
    with gonio.stage((PIXELS, PIXELS), samples=256, seed=seed, shading_osl="osl" in made.name) as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        mesh = scene.ball_mesh(32, 16)
        mesh.materials.append(made)
        stage.collection.objects.link(bpy.data.objects.new("Ball", mesh))
        gonio.look_down(stage, SPACING, (0.0, 0.0, 9.0))
        return gonio.rendered(stage)


def main() -> None:
    path = Path(sys.argv[1]).absolute()
    with headless.quiet():
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        window = bpy.context.window.workspace
        bpy.data.batch_remove([one for one in bpy.data.workspaces if one != window])
        bpy.data.orphans_purge(do_recursive=True)
        fill()
        if "--looks" in sys.argv:
            path.with_suffix(".toml").write_text(looks(), encoding="utf-8")
            return
        empty_groups()
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True, copy=True)
    print(f"{path}: {len(bpy.data.materials)} materials, {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
