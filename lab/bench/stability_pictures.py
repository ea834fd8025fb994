# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a white plane under a white sky, far from the origin, huge and tiny, in many copies and in motion.

Every pixel of them should be the directional albedo, with the noise of its samples and no more. A pixel is 1/256 of the
scale, as of a thing of that size that fills half of a picture 512 wide.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Literal

import bpy
import numpy as np
from mathutils import Vector

from ... import headless, nodegroups
from ...addon.blender import gonio, rays
from ...addon.blender.material import Choice, build
from ...addon.choose import advice
from ...addon.reference import albedo
from ...addon.reference.quadrature import vgroove_albedo
from ...headless import scene
from ...nodegroups import random_numbers
from ..check.cook_torrance import materials
from ..check.rows import SETUPS, Row, Setup, View
from ..scenery import add_node, surface
from ..sidak import limit

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import Material, Node, NodeTree, Object, Scene
    from numpy.typing import NDArray

    from ...addon.library.presets import Preset

SIZE, SAMPLES = 32, 64
PIXEL = 1.0 / 256.0
NUMBERS = 64  # rays across one pixel, whose random numbers are counted
FIRST_SEED = 0  # as where ``check`` renders
SINGLES = 8  # pictures of one sample's numbers, of which 28 pairs a pixel
SHARED = 16  # pictures at most, over all setups, that are judged by what their samples share
SLOPE = 0.6
COPIES, APART = 64, 16.0  # instances in a row, and how far apart in units of the scale
# Toward the camera, 60 degrees from the plane's normal and along no axis, so that all three coordinates round
VIEW = Vector((0.75, 0.4330127018922193, 0.5))
WO = np.array([[np.hypot(VIEW.x, VIEW.y), 0.0, VIEW.z]])


@dataclass(frozen=True)
class Shot:
    """How a plane is seen. Metres.

    where: on each of the three axes. filter_width: in pixels; 0 for a box of one. distance: of the camera, in units of
    ``scale``. opened: with ``rays.open_aperture``. copy: which of many instances of one collection, all in one frame,
    is in the middle. seed: of Cycles'.
    """

    camera: Literal["ORTHO", "PERSP"] = "ORTHO"
    where: float = 0.0
    scale: float = 1.0
    filter_width: float = 0.0
    distance: float = 100.0
    opened: bool = False
    moving: Literal["", "object", "camera"] = ""
    copy: int | None = None
    seed: int = FIRST_SEED


@dataclass(frozen=True)
class Photo:
    """What a shot gave: the plane's picture, as a row of ``check``, and what is known of its rays."""

    row: Row
    noise: float  # root mean square of what pixels are off by, over what their samples explain
    numbers: float  # that differ, of NUMBERS^2 rays across one pixel: M of ``rays``
    rays: float  # the same as ``rays`` foresees it
    warned: str  # what the panel says


def photo(shot: Shot, setup: Setup) -> Photo:
    """The plane by ``mirror``, and the random numbers of one pixel."""
    fresnel = materials()["white"].with_parameters(m=SLOPE)
    with _shown(shot, setup, lambda: build(fresnel, Choice(setup.backend, "mirror"))) as shown:
        foreseen = rays.different_rays(shown)
        warned = [problem.text for problem in advice.problems(shown, setup.backend, "mirror") if problem.key == "rays"]
        with headless.quiet():
            image = gonio.rendered(shown).astype(np.float64)
    mean, square = moments()
    variance = np.full(image.shape, (square - mean**2) / SAMPLES)
    row = Row("picture", setup, "cook_torrance", "white", {"m": SLOPE})
    row.views.append(View(gonio.Geometry(), image, np.full(image.shape, mean), variance=variance))
    noise = float(np.sqrt(np.mean(np.square(image - mean)) / variance[0, 0, 0]))
    return Photo(row, noise, numbers(shot), foreseen, " ".join(warned))


@cache
def moments() -> tuple[float, float]:
    """Mean and mean square of what one sample of the plane is worth."""
    model = materials()["white"].with_parameters(m=SLOPE).reference()
    return float(albedo(model, WO)[0, 0]), _moment(2)


def _moment(power: int) -> float:
    return float(vgroove_albedo(WO, SLOPE, materials()["white"].reference_fresnel(), moment=power)[0, 0])


def numbers(shot: Shot) -> float:
    """How many random numbers of NUMBERS^2 rays across one pixel differ: M of ``rays``, by a picture of the numbers."""
    return rays.different(_counts(_numbers(shot, random_numbers.build)))


@cache
def _numbers(shot: Shot, _build: Callable[..., None]) -> NDArray[np.float32]:
    """The same in every setup. By what builds the node group, too: a test may put another in its place."""
    with _shown(shot, SETUPS[0], _numbers_material, across=1) as shown:
        shown.cycles.samples = 1
        shown.render.resolution_x = shown.render.resolution_y = NUMBERS
        with headless.quiet():
            return gonio.rendered(shown)


def _counts(image: NDArray[np.float32]) -> NDArray[np.int64]:
    return np.unique(image.reshape(-1, 3), axis=0, return_counts=True)[1]


@dataclass(frozen=True)
class Sharing:
    """How many random numbers differ, of 1 over the chance that two samples share theirs.

    pixel: of samples of one pixel, any in the picture. pairs: that were found alike there. picture: of any two samples.
    """

    pixel: float
    pairs: int
    picture: float


def sharing(shot: Shot) -> Sharing:
    """By pictures of the numbers, one sample each, any of those that a picture has.

    Neighbours in the sequence are spread more evenly than all are, and share less.
    """
    return _sharing(shot, random_numbers.build)


@cache
def _sharing(shot: Shot, _build: Callable[..., None]) -> Sharing:
    images = []
    with _shown(shot, SETUPS[0], _numbers_material) as shown:
        cycles = shown.cycles
        cycles.use_sample_subset, cycles.sample_subset_length = True, 1
        for sample in np.random.default_rng(FIRST_SEED).choice(np.arange(1, SAMPLES), SINGLES, replace=False):
            cycles.sample_offset = int(sample)  # never the first, which is always in the middle
            with headless.quiet():
                images.append(gonio.rendered(shown))
    drawn = np.stack(images)
    first, second = np.triu_indices(SINGLES, 1)
    alike = int(np.sum(np.all(drawn[first] == drawn[second], axis=-1)))
    return Sharing(first.size * SIZE**2 / max(alike, 1), alike, rays.different(_counts(drawn)))


def is_explained(image: NDArray[np.float64], shared: Sharing) -> bool:
    """Whether a picture whose samples share random numbers has the noise of that, and no bias beyond it.

    noise^2 / (v / N), with M that differ in a pixel, is at least 1 and N / M, and at most 1 + N / M (``rays``). By n
    pixels it is known to the root of (k - 1) / n, k the kurtosis of one sample: a mean of several has less. Of pixels
    that share all their numbers one counts: with Q that differ in the picture, Q / M. M itself is of a count of pairs.
    The mean over the picture has the variance v (1 / (n N) + 1 / Q).
    """
    (mean, square), kurtosis = moments(), _kurtosis()
    off, variance = image[..., 0] - mean, square - mean**2
    bar = limit(2 * SHARED)
    noise = float(np.mean(off**2)) * SAMPLES / variance
    known = bar * ((kurtosis - 1.0) / min(off.size, shared.picture / shared.pixel)) ** 0.5
    counted, more = bar / max(shared.pairs, 1) ** 0.5, SAMPLES / shared.pixel
    least, most = max(1.0, more * (1.0 - counted)) * (1.0 - known), (1.0 + more * (1.0 + counted)) * (1.0 + known)
    bias = bar * (variance * (1.0 / (off.size * SAMPLES) + 1.0 / shared.picture)) ** 0.5
    return bool(least <= noise <= most and abs(float(off.mean())) <= bias)


def _numbers_material() -> Material:
    group = nodegroups.ensure(random_numbers.NAME, random_numbers.REVISION, random_numbers.build)

    def shown(tree: NodeTree) -> Node:
        return add_node(tree, "Emission", Color=add_node(tree, "Group", node_tree=group))

    made = surface("VGroove gonio", shown)
    made.cycles.emission_sampling = "NONE"
    return made


@cache
def _kurtosis() -> float:
    """Of what one sample of the plane is worth."""
    a, b, c, d = map(_moment, (1, 2, 3, 4))
    return (d - 4.0 * a * c + 6.0 * a**2 * b - 3.0 * a**4) / (b - a**2) ** 2


@contextmanager
def _shown(shot: Shot, setup: Setup, make: Callable[[], Material], across: int = SIZE) -> Iterator[Scene]:
    """The scene of a shot, of ``across`` pixels; what one pixel sees may be rendered in more."""
    groups = set(bpy.data.collections)
    with gonio.stage((SIZE, SIZE), samples=SAMPLES, seed=shot.seed, shading_osl=setup.shading_osl) as shown:
        gonio.light(shown, gonio.Geometry(furnace=True))
        _planes(shown, shot, make())
        _camera(shown, shot, across)
        cycles, width = shown.cycles, shot.filter_width
        cycles.pixel_filter_type = "BLACKMAN_HARRIS" if width and across > 1 else "BOX"
        cycles.filter_width = width or 1.5
        shown.view_layers[0].update()
        if shot.moving:
            _move(shown, shown.camera if shot.moving == "camera" else shown.objects["Plane"], shot)
        if shot.opened:
            rays.open_aperture(shown)
        yield shown
    for group in set(bpy.data.collections) - groups:
        bpy.data.collections.remove(group)


def _planes(shown: Scene, shot: Shot, material: Material) -> None:
    mesh = bpy.data.meshes.new("VGroove gonio")
    mesh.from_pydata([(-4, -3, 0), (4, -3, 0), (0, 5, 0)], [], [(0, 1, 2)])
    mesh.materials.append(material)
    if shot.copy is None:
        shown.collection.objects.link(_placed(shot, bpy.data.objects.new("Plane", mesh)))
        return
    group = bpy.data.collections.new("VGroove gonio")
    group.objects.link(bpy.data.objects.new("VGroove gonio", mesh))
    for index in range(COPIES):
        one = bpy.data.objects.new("Plane", None)
        one.instance_type, one.instance_collection = "COLLECTION", group
        _placed(shot, one).location.x += APART * shot.scale * index
        shown.collection.objects.link(one)


def _placed(shot: Shot, item: Object) -> Object:
    item.location, item.scale = [shot.where] * 3, [shot.scale] * 3
    return item


def _camera(shown: Scene, shot: Shot, across: int) -> None:
    camera = bpy.data.cameras.new("VGroove gonio")
    item = bpy.data.objects.new("VGroove gonio", camera)
    distance = shot.distance * shot.scale
    item.location = Vector([shot.where] * 3) + VIEW.normalized() * distance
    item.location.x += APART * shot.scale * (shot.copy or 0)
    item.rotation_euler = VIEW.to_track_quat("Z", "Y").to_euler()
    seen = across * PIXEL * shot.scale * (shot.filter_width if shot.filter_width and across == 1 else 1.0)
    camera.clip_start, camera.clip_end = 1e-3 * distance, 2.0 * distance
    camera.type = shot.camera
    if shot.camera == "ORTHO":
        camera.ortho_scale = seen
    else:
        camera.lens = camera.sensor_width * distance / seen
    shown.collection.objects.link(item)
    shown.camera = item


def _move(shown: Scene, item: Object, shot: Shot) -> None:
    """While the shutter is open, by a tenth of the scale within the plane."""
    shown.render.use_motion_blur = True
    for frame, step in ((-1, -0.2), (1, 0.2)):
        item.location.x += step * shot.scale
        item.keyframe_insert("location", frame=shown.frame_current + frame)
        item.location.x -= step * shot.scale
    shown.frame_set(shown.frame_current)


def other_copy(shot: Shot) -> Shot:
    """The same instance at the row's other end."""
    return replace(shot, copy=COPIES - 1)


def heap(
    preset: Preset, estimator: str, bounces: int, setup: Setup, *, balls: int = 9
) -> tuple[NDArray[np.float64], str]:
    """Balls close together under a white sky, of which light returns after up to ``bounces``; what the panel says."""
    with gonio.stage((SIZE, SIZE), samples=SAMPLES, seed=FIRST_SEED, shading_osl=setup.shading_osl) as shown:
        gonio.light(shown, gonio.Geometry(furnace=True))
        cycles, side = shown.cycles, round(balls**0.5)
        cycles.pixel_filter_type = "BOX"
        for kind in ("max", "diffuse", "glossy", "transmission"):
            setattr(cycles, f"{kind}_bounces", bounces)
        mesh = scene.ball_mesh(32, 16)
        mesh.shade_flat()  # a smooth normal apart from the surface's own would lose light
        mesh.materials.append(build(preset, Choice(setup.backend, estimator)))
        for index in range(balls):
            item = bpy.data.objects.new("Ball", mesh)
            item.location = (2.02 * (index % side - (side - 1) / 2), 2.02 * (index // side - (side - 1) / 2), 0.0)
            shown.collection.objects.link(item)
        _camera(shown, Shot(scale=2.2 * side / (PIXEL * SIZE)), SIZE)
        found = advice.problems_with(shown, preset, setup.backend, estimator)
        warned = [problem.text for problem in found if problem.key == "bounces"]
        with headless.quiet():
            return gonio.rendered(shown).astype(np.float64), " ".join(warned)
