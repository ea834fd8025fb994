# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a scene, taken up again where they were left; a contact strip and a movie of them.

What a frame was rendered from is kept in its own metadata, so that only a frame that is wholly there and of the same
settings counts as done.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import blf
import bpy
import imbuf
import numpy as np

from ..addon.blender.images import attribute, load, open_image, save, tile, write
from ..addon.library.files import all_readable, check_writable, replacing
from ..nodegroups import versions
from . import scene
from .scene import SceneError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import Scene
    from numpy.typing import NDArray

MOVIES = {".mp4": ("MPEG4", "H264"), ".webm": ("WEBM", "WEBM")}  # container and codec
SMALLEST = 16  # pixels of a side that FFmpeg's codecs take
MOMENTS = 16  # at which an exposed frame is rendered: a power of two, which divides usual numbers of samples
MOST_TILES, TILE_WIDTH, LABEL_HEIGHT, GAP = 8, 240, 26, 4  # of a strip; pixels
PAPER, INK, TEXT_SIZE = 1.0, 0.15, 15
SEED_STEP = 1000003  # between moments: so that those of one seed meet no other's


def note(settings: Any) -> str:
    """What goes into a frame's metadata: the same text for the same settings, and for no others."""
    content = json.dumps(settings, sort_keys=True, default=str)
    return f"vgroove {hashlib.sha256(content.encode()).hexdigest()}"


def is_done(path: Path, wanted: str) -> bool:
    """Whether ``path`` is a picture that can be read and was rendered under this note."""
    if attribute(path, "Note") != wanted:
        return False
    with open_image(path) as file:
        return file is not None and file.read_image() is not None


def frame_to(shown: Scene, frame: int, path: Path, wanted: str, shutter: float = 0.0, **settings: Any) -> bool:
    """Render a frame to ``path`` under this note, unless it is there already; whether it was there.

    ``shutter``: of a frame, for which it is ``exposed``. ``settings``: of ``scene.still``.
    """
    if is_done(path, wanted):
        return True
    if shutter:
        save(path, expose(shown, frame, shutter, **settings), shown, {"Note": wanted})
    else:
        shown.frame_set(frame)
        scene.still(shown, path, note=wanted, **settings)
    return False


def expose(
    shown: Scene, frame: int, shutter: float, *, samples: int | None = None, seed: int | None = None, **settings: Any
) -> NDArray[np.float32]:
    """The mean picture (H, W, 3), linear light, of a frame whose shutter is open for the share ``shutter``, centred.

    Cycles' own motion blur reads materials once a frame; here each of ``MOMENTS`` is a separate render, with its part
    of the samples and its own seed, so that changes within a frame show.
    """
    samples, seed = samples or shown.cycles.samples, shown.cycles.seed if seed is None else seed
    moments, blurred = [], shown.render.use_motion_blur
    shown.render.use_motion_blur = False
    try:
        with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
            path = Path(folder) / "moment.exr"
            for k in range(MOMENTS):
                moment = frame + shutter * ((k + 0.5) / MOMENTS - 0.5)
                shown.frame_set(int(np.floor(moment)), subframe=moment - np.floor(moment))
                each = -(-samples // MOMENTS)
                scene.still(shown, path, samples=each, seed=(seed + k * SEED_STEP) % 2**31, **settings)
                moments.append(load(path))
    finally:
        shown.render.use_motion_blur, shown.cycles.samples, shown.cycles.seed = blurred, samples, seed
    return np.mean(moments, axis=0)


# Contact strip


def strip(paths: Sequence[Path], labels: Sequence[str], output: Path) -> None:
    """A PNG of up to ``MOST_TILES`` of the pictures side by side, evenly chosen, the first and last among them."""
    chosen = np.unique(np.linspace(0, len(paths) - 1, min(len(paths), MOST_TILES)).round().astype(int))
    tiles = [np.concatenate([tile(paths[k], TILE_WIDTH), _label(labels[k])]) for k in chosen]
    gap = np.full((tiles[0].shape[0], GAP, 3), PAPER, np.float32)
    parts = [part for tile in tiles for part in (gap, tile)][1:]
    with replacing(output) as temporary:
        write(temporary, np.concatenate(parts, axis=1), {})


def _label(text: str) -> NDArray[np.float32]:
    """A line of text in Blender's own font, as wide as a tile."""
    canvas = imbuf.new((TILE_WIDTH, LABEL_HEIGHT))
    blf.size(0, TEXT_SIZE)
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    blf.position(0, 4.0, 8.0, 0.0)
    with blf.bind_imbuf(0, canvas, display_name="sRGB"):
        blf.draw_buffer(0, text)
    with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
        path = Path(folder) / "label.png"
        imbuf.write(canvas, filepath=str(path))
        cover = load(path)
    return PAPER + (INK - PAPER) * cover


# Movie


def check_size(size: tuple[int, int]) -> None:
    """SceneError for frames that are too small for a movie."""
    if min(size) < SMALLEST:
        message = f"--movie: frames of {size[0]}x{size[1]} are too small; codecs need {SMALLEST}x{SMALLEST} or more"
        raise SceneError(message)


def check_movie(path: Path) -> None:
    """SceneError, before any work, for a movie that this Blender cannot write."""
    if path.suffix.lower() not in MOVIES:
        message = f"{path}: unknown ending {path.suffix!r}; movies are {' or '.join(MOVIES)}"
        raise SceneError(message)
    if not bpy.app.build_options.codec_ffmpeg:
        message = f"{path}: this Blender was built without FFmpeg and writes no movies; leave --movie out"
        raise SceneError(message)
    check_writable(path)


def movie(paths: Sequence[Path], output: Path, fps: int) -> None:
    """The pictures one after another, as they look, by Blender's own FFmpeg."""
    shown = bpy.data.scenes.new("VGroove movie")
    try:
        with all_readable(paths) as frames, replacing(output) as temporary:
            _cut(shown, frames, fps)
            shown.render.ffmpeg.format, shown.render.ffmpeg.codec = MOVIES[output.suffix.lower()]
            shown.render.filepath = str(temporary)
            bpy.ops.render.render(animation=True, scene=shown.name)
    finally:
        bpy.data.scenes.remove(shown)


def _cut(shown: Scene, frames: Sequence[Path], fps: int) -> None:
    """Make a scene that shows pictures of one folder one after another, as a movie."""
    image = bpy.data.images.load(str(frames[0]))
    width, height = image.size
    bpy.data.images.remove(image)
    row = shown.sequence_editor_create().strips.new_image("Frames", str(frames[0]), 1, 1)
    for path in frames[1:]:
        row.elements.append(path.name)
    shown.frame_start, shown.frame_end = 1, len(frames)
    render, settings = shown.render, shown.render.image_settings
    render.fps, render.resolution_percentage = fps, 100
    render.resolution_x, render.resolution_y = width - width % 2, height - height % 2  # codecs halve colour
    render.use_file_extension = False
    shown.view_settings.view_transform = "Standard"
    versions.write_as(settings, "VIDEO", "FFMPEG")
    render.ffmpeg.constant_rate_factor = "HIGH"
