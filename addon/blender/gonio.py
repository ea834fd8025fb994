# SPDX-License-Identifier: GPL-3.0-or-later
"""The virtual gonioreflectometer: a material's BRDF, measured in Cycles itself.

An OSL camera sends pixel (x, y) as the ray that leaves a flat patch toward wo(x, y); a sun at theta_i, phi_i lights it.
Works with OSL shading off too: then the material's plain nodes run in SVM, as they do on GPUs.
A second instrument needs no OSL: one point of a point cloud is traced as a perfect sphere.
"""

from __future__ import annotations

import tempfile
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import bpy
import numpy as np

from ...nodegroups import versions
from ...nodegroups.osl_script import text_block, tidy
from ..reference.hybrid import DEFAULT_BOUND
from . import colour_space
from .images import pixels
from .material import Choice, build, lamps_to_bind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from bpy.types import Camera, Material, Node, Object, Scene, World
    from numpy.typing import NDArray

    from ..library.presets import Preset
    from .course import Play


SMALLEST = (4, 4)  # pixels of a render of Blender's
PINHOLE = 1e-3  # degrees


@dataclass(frozen=True)
class Geometry:
    """What is measured. Angles in degrees; ``window`` half width around the mirror direction, 0 for the hemisphere.

    wi = (sin(theta_i) cos(phi_i), sin(theta_i) sin(phi_i), cos(theta_i)). Beyond 90 degrees of theta_i the sun shines
    from below, through the patch, and the window is around the direction that a smooth interface of index ``eta``
    (below over above) refracts it to.
    ``sun_angle`` is the sun's full angle (0: a direction); ``furnace``: a uniform white world in place of the sun, or
    the half of it that ``lit`` names. ``inside``: the patch shows its back.
    ``tangent``: the azimuth of the UV map's u axis, which anisotropic materials take their tangent from. Without a UV
    map Blender's tangent runs in circles around the patch and turns by 6 degrees over what the camera sees.
    """

    theta_i: float = 0.0
    window: float = 0.0
    resolution: tuple[int, int] = (64, 64)
    sun_angle: float = 0.0
    furnace: bool = False
    lit: Literal["all", "above", "below"] = "all"
    eta: float = 1.0
    inside: bool = False
    phi_i: float = 0.0
    tangent: float = 0.0

    @property
    def axis(self) -> float:
        """theta in degrees such that the window is around (-sin, 0, cos): theta_i, or what it is refracted from."""
        if self.theta_i <= 90.0:
            return self.theta_i
        sine = self.eta * np.sin(np.radians(self.theta_i))
        if sine >= 1.0:
            message = f"light at {self.theta_i:g} degrees is reflected totally at eta = {self.eta:g}; use a smaller eta"
            raise ValueError(message)
        return float(np.degrees(np.arcsin(sine)))

    def wi(self) -> NDArray[np.float64]:
        """Direction to the (centre of the) sun, (3,)."""
        theta, (cos_phi, sin_phi) = np.radians(self.theta_i), self._azimuth()
        return np.array([np.sin(theta) * cos_phi, np.sin(theta) * sin_phi, np.cos(theta)])

    def wo(self) -> NDArray[np.float64]:
        """Direction to the viewer of each pixel, (H, W, 3); row 0 nearest the normal, or at b = -window.

        Pixel (x, y) of the hemisphere is phi_o = 2 pi (x + .5)/W, theta_o = (pi/2)(y + .5)/H, whatever phi_i is.
        The window's frame turns with phi_i: w + tan(a) e1 + tan(b) e2, normalised, with the mirror direction
        w = (-sin(t), 0, cos(t)), e1 = (-cos(t), 0, -sin(t)), e2 = (0, 1, 0), all turned by phi_i about z; t is
        ``axis``, a = window (2 (x + .5)/W - 1), b = window (2 (y + .5)/H - 1). It may reach below the surface.
        """
        width, height = self.resolution
        x, y = np.broadcast_arrays((np.arange(width) + 0.5) / width, ((np.arange(height) + 0.5) / height)[:, None])
        if not self.window:
            theta, phi = np.pi / 2 * y, 2 * np.pi * x
            return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
        a, b = np.radians(self.window * (2 * x - 1)), np.radians(self.window * (2 * y - 1))
        inclined = np.radians(self.axis) + a
        # w + tan(a) e1 + tan(b) e2, times cos(a)
        wo = np.stack([-np.sin(inclined), np.cos(a) * np.tan(b), np.cos(inclined)], axis=-1)
        wo /= np.linalg.norm(wo, axis=-1, keepdims=True)
        cos_phi, sin_phi = self._azimuth()
        across, along, up = np.moveaxis(wo, -1, 0)
        return np.stack([cos_phi * across - sin_phi * along, sin_phi * across + cos_phi * along, up], axis=-1)

    def _azimuth(self) -> tuple[float, float]:
        """Cosine and sine of phi_i."""
        return float(np.cos(np.radians(self.phi_i))), float(np.sin(np.radians(self.phi_i)))


def measure(
    material: Material, geometry: Geometry, *, samples: int = 1, seed: int = 0, shading_osl: bool = True
) -> NDArray[np.float32]:
    """f(wi, wo) of any ``material`` in 1/sr, (H, W, 3), as Cycles renders it.

    With a sun angle: the cosine-weighted mean of f over the disc; with ``furnace``: the directional albedo E(wo).
    shading_osl: run shaders as OSL (script nodes need it) or as SVM. Needs a Blender with OSL for the camera.
    """
    return _measure(lambda _scene: material, geometry, samples, seed, shading_osl)


def measure_preset(
    preset: Preset, backend: str, estimator: str, geometry: Geometry, *,
    samples: int = 1, seed: int = 0, shading_osl: bool = True, bound: float = DEFAULT_BOUND,
) -> NDArray[np.float32]:  # fmt: skip
    """As ``measure``, of the material that ``preset`` makes; bound to the instrument's sun if ``binds`` says so.

    bound: of ``hybrid``, see ``Choice``.
    """

    def make(scene: Scene) -> Material:
        # No shadows: tracing under an OSL camera crashes Blender 5.2.3, and nothing stands in the light.
        suns = lamps_to_bind(scene, estimator, preset.model)
        return build(preset, Choice(backend, estimator, suns, shadows=False, bound=bound))

    return _measure(make, geometry, samples, seed, shading_osl)


def measure_course(
    preset: Preset, backend: str, estimator: str, geometry: Geometry, play: Play, frames: Sequence[float], *,
    samples: int = 1, shading_osl: bool = True,
) -> NDArray[np.float32]:  # fmt: skip
    """As ``measure_preset``, of a material that plays ``preset``'s course: (N, H, W, 3) float32, in 1/sr.

    frames: the N frames of the course at which it is measured, fractions too; each has a seed of its own.
    """
    with stage(geometry.resolution, samples=samples, seed=0, shading_osl=shading_osl) as scene:
        scene.render.use_persistent_data = True
        light(scene, geometry)
        bound = lamps_to_bind(scene, estimator, preset.model)
        _patch(scene, build(preset, Choice(backend, estimator, bound, shadows=False, play=play)), geometry)
        _camera(scene, geometry)
        images, shown = [], bpy.context.scene
        before = shown.frame_current, shown.frame_subframe
        for seed, frame in enumerate(frames):
            scene.cycles.seed = seed
            for one in (scene, shown):  # what is rendered is the window's frame, whatever scene is asked for
                one.frame_set(int(frame), subframe=frame - int(frame))
            images.append(rendered(scene))
        shown.frame_set(before[0], subframe=before[1])
    return np.stack(images)


def measure_pairs(
    make: Callable[[Scene], Material], wi: NDArray[np.float64], wo: NDArray[np.float64], *,
    samples: int = 1, shading_osl: bool = True, seen: Callable[[], None] = lambda: None,
) -> NDArray[np.float32]:  # fmt: skip
    """f(wi, wo) of each pair of directions (N, 3) above the surface, (N, 3) in 1/sr: a render of 4 x 4 pixels each.

    make: as for ``instrument``. seen: called after each pair. The u axis of the UV map is x.
    """
    theta_i, phi_i, theta_o, phi_o = (angle for w in (wi, wo) for angle in _angles(w))
    with instrument(make, Geometry(resolution=SMALLEST), samples=samples, shading_osl=shading_osl) as scene:
        (lamp,) = (one for one in scene.objects if one.type == "LIGHT")
        custom = scene.camera.data.cycles_custom
        custom["window"] = PINHOLE
        found = []
        for k in range(len(wi)):
            lamp.data.energy = 1.0 / np.cos(np.radians(theta_i[k]))
            lamp.rotation_euler = (0.0, np.radians(theta_i[k]), np.radians(phi_i[k]))
            custom["theta_i"], custom["phi_i"] = float(theta_o[k]), float(phi_o[k]) + 180.0  # of what is mirrored to wo
            found.append(rendered(scene).mean(axis=(0, 1)))
            seen()
    return np.stack(found)


def _angles(w: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """theta and phi of directions (N, 3), in degrees."""
    return np.degrees(np.arctan2(np.hypot(w[:, 0], w[:, 1]), w[:, 2])), np.degrees(np.arctan2(w[:, 1], w[:, 0]))


def _measure(
    make: Callable[[Scene], Material],
    geometry: Geometry,
    samples: int,
    seed: int,
    shading_osl: bool,  # noqa: FBT001
) -> NDArray[np.float32]:
    with instrument(make, geometry, samples=samples, seed=seed, shading_osl=shading_osl) as scene:
        return rendered(scene)


@contextmanager
def instrument(
    make: Callable[[Scene], Material], geometry: Geometry, *,
    samples: int = 1, seed: int = 0, shading_osl: bool = False,
) -> Iterator[Scene]:  # fmt: skip
    """The scene that ``measure`` renders, for who renders it more than once; its one mesh is the patch.

    make: the patch's material, given the lit scene.
    """
    with stage(geometry.resolution, samples=samples, seed=seed, shading_osl=shading_osl) as scene:
        light(scene, geometry)
        _patch(scene, make(scene), geometry)
        _camera(scene, geometry)
        yield scene


@contextmanager
def stage(resolution: tuple[int, int], *, samples: int, seed: int, shading_osl: bool) -> Iterator[Scene]:
    """A scene of its own with nothing between the estimator and the number; removed with all it held."""
    before = {
        name: set(getattr(bpy.data, name)) for name in ("objects", "materials", "meshes", "cameras", "lights", "worlds")
    }
    scene = bpy.data.scenes.new("VGroove gonio")
    try:
        render, cycles = scene.render, scene.cycles
        render.engine = "CYCLES"
        render.resolution_x, render.resolution_y, render.resolution_percentage = *resolution, 100
        render.use_compositing = render.use_sequencer = False
        render.threads_mode = "AUTO"
        render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
        render.image_settings.exr_codec = "NONE"
        render.dither_intensity = 0.0
        scene.view_settings.view_transform = "Raw"
        cycles.device, cycles.shading_system = "CPU", shading_osl
        cycles.samples, cycles.seed = samples, seed
        cycles.use_denoising = cycles.use_adaptive_sampling = False
        cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
        cycles.blur_glossy = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
        cycles.light_sampling_threshold = 0.0
        scene.world = bpy.data.worlds.new("VGroove gonio")
        shown = bpy.context.scene  # what changes over time is measured as it is now
        scene.frame_set(shown.frame_current, subframe=shown.frame_subframe)
        yield scene
    finally:
        bpy.data.scenes.remove(scene)
        for name, known in before.items():
            collection = getattr(bpy.data, name)
            for item in set(collection) - known:
                collection.remove(item)


def light(scene: Scene, geometry: Geometry) -> tuple[Object, ...]:
    """The sun at wi, so strong that a BRDF of f gives a radiance of f; or a uniform white world and no lamp."""
    world = scene.world
    tree = versions.nodes_of(world)
    background = tree.nodes.get("Background") or tree.nodes.new("ShaderNodeBackground")
    output = next((n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputWorld"), None)
    output = output or tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    level = 1.0 if geometry.furnace else 0.0
    background.inputs["Color"].default_value = (level, level, level, 1.0)
    if geometry.furnace and geometry.lit != "all":
        _light_half(world, background, geometry.lit)
    if geometry.furnace:
        return ()
    sun = bpy.data.lights.new("VGroove gonio", "SUN")
    sun.energy, sun.angle = 1.0 / abs(np.cos(np.radians(geometry.theta_i))), np.radians(geometry.sun_angle)
    lamp = bpy.data.objects.new("VGroove gonio", sun)
    lamp.rotation_euler = (0.0, np.radians(geometry.theta_i), np.radians(geometry.phi_i))  # about y, then about z
    scene.collection.objects.link(lamp)
    return (lamp,)


def _light_half(world: World, background: Node, lit: str) -> None:
    """White above or below the horizon, black on the other side."""
    nodes, links = world.node_tree.nodes, world.node_tree.links
    direction, split, step = (
        nodes.new(kind) for kind in ("ShaderNodeTexCoord", "ShaderNodeSeparateXYZ", "ShaderNodeMath")
    )
    step.operation, step.inputs[1].default_value = "GREATER_THAN" if lit == "above" else "LESS_THAN", 0.0
    links.new(direction.outputs["Generated"], split.inputs[0])
    links.new(split.outputs["Z"], step.inputs[0])
    links.new(step.outputs[0], background.inputs["Strength"])


def _patch(scene: Scene, material: Material, geometry: Geometry) -> None:
    """One triangle far larger than what the camera sees (rays through an inner edge would miss), with a UV map."""
    mesh = bpy.data.meshes.new("VGroove gonio")
    corners = np.array([(-4, -3, 0), (4, -3, 0), (0, 5, 0)])
    mesh.from_pydata(corners.tolist(), [], [(0, 2, 1) if geometry.inside else (0, 1, 2)])
    mesh.materials.append(material)
    turn = np.radians(geometry.tangent)
    u, v = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    uvs = mesh.uv_layers.new(name="UVMap").uv
    for loop in mesh.loops:
        place = corners[loop.vertex_index, :2]
        uvs[loop.index].vector = (place @ u, place @ v)
    scene.collection.objects.link(bpy.data.objects.new("VGroove gonio", mesh))


def _camera(scene: Scene, geometry: Geometry) -> None:
    camera_of(
        scene, "gonio_camera", window=float(geometry.window), theta_i=float(geometry.axis), phi_i=float(geometry.phi_i)
    )


def camera_of(scene: Scene, shader: str, **parameters: float) -> Camera:
    """Give the scene a camera that runs ``shader`` with the resolution and these parameters."""
    import cycles.osl

    camera = bpy.data.cameras.new("VGroove gonio")
    with tidy():
        camera.type, camera.custom_mode = "CUSTOM", "INTERNAL"
        camera.custom_shader = text_block(shader)  # in a scene of Cycles this compiles it
        if not camera.custom_bytecode:
            cycles.osl.update_custom_camera_shader(camera, lambda *_: None)
    custom = camera.cycles_custom
    custom["resolution"] = (float(scene.render.resolution_x), float(scene.render.resolution_y), 0.0)
    for name, value in parameters.items():
        custom[name] = value
    item = bpy.data.objects.new("VGroove gonio", camera)
    scene.collection.objects.link(item)
    scene.camera = item
    return camera


def rendered(scene: Scene) -> NDArray[np.float32]:
    """The scene's render in linear Rec.709, whatever the file's working space, (H, W, 3) float32, row 0 on top."""
    with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
        path = Path(folder) / "render.exr"
        scene.render.filepath = str(path)
        bpy.ops.render.render(write_still=True, scene=scene.name)
        image = bpy.data.images.load(str(path))
        image.colorspace_settings.name = "Non-Color"
        found = pixels(image)
        bpy.data.images.remove(image)
    return colour_space.to_rec709(found)


def measure_sphere(
    preset: Preset, backend: str, estimator: str, theta_i: float, *, size: int = 128, shading_osl: bool = False
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Radiance f cos(theta_i) of a sphere lit by a sun of strength 1, and the exact normal of each pixel.

    Needs no OSL: one point of a point cloud, traced as a perfect sphere under an orthographic camera, has the normal
    (x, y, sqrt(1 - x^2 - y^2)) at pixel (x, y). Returns (H, W, 3) twice; normals are NaN beside the sphere.
    """
    with stage((size, size), samples=1, seed=0, shading_osl=shading_osl) as scene:
        geometry = Geometry(theta_i)
        (lamp,) = light(scene, geometry)
        lamp.data.energy = 1.0
        bound = lamps_to_bind(scene, estimator, preset.model)
        sphere(scene, build(preset, Choice(backend, estimator, bound, shadows=False)))
        look_down(scene, 2.0)
        radiance = rendered(scene)
    x, y = np.meshgrid((np.arange(size) + 0.5) / size * 2 - 1, 1 - (np.arange(size) + 0.5) / size * 2)
    inside = x * x + y * y < 1
    z = np.sqrt(np.where(inside, 1 - x * x - y * y, np.nan))
    return radiance, np.stack([x, y, z], axis=-1)


def look_down(scene: Scene, width: float, at: tuple[float, float, float] = (0.0, 0.0, 3.0)) -> None:
    """Give the scene an orthographic camera that looks straight down and sees ``width`` metres."""
    camera = bpy.data.cameras.new("VGroove gonio")
    camera.type, camera.ortho_scale = "ORTHO", width
    item = bpy.data.objects.new("VGroove gonio", camera)
    item.location = at
    scene.collection.objects.link(item)
    scene.camera = item


def sphere(scene: Scene, material: Material) -> Object:
    """One point of radius 1 at the origin, which Cycles traces as a perfect sphere."""
    mesh = bpy.data.meshes.new("VGroove gonio")
    mesh.from_pydata([(0, 0, 0)], [], [])
    item = bpy.data.objects.new("VGroove gonio", mesh)
    scene.collection.objects.link(item)
    group = bpy.data.node_groups.new("VGroove gonio", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    points, assign, output = (
        group.nodes.new(kind) for kind in ("GeometryNodePoints", "GeometryNodeSetMaterial", "NodeGroupOutput")
    )
    points.inputs["Count"].default_value, points.inputs["Radius"].default_value = 1, 1.0
    assign.inputs["Material"].default_value = material
    group.links.new(points.outputs[0], assign.inputs[0])
    group.links.new(assign.outputs[0], output.inputs[0])
    item.modifiers.new("VGroove gonio", "NODES").node_group = group
    return item
