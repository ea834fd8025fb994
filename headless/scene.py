# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles settings, the preview scene, scenes of others, and a still to EXR or PNG."""

from __future__ import annotations

from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..addon.blender.colour_update import refresh_all
from ..addon.blender.follow import refresh
from ..addon.library.errors import InputError
from ..addon.library.files import one_root, replacing
from ..nodegroups import versions

if TYPE_CHECKING:
    from bpy.types import Scene


PHYSICS = {"CLOTH", "SOFT_BODY", "FLUID", "PARTICLE_SYSTEM", "DYNAMIC_PAINT", "COLLISION"}  # modifiers
SIMULATIONS = {"GeometryNodeSimulationOutput", "GeometryNodeBake"}
FORMATS = {".exr": "OPEN_EXR", ".png": "PNG"}


class SceneError(InputError):
    """A scene that cannot be opened, assigned to or rendered as asked."""


def blender_folders() -> list[Path]:
    """Where Blender keeps what comes with it: a distribution's has a system folder of its own."""
    return [Path(found) for kind in ("SYSTEM", "LOCAL") if (found := bpy.utils.resource_path(kind))]


# The preview scene


def environments() -> dict[str, Path]:
    """The environment maps that come with Blender, by name."""
    folders = [root / "datafiles" / "studiolights" / "world" for root in blender_folders()]
    return {path.stem: path for folder in folders for path in sorted(folder.glob("*.exr"))}


def preview(environment: str = "sunset") -> Scene:
    """A new scene for judging a material: a ball on a grey floor, a real environment and a low sun.

    Empties this session. The ball is the object "Ball".
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    exact(scene)
    scene.cycles.glossy_bounces = scene.cycles.max_bounces  # Blender's own four lose light within glass
    scene.view_settings.view_transform = "Standard"
    ball = bpy.data.objects.new("Ball", ball_mesh())
    ball.location = (0, 0, 1)
    scene.collection.objects.link(ball)
    _floor(scene)
    add_sun(scene)
    light_by(scene, environments()[environment])
    camera = bpy.data.cameras.new("Camera")
    camera.lens = 85
    item = bpy.data.objects.new("Camera", camera)
    item.location, item.rotation_euler = (0.0, -8.2, 2.2), (radians(82.0), 0.0, 0.0)
    scene.collection.objects.link(item)
    scene.camera = item
    return scene


def exact(scene: Scene) -> None:
    """Take out of Cycles what trades correctness for speed."""
    cycles = scene.cycles
    cycles.blur_glossy = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.light_sampling_threshold = 0.0


def ball_mesh(segments: int = 128, rings: int = 64) -> bpy.types.Mesh:
    """A smooth unit sphere made by hand: the points of Blender's own come in an order that differs from run to run."""
    ring = np.arange(1, rings)[:, None] * np.pi / rings
    turn = np.arange(segments) * 2 * np.pi / segments
    parts = (
        np.sin(ring) * np.cos(turn),
        np.sin(ring) * np.sin(turn),
        np.broadcast_to(np.cos(ring), (rings - 1, segments)),
    )
    points = [*np.stack(parts, axis=-1).reshape(-1, 3).tolist(), [0, 0, 1], [0, 0, -1]]
    top, bottom = len(points) - 2, len(points) - 1
    faces: list[tuple[int, ...]] = []
    for s in range(segments):
        t = (s + 1) % segments
        faces += [(top, s, t), (bottom, (rings - 2) * segments + t, (rings - 2) * segments + s)]
        faces += [
            (r + s, r + segments + s, r + segments + t, r + t) for r in range(0, (rings - 2) * segments, segments)
        ]
    mesh = bpy.data.meshes.new("Ball")
    mesh.from_pydata(points, [], faces)
    mesh.shade_smooth()
    return mesh


def _floor(scene: Scene) -> None:
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata([(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)], [], [(0, 1, 2, 3)])
    material = versions.empty_material("Floor")
    tree = material.node_tree
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (0.18, 0.18, 0.18, 1.0)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Floor", mesh))


def add_sun(scene: Scene, energy: float = 1.6) -> None:
    """A low sun of zero size, whose shadow has a sharp line."""
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = energy, 0.0
    item = bpy.data.objects.new("Sun", sun)
    item.rotation_euler = (radians(50.0), 0.0, radians(-40.0))
    scene.collection.objects.link(item)


def light_by(scene: Scene, image: Path, strength: float = 1.0) -> None:
    """Make an environment map the scene's world."""
    world = bpy.data.worlds.new("World")
    tree = versions.nodes_of(world)
    tree.nodes.clear()
    texture, background, output = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Background", "OutputWorld")
    )
    texture.image = bpy.data.images.load(str(image))
    background.inputs["Strength"].default_value = strength
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    scene.world = world


# Scenes of others


def open_file(path: Path, *, for_saving: bool = False) -> Scene:
    """Open a .blend in place of the current file and return its scene; SceneError if it cannot be opened.

    It runs no script of the file, and unless it is to be saved its File Output nodes are muted: a render writes what it
    was asked for and nothing else.
    """
    try:
        bpy.ops.wm.open_mainfile(filepath=str(one_root(path.absolute())), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        message = f"{path}: cannot be opened as a .blend: {' '.join(str(error).split())}"
        raise SceneError(message) from error
    for tree in () if for_saving else versions.compositors():
        for node in tree.nodes:
            node.mute |= node.bl_idname == "CompositorNodeOutputFile"
    refresh_all()  # without the extension nothing kept materials to the file's working space
    return bpy.context.scene


def size(scene: Scene) -> tuple[int, int]:
    """Pixels of the scene's own render."""
    render = scene.render
    width, height = (side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y))
    return width, height


def composites(scene: Scene) -> bool:
    """Whether the compositor has a say in the scene's picture."""
    return scene.render.use_compositing and versions.has_compositor(scene)


def has_strips(scene: Scene) -> bool:
    """Whether the sequencer has anything to show in place of the scene."""
    editor = scene.sequence_editor
    return editor is not None and len(editor.strips) > 0


def remembers(scene: Scene) -> bool:
    """Whether what a scene shows at a frame depends on those before: physics, and in Cycles what comes and goes."""
    strips = [strip for action in bpy.data.actions for layer in action.layers for strip in layer.strips]
    paths = [curve.data_path for strip in strips for bag in strip.channelbags for curve in bag.fcurves]
    owners = (*bpy.data.objects, *bpy.data.collections, *bpy.data.scenes)
    paths += [one.data_path for owner in owners if owner.animation_data for one in owner.animation_data.drivers]
    physics = any(one.type in PHYSICS for item in scene.objects for one in item.modifiers)
    simulated = any(node.bl_idname in SIMULATIONS for tree in bpy.data.node_groups for node in tree.nodes)
    return bool(scene.rigidbody_world) or physics or simulated or any("hide_" in path for path in paths)


# Stills


def still(
    scene: Scene,
    path: Path,
    *,
    samples: int | None = None,
    seed: int | None = None,
    resolution: tuple[int, int] | None = None,
    note: str = "",
) -> None:
    """Render ``scene`` to ``path``: linear float EXR or PNG by its ending, whole or not at all.

    note: kept in the picture's metadata.
    """
    if path.suffix.lower() not in FORMATS:
        message = f"{path}: unknown ending {path.suffix!r}; use .exr (linear, float) or .png"
        raise SceneError(message)
    if scene.camera is None:
        message = f'scene "{scene.name}" has no camera; add one and make it the active camera'
        raise SceneError(message)
    render = scene.render
    if samples is not None:
        scene.cycles.samples = samples
    if seed is not None:
        scene.cycles.seed = seed
    if resolution is not None:
        render.resolution_x, render.resolution_y, render.resolution_percentage = *resolution, 100
    render.use_multiview = render.use_stamp = False  # one picture, of the scene alone
    settings = render.image_settings
    versions.write_as(settings, "IMAGE", FORMATS[path.suffix.lower()])
    settings.color_mode = "RGB"
    settings.color_depth = "32" if settings.file_format == "OPEN_EXR" else "8"
    render.use_stamp_note, render.stamp_note_text = bool(note), note
    refresh(scene)
    with replacing(path) as temporary:
        render.filepath = str(temporary)
        bpy.ops.render.render(write_still=True, scene=scene.name)
