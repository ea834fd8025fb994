# SPDX-License-Identifier: GPL-3.0-or-later
"""What all groups of a measured table share: its image, and the lookup of f.

The image has a tile for each theta_h (``addon/measured/model.py``). Within a tile Cycles interpolates; two are mixed.
"""

from __future__ import annotations

import tempfile
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ..addon.measured.merl import THETA_D, THETA_H
from ..addon.measured.model import COLUMNS, ROWS, atlas
from ..addon.models.measured import MODEL
from . import REVISION_KEY
from ._tree import Value, cross, dot, length, maximum, minimum, normalize, output, scale, sqrt, vector

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from ..addon.measured.model import Measured
    from ..addon.models import Form
    from ._tree import Number, Tree

IMAGE_NAME, REVISION = "VGroove Measured", 2
LARGEST_HALF = 65504.0
SPACE = "Linear Rec.709"  # of tables: Blender converts images to the working space of whatever file they are in
LAMBERT, BESIDE, LOBE = range(3)  # the texels of ``colour``


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    of = MODEL.reference(form, {})
    return f"{MODEL.kinds[form.kind]} {of.digest}".strip(), {"of": of, "kind": form.kind}


def image(of: Measured, kind: str) -> bpy.types.Image:
    """The table, packed: one for the same table in a .blend. 16 bits a value where ``kind`` and the values let it."""
    half = kind == "half" and float(np.max(of.table.table)) <= LARGEST_HALF
    return _packed(f"{IMAGE_NAME} {of.digest}" + " Float" * (not half), lambda: atlas(of.table), half=half)


def colour(tree: Tree, of: Measured, which: int) -> Value:
    """A colour of the table as a texel, for the working space's sake: ``LAMBERT``, or of ``Measured.closure``.

    Of the part that is Lambert, and of the two of ``closure``, whose diffuse one is ``BESIDE`` the peak.
    """
    texels = _packed(f"{IMAGE_NAME} {of.digest} Colors", lambda: np.array([[of.albedo, *of.closure[:2]]]), half=False)
    place: Number = Value(tree, output(tree.node("ShaderNodeCombineXYZ", X=(which + 0.5) / 3.0, Y=0.5), "Vector"))
    node = tree.node("ShaderNodeTexImage", image=texels, interpolation="Closest", extension="EXTEND", Vector=place)
    return Value(tree, output(node, "Color"))


def _packed(title: str, pixels: Callable[[], NDArray[np.float64]], *, half: bool) -> bpy.types.Image:
    for known in bpy.data.images:
        if known.name.split(".")[0] == title and known.get(REVISION_KEY) == REVISION and known.library is None:
            return known
    with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
        path = Path(folder) / "table.exr"
        _write(path, pixels(), half=half)
        made = bpy.data.images.load(str(path))
        made.name = title
        made.colorspace_settings.name = SPACE
        made.alpha_mode = "CHANNEL_PACKED"
        made.pack()
    made.filepath_raw = made.packed_files[0].filepath = ""  # no update: it would look for the file that is gone
    made[REVISION_KEY] = REVISION
    return made


def _write(path: Path, pixels: NDArray[np.float64], *, half: bool) -> None:
    import OpenImageIO as oiio  # noqa: N813 - its usual name; comes with Blender

    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, "half" if half else "float")
    spec.attribute("compression", "zip")
    file = oiio.ImageOutput.create(str(path))
    values = np.ascontiguousarray(pixels[::-1], np.float32)
    if file is None or not (file.open(str(path), spec) and file.write_image(values) and file.close()):
        message = f"{path}: cannot be written: {file.geterror() if file else oiio.geterror()}"
        raise OSError(message)


def reflectance(tree: Tree, of: Measured, texture: bpy.types.Image, N: Value, wi: Value, wo: Value) -> Value:
    """f in 1/sr, RGB, of directions above the surface: ``Merl.look_up``."""
    phi_d = of.table.table.shape[3]
    wide, high = phi_d + 2, THETA_D + 2
    with tree.frame("theta_h, theta_d and phi_d"):
        both = wi + wo
        h, vh = normalize(both), 0.5 * length(both)
        nh = dot(N, h)
        x = scale(h, nh) - N  # sin(theta_h) long, in the plane of h and N
        theta_h = tree.math("ARCTAN2", length(x), nh)
        theta_d = tree.math("ARCTAN2", 0.5 * length(wi - wo), vh)
        aside = wi - scale(h, vh)
        turn = tree.math("ARCTAN2", dot(aside, cross(h, x)), dot(aside, x))
        turn = tree.math("FLOORED_MODULO", turn, phi_d * pi / 180.0)
    with tree.frame("The tile before and the tile after"):
        i = _held(sqrt(theta_h * (2.0 / pi)) * float(THETA_H) - 0.5, THETA_H - 1.0)
        up = _held(theta_d * (2.0 / pi * THETA_D) - 0.5, THETA_D - 1.0) + 1.5
        along = turn * (180.0 / pi) + 1.0
        before = minimum(tree.math("FLOOR", i), THETA_H - 2.0)
        f = [_texel(tree, texture, before + step, along, up, wide, high) for step in (0.0, 1.0)]
        return f[0] + (f[1] - f[0]) * (i - before)


def _held(a: Value, high: float) -> Value:
    return minimum(maximum(a, 0.0), high)


def _texel(tree: Tree, texture: bpy.types.Image, tile: Value, along: Value, up: Value, wide: int, high: int) -> Value:
    row = tree.math("FLOOR", (tile + 0.5) * (1.0 / COLUMNS))
    column = tile - row * float(COLUMNS)
    u = (column * float(wide) + along) * (1.0 / (COLUMNS * wide))
    v = (row * float(high) + up) * (1.0 / (ROWS * high))
    place: Number = vector(u, v, 0.0)
    node = tree.node("ShaderNodeTexImage", image=texture, interpolation="Linear", extension="EXTEND", Vector=place)
    return Value(tree, output(node, "Color"))
