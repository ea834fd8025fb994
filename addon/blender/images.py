# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as arrays: Blender's images, and files by the OpenImageIO that comes with it."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ..library.files import readable, replacing
from ..library.inputs import MOST_SIDE
from . import colour_space

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from bpy.types import Image, Scene
    from numpy.typing import NDArray

MIN_FREE_BYTES = 2**20  # a disk with less left beside a picture counts as full
MAGIC = b"\x76\x2f\x31\x01", b"\x89PNG\r\n\x1a\n"  # first bytes of an EXR and of a PNG
MAX_TILE_ASPECT = 4  # height of a tile over its width


def pixels(image: Image) -> NDArray[np.float32]:
    """RGB as stored, (H, W, 3), row 0 on top."""
    flat = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(flat)
    width, height = image.size
    return flat.reshape(height, width, -1)[::-1, :, :3]


def write(
    path: Path, picture: NDArray[np.floating], attributes: Mapping[str, Any], space: str = colour_space.OF_REC709
) -> None:
    """Write (H, W, 3) with attributes: float32 EXR, or by another ending (PNG, WebP) 8 bits of the range 0 to 1.

    space: the colour space that an EXR's values are in, which the file states. OSError where that fails.
    """
    import OpenImageIO as oiio  # noqa: N813 - its usual name. The one inside the bpy wheel: headless.prepare() has put it first

    is_float = path.suffix.lower() == ".exr"
    height, width, _ = picture.shape
    spec = oiio.ImageSpec(width, height, 3, "float" if is_float else "uint8")
    if is_float:
        spec.attribute("oiio:ColorSpace", space)
        spec.attribute("compression", "zip")
    for name, value in attributes.items():
        spec.attribute(name, value)
    file = oiio.ImageOutput.create(str(path))
    values = np.ascontiguousarray(picture, np.float32)
    if file is None or not (file.open(str(path), spec) and file.write_image(values) and file.close()):
        why = f"cannot be written: {file.geterror() if file else oiio.geterror()}"
        if path.parent.is_dir() and shutil.disk_usage(path.parent).free < values.nbytes + MIN_FREE_BYTES:
            why = "the disk is full; make room, and give the same command again"
        message = f"{path}: {why}"
        raise OSError(message)


def save(path: Path, picture: NDArray[np.floating], shown: Scene, attributes: Mapping[str, Any]) -> None:
    """A picture in linear light as EXR, in the working space as Blender's own, or as it looks in the scene as PNG.

    Whole or not at all.
    """
    with replacing(path) as temporary:
        picture = picture if path.suffix.lower() == ".exr" else displayed(picture, shown)
        write(temporary, picture, attributes, colour_space.name())


@contextmanager
def open_image(path: Path) -> Iterator[Any]:
    """An EXR or a PNG as OpenImageIO reads it; None if it is neither, unreadable, or larger than any of ours.

    OpenImageIO itself would try each of its formats in turn, which takes minutes for a large file that is of none.
    """
    import OpenImageIO as oiio  # noqa: N813 - as in write

    try:
        with readable(path) as found, found.open("rb") as begin:
            file = oiio.ImageInput.open(str(found)) if begin.read(8).startswith(MAGIC) else None
    except OSError:
        file = None
    if file is None:
        oiio.geterror()  # else told at the very end of the process
        yield None
        return
    try:
        spec = file.spec()
        yield file if max(spec.width, spec.height) <= MOST_SIDE else None
    finally:
        file.close()


def attribute(path: Path, name: str) -> Any:
    """One of a file's attributes, None where it has none of that name or cannot be read."""
    with open_image(path) as file:
        try:
            return file and file.spec().getattribute(name)
        except UnicodeDecodeError:  # nothing of ours
            return None


def digest(path: Path) -> str:
    """The SHA-256 of the values that a file's picture has as float32; empty where it cannot be read."""
    with open_image(path) as file:
        values = file and file.read_image("float")
    return "" if values is None else digest_of_values(values)


def digest_of_values(picture: NDArray[np.floating]) -> str:
    """``digest`` of a picture that is written as EXR."""
    return hashlib.sha256(np.ascontiguousarray(picture, np.float32).tobytes()).hexdigest()


def load(path: Path) -> NDArray[np.float32]:
    """``pixels`` of a file."""
    with readable(path) as found:
        image = bpy.data.images.load(str(found))
        try:
            return pixels(image)
        finally:
            bpy.data.images.remove(image)


def tile(path: Path, width: int, paper: float = 1.0) -> NDArray[np.float32]:
    """A file's picture as it looks, (H, width, 3) in sRGB; what is linear is taken through sRGB's own curve.

    A picture more than ``MAX_TILE_ASPECT`` times as high as wide is centred, with ``paper`` beside it.
    """
    with open_image(path) as file:
        if file is None:
            message = f"{path}: is no picture"
            raise RuntimeError(message)
    with readable(path) as found:
        image = bpy.data.images.load(str(found))
        try:
            across, height = image.size
            factor = min(width / across, MAX_TILE_ASPECT * width / height)
            image.scale(max(1, round(across * factor)), max(1, round(height * factor)))
            scaled = pixels(image)
        finally:
            bpy.data.images.remove(image)
    if path.suffix.lower() == ".exr":
        scaled = srgb(scaled)
    beside = width - scaled.shape[1]
    around = ((0, 0), (beside // 2, beside - beside // 2), (0, 0))
    return np.pad(scaled, around, constant_values=paper)


def srgb(linear: NDArray[np.float32]) -> NDArray[np.float32]:
    """IEC 61966-2-1."""
    c = np.clip(linear, 0.0, 1.0)
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1.0 / 2.4) - 0.055)


def displayed(picture: NDArray[np.float32], shown: Scene) -> NDArray[np.float32]:
    """Through the scene's view transform, 0..1."""
    height, width, _ = picture.shape
    image = bpy.data.images.new("Frame", width, height, float_buffer=True)
    full = np.concatenate([picture[::-1], np.ones((height, width, 1), np.float32)], axis=-1)
    image.pixels.foreach_set(full.ravel())
    settings = shown.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "PNG", "RGB", "8"
    try:
        with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
            path = Path(folder) / "frame.png"
            image.save_render(str(path), scene=shown)
            return load(path)
    finally:
        bpy.data.images.remove(image)
