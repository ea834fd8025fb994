# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles settings, the preview scene, what is wrong with a scene for an estimator, and a still to EXR or PNG."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

from ..nodegroups import lamp
from . import lamps
from .files import replacing

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import Object, Scene

SUN_SIZE = radians(0.526)  # the real sun's mean angular diameter
LAMP_SIZE = 0.05  # metres: what "Give lamps a size" gives points and spots
FORMATS = {".exr": "OPEN_EXR", ".png": "PNG"}


class SceneError(ValueError):
    """Bad input in one line: what, where, how to mend it."""


@dataclass(frozen=True)
class Problem:
    """Something that keeps an estimator from rendering as it should; ``mend`` is None where only the user can."""

    key: str
    text: str
    button: str = ""
    mend: Callable[[], None] | None = None


def problems(scene: Scene, backend: str, estimator: str, m: float = 0.0) -> list[Problem]:
    """What is wrong with ``scene`` for this choice, the gravest first."""
    found = [*_engine_problems(scene, backend)]
    if estimator == "mirror":
        found += _mirror_problems(scene)
    if estimator == "direct":
        found += _direct_problems(scene, backend)
    if estimator == "closure" and m > 1.0:
        found.append(Problem("slope", f"closure ends at m = 1, which Cycles clamps to; m is {m:g}. Use mirror"))
    return found


def _engine_problems(scene: Scene, backend: str) -> list[Problem]:
    found = []
    if scene.render.engine != "CYCLES":
        found.append(
            Problem(
                "engine",
                f"the render engine is {scene.render.engine}, not Cycles",
                "Use Cycles",
                lambda: _set(scene.render, engine="CYCLES"),
            )
        )
    cycles = scene.cycles
    if backend == "osl" and not bpy.app.build_options.cycles_osl:
        found.append(Problem("osl-build", "this Blender was built without OSL; use the backend nodes"))
    elif backend == "osl" and not cycles.shading_system:
        found.append(
            Problem(
                "osl",
                "Open Shading Language is off: OSL materials render black",
                "Switch OSL on",
                lambda: _set(cycles, shading_system=True),
            )
        )
    return found


def _mirror_problems(scene: Scene) -> list[Problem]:
    cycles, found = scene.cycles, []
    shown = lamps.of_scene(scene)
    bound = lamps_to_bind(scene, "mirror")
    pointlike = [item for item in shown if lamps.size(item) == 0.0 and item not in bound]
    if pointlike:
        names = ", ".join(item.name for item in pointlike)
        found.append(
            Problem(
                "size",
                f"mirror cannot see lamps of zero size that are not bound: {names}",
                "Give lamps a size",
                lambda: _give_size(pointlike),
            )
        )
    unseen = [item for item in shown if not item.data.cycles.use_multiple_importance_sampling]
    if unseen:
        names = ", ".join(item.name for item in unseen)
        found.append(
            Problem(
                "mis",
                f"mirror sees nothing of lamps with Multiple Importance off: {names}",
                "Switch it on",
                lambda: _use_mis(unseen),
            )
        )
    world = scene.world
    if world is not None and world.cycles.sampling_method == "NONE":
        found.append(
            Problem(
                "world", "mirror sees nothing of a world with Multiple Importance off", "Switch it on",
                lambda: _set(world.cycles, sampling_method="AUTOMATIC"),
            )
        )  # fmt: skip
    if cycles.blur_glossy > 0:
        found.append(
            Problem(
                "filter",
                "Filter Glossy is on and blurs mirror's facets",
                "Set it to 0",
                lambda: _set(cycles, blur_glossy=0.0),
            )
        )
    if cycles.sample_clamp_indirect > 0:
        found.append(
            Problem(
                "clamp",
                "Clamp Indirect is on and darkens mirror",
                "Set it to 0",
                lambda: _set(cycles, sample_clamp_indirect=0.0),
            )
        )
    if not cycles.caustics_reflective:
        found.append(
            Problem(
                "caustics",
                "Reflective Caustics are off: light by way of mirror is lost",
                "Switch them on",
                lambda: _set(cycles, caustics_reflective=True),
            )
        )
    return found


def _direct_problems(scene: Scene, backend: str) -> list[Problem]:
    found = []
    shown = lamps.of_scene(scene)
    followed = [item for item in shown if lamps.refusal(item) is None]
    if not followed:
        found.append(
            Problem(
                "lamps", "direct shows bound lamps alone, and this scene has no sun, point or spot that it can follow"
            )
        )
    found += [Problem("refused", refused) for item in shown if (refused := lamps.refusal(item))]
    if len(followed) > lamps.LIMIT:
        rest = ", ".join(item.name for item in followed[lamps.LIMIT :])
        found.append(Problem("limit", f"direct binds the {lamps.LIMIT} strongest lamps; left out: {rest}"))
    sized = [item.name for item in followed if lamps.size(item) > 0]
    if sized:
        found.append(Problem("sized", f"direct takes lamps as points, without soft shadows: {', '.join(sized)}"))
    if backend == "nodes" and not lamp.can_cast_shadows():
        found.append(
            Problem(
                "shadows",
                "direct casts no shadows with nodes in this Blender (5.1 or later has the Raycast node); use OSL",
            )
        )
    return found


def _set(owner: object, **values: object) -> None:
    for name, value in values.items():
        setattr(owner, name, value)


def _give_size(pointlike: Sequence[Object]) -> None:
    for item in pointlike:
        if item.data.type == "SUN":
            item.data.angle = SUN_SIZE
        elif item.data.type == "AREA":
            item.data.size = LAMP_SIZE
        else:
            item.data.shadow_soft_size = LAMP_SIZE


def _use_mis(unseen: Sequence[Object]) -> None:
    for item in unseen:
        item.data.cycles.use_multiple_importance_sampling = True


def pick_estimator(scene: Scene) -> str:
    """``auto``: mirror where rays can hit every light, as it is exact; else closure, which sees all lights."""
    blind = {"size", "mis", "world"}
    return "closure" if any(problem.key in blind for problem in _mirror_problems(scene)) else "mirror"


def lamps_to_bind(scene: Scene, estimator: str) -> tuple[Object, ...]:
    """The strongest lamps that the material evaluates itself: all for ``direct``, those of zero size for ``mirror``."""
    if estimator == "closure":
        return ()
    followed = [item for item in lamps.of_scene(scene) if lamps.refusal(item) is None]
    return tuple(item for item in followed if estimator == "direct" or lamps.size(item) == 0.0)[: lamps.LIMIT]


# The preview scene


def environments() -> dict[str, Path]:
    """The environment maps that come with Blender, by name."""
    folder = Path(bpy.utils.resource_path("LOCAL")) / "datafiles" / "studiolights" / "world"
    return {path.stem: path for path in sorted(folder.glob("*.exr"))}


def preview(environment: str = "sunset") -> Scene:
    """A new scene for judging a material: a ball on a grey floor, a real environment and a low sun.

    Empties this session. The ball is the object "Ball".
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    exact(scene)
    scene.view_settings.view_transform = "Standard"
    _ball(scene)
    _floor(scene)
    _sun(scene)
    _world(scene, environments()[environment])
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


def _ball(scene: Scene) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64, radius=1.0, location=(0, 0, 1))
    ball = bpy.context.object
    ball.name = "Ball"
    bpy.ops.object.shade_smooth()
    scene.view_layers[0].objects.active = ball


def _floor(scene: Scene) -> None:
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata([(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)], [], [(0, 1, 2, 3)])
    material = bpy.data.materials.new("Floor")
    if bpy.app.version < (5, 0, 0):  # as in material.py; goes with 4.5 LTS
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (0.18, 0.18, 0.18, 1.0)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Floor", mesh))


def _sun(scene: Scene) -> None:
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 1.6, 0.0  # a sharp shadow line
    item = bpy.data.objects.new("Sun", sun)
    item.rotation_euler = (radians(50.0), 0.0, radians(-40.0))
    scene.collection.objects.link(item)


def _world(scene: Scene, image: Path) -> None:
    world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):  # as in material.py; goes with 4.5 LTS
        world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    texture, background, output = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Background", "OutputWorld")
    )
    texture.image = bpy.data.images.load(str(image))
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    scene.world = world


# Stills


def still(
    scene: Scene,
    path: Path,
    *,
    samples: int | None = None,
    seed: int | None = None,
    resolution: tuple[int, int] | None = None,
) -> None:
    """Render ``scene`` to ``path``: linear float EXR or PNG by its ending, whole or not at all."""
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
    settings = render.image_settings
    settings.file_format = FORMATS[path.suffix.lower()]
    settings.color_mode = "RGB"
    settings.color_depth = "32" if settings.file_format == "OPEN_EXR" else "8"
    with replacing(path) as temporary:
        render.filepath = str(temporary)
        bpy.ops.render.render(write_still=True, scene=scene.name)
