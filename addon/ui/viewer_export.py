# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF Viewer's plots as a file: PNG and SVG as they are drawn, CSV with their numbers."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import bpy
import gpu
import numpy as np
from bpy_extras.io_utils import ExportHelper
from mathutils import Matrix

from ..library.files import replacing
from ..reference import lobe
from . import viewer, viewer_draw, viewer_plots

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

FORMATS = (
    (".png", "PNG", "A picture of the plots, three pixels for each of the viewport's"),
    (".svg", "SVG", "A drawing of the plots, for papers and pages"),
    (".csv", "CSV", "The numbers: R, G, B in linear Rec.709 and their luminance Y, in 1/sr"),
)
PAPER, INK = (1.0, 1.0, 1.0, 1.0), (0.13, 0.13, 0.13, 1.0)
SCALE = 3


class VGROOVE_OT_export_plots(bpy.types.Operator, ExportHelper):
    """Write the plots to a file."""

    bl_idname = "vgroove.export_plots"
    bl_label = "Export Plots"
    bl_description = "Write the plots that are shown to a file: PNG, SVG, or CSV with their numbers"
    bl_options: ClassVar[set[str]] = {"REGISTER"}

    filepath: bpy.props.StringProperty(
        name="File Path", description="The file", subtype="FILE_PATH", options={"PATH_SUPPORTS_BLEND_RELATIVE"}
    )
    filter_glob: bpy.props.StringProperty(default="*.png;*.svg;*.csv", options={"HIDDEN"})
    file_format: bpy.props.EnumProperty(name="Format", description="Kind of file", items=FORMATS)
    if TYPE_CHECKING:
        report: Any
        poll_message_set: Any

    @property
    def filename_ext(self) -> str:  # which the file browser adds
        return self.file_format

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not context.scene.vgroove_viewer.plots:
            cls.poll_message_set("Choose a plot")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        path = Path(bpy.path.abspath(self.filepath)).with_suffix(self.file_format)
        scene = context.scene
        wi = viewer.toward_light(scene, getattr(context, "region_data", None), viewer.frame(scene))
        shown = viewer_draw.plots(context, wi, INK) if wi is not None and wi[2] > 0.0 else []
        if not shown:
            self.report({"WARNING"}, "There is nothing to plot. The panel says why")
            return {"CANCELLED"}
        names = [name for name, *_ in viewer_plots.ITEMS if name in scene.vgroove_viewer.plots]
        try:
            if self.file_format == ".csv":
                found = {name: viewer_draw.plot_curves(context, name, wi) for name in names}
                content = csv_text(found).encode()
            elif self.file_format == ".svg":
                content = viewer_plots.svg(shown, PAPER).encode()
            else:
                content = png(rasterized(shown))
            with replacing(path) as temporary:
                temporary.write_bytes(content)
        except OSError as error:
            self.report({"ERROR"}, f"{path} cannot be written: {error.strerror or error}")
            return {"CANCELLED"}
        except SystemError as error:  # Blender has no window, and no GPU was started
            self.report({"ERROR"}, f"A PNG is drawn by the GPU, which this Blender does not use: {error}. Choose SVG")
            return {"CANCELLED"}
        self.report({"INFO"}, f"Wrote {path}")
        return {"FINISHED"}


def csv_text(curves: Mapping[str, Sequence[viewer_plots.Curve]]) -> str:
    """A line for each plot, material, source and angle."""
    import csv  # here, as Blender imports this file when it starts

    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["plot", "angle (deg)", "material", "source", *"RGBY"])
    for plot, among in curves.items():
        for one in among:
            source = "measured" if one.measured else "formula"
            values = np.concatenate([one.rgb, one.rgb @ lobe.LUMINANCE[:, None]], axis=-1)
            for at, row in zip(one.at.tolist(), values.tolist(), strict=True):
                writer.writerow([plot.lower(), f"{at:.9g}", one.name, source, *(f"{number:.9g}" for number in row)])
    return file.getvalue()


def rasterized(plots: Iterable[viewer_plots.Plot]) -> NDArray[np.uint8]:
    """(H, W, 3) in sRGB, row 0 on top, drawn by the GPU; SystemError where Blender uses none."""
    plots = list(plots)
    width, height = (round(SCALE * side) for side in viewer_plots.size_of(len(plots)))
    offscreen = gpu.types.GPUOffScreen(width, height)
    try:
        with offscreen.bind(), gpu.matrix.push_pop(), gpu.matrix.push_pop_projection():
            gpu.matrix.load_matrix(Matrix.Identity(4))
            across = Matrix.Diagonal((2.0 / width, 2.0 / height, 1.0, 1.0))
            gpu.matrix.load_projection_matrix(Matrix.Translation((-1.0, -1.0, 0.0)) @ across)
            buffer = gpu.state.active_framebuffer_get()
            buffer.clear(color=PAPER)
            viewer_plots.draw(plots, float(SCALE), (0.0, 0.0), PAPER)
            read = buffer.read_color(0, 0, width, height, 4, 0, "UBYTE")
    finally:
        offscreen.free()
    read.dimensions = width * height * 4
    return np.array(read, dtype=np.uint8).reshape(height, width, 4)[::-1, :, :3]


def png(rgb: NDArray[np.uint8]) -> bytes:
    """A picture (H, W, 3) as a PNG file: ISO/IEC 15948, 8 bits a channel, rows without a filter."""

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    height, width, _ = rgb.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), rgb.reshape(height, -1)], axis=1)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(rows.tobytes()))
        + chunk(b"IEND", b"")
    )


CLASSES = (VGROOVE_OT_export_plots,)
