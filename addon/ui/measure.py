# SPDX-License-Identifier: GPL-3.0-or-later
"""Any material into a MERL table: measured in Cycles by another Blender, so the window stays responsive."""

from __future__ import annotations

import json
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
from bpy_extras.io_utils import ExportHelper

from ..library import writing as preset_files
from ..library.errors import InputError
from ..library.files import check_writable
from . import background, thumbnails
from .own_presets import FILE_PATH
from .panels import InSidebar
from .text import lines

if TYPE_CHECKING:
    from bpy.types import Material

MODULE = ".addon.blender.merl_file"
COPY, STEPS = "material.blend", "steps"  # in the folder that a measurement has for itself
_measuring: list[Measurement] = []  # at most one
_said: list[str] = []  # how the last one ended


class Measurement:
    """A material that another Blender measures. InputError if it cannot be, OSError if no Blender starts."""

    def __init__(self, found: Material, output: Path, samples: int, *, runs_osl: bool) -> None:
        from ..blender import merl_file

        merl_file.of_material(found, runs_osl=runs_osl)  # refuses what lets light through
        self.name, self.output, self.bands = found.name, output, merl_file.BANDS
        self.folder = Path(tempfile.mkdtemp(prefix="vgroove-"))
        try:
            bpy.data.libraries.write(str(self.folder / COPY), {found}, path_remap="ABSOLUTE")
            key = key_of(found, samples, runs_osl=runs_osl)
            of = {"file": str(self.folder / COPY), "material": found.name, "output": str(output), "key": key}
            of |= {"steps": str(self.folder / STEPS), "samples": samples, "osl": runs_osl}
            self.job = background.Job(command(json.dumps(of | {"frame": bpy.context.scene.frame_current})))
        except OSError:
            shutil.rmtree(self.folder, ignore_errors=True)
            raise

    @property
    def done(self) -> int:
        """Bands of all ``bands``."""
        try:
            return int((self.folder / STEPS).read_text(encoding="utf-8"))
        except (OSError, ValueError):  # none yet
            return 0

    def close(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)


def command(of: str) -> list[str]:
    """The other Blender's command line; empty where there is none."""
    return background.command(MODULE, of)


class VGROOVE_OT_measure_material(bpy.types.Operator, ExportHelper):
    """Measure the active material into a MERL table."""

    bl_idname = "vgroove.measure_material"
    bl_label = "Measure This Material"
    bl_description = (
        "Measure the active material in Cycles into a MERL table, whatever nodes it has. For surfaces that reflect "
        "alike everywhere and when turned. Esc stops; the same file name resumes"
    )
    bl_options = {"REGISTER"}

    filename_ext = ".binary"
    filepath: FILE_PATH
    filter_glob: bpy.props.StringProperty(default="*.binary", options={"HIDDEN"})
    samples: bpy.props.IntProperty(
        name="Samples", description="Per entry; more for materials that are noisy under one sun", default=1, min=1,
        soft_max=64, max=4096,
    )  # fmt: skip

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not bpy.app.build_options.cycles_osl:
            cls.poll_message_set("This Blender was built without OSL, which the measuring camera needs")
            return False
        if context.object is None or context.object.active_material is None:
            cls.poll_message_set("Select an object with a material")
            return False
        if _measuring:
            cls.poll_message_set(f"{_measuring[0].name} is being measured; wait, or press Esc")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.filepath = f"{preset_files.file_name(context.object.active_material.name)}.binary"
        return ExportHelper.invoke(self, context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        found, path = context.object.active_material, Path(bpy.path.abspath(self.filepath)).absolute()
        runs_osl = bool(getattr(context.scene.cycles, "shading_system", False))
        if path.suffix.lower() != ".binary":
            self.report({"ERROR"}, f"{path}: MERL tables are .binary files; name one that ends in .binary")
            return {"CANCELLED"}
        try:
            check_writable(path)
            if not command("{}"):
                measure_here(found, path, self.samples, runs_osl=runs_osl)
                self.report({"INFO"}, f"Wrote {path}")
                return {"FINISHED"}
            _measuring.append(Measurement(found, path, self.samples, runs_osl=runs_osl))
        except (InputError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        _said.clear()
        bpy.app.timers.register(_look, first_interval=background.PAUSE, persistent=True)
        bpy.app.timers.register(_listen, first_interval=0.1)  # once the file browser is closed
        return {"FINISHED"}


class VGROOVE_OT_stop_measuring(bpy.types.Operator):
    """Stop the measurement."""

    bl_idname = "vgroove.stop_measuring"
    bl_label = "Stop"
    bl_description = "Stop measuring. What is done is kept: measure into the same file to resume"
    bl_options = {"INTERNAL"}

    def execute(self, _context: bpy.types.Context) -> set[str]:
        stop()
        return {"FINISHED"}


class VGROOVE_OT_watch_measuring(bpy.types.Operator):
    """Let Esc stop the measurement, and report how it ends."""

    bl_idname = "vgroove.watch_measuring"
    bl_label = "Measuring"
    bl_options = {"INTERNAL"}

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        self._timer = context.window_manager.event_timer_add(background.PAUSE, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type == "ESC" and event.value == "PRESS":
            stop()
        if _measuring:
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self._timer)
        for text in _said:
            self.report({"INFO"}, text)
        return {"FINISHED"}


def key_of(found: Material, samples: int, *, runs_osl: bool) -> str:
    """What is resumed: the same material, as it is at this frame, measured in the same way."""
    from ..blender import merl_file

    return json.dumps([merl_file.digest(found), samples, runs_osl, bpy.context.scene.frame_current])


def measure_here(found: Material, path: Path, samples: int, *, runs_osl: bool) -> None:
    """In this session, which waits: where Blender is a module of Python."""
    from ..blender import merl_file

    make, osl = merl_file.of_material(found, runs_osl=runs_osl)
    key = key_of(found, samples, runs_osl=runs_osl)
    for _ in merl_file.measured(make, path, key, samples=samples, shading_osl=osl):
        pass


def stop() -> None:
    """End the measurement; what is done stays beside the file."""
    if not _measuring:
        return
    of = _measuring.pop()
    _end(f"Stopped at {of.done} of {of.bands}; measure into {of.output.name} again to resume")
    of.job.stop()
    of.close()


def _end(text: str) -> None:
    _said[:] = [text]
    thumbnails.redraw()


def _look() -> float | None:
    """Called by Blender until nothing is measured."""
    if not _measuring:
        return None
    (of,) = _measuring
    if of.job.is_running:
        thumbnails.redraw()
        return background.PAUSE
    _measuring.clear()
    failure = of.job.failure().rpartition("Error: ")[2]  # without the name of the exception
    _end(f"{of.name} is not measured: {failure}" if failure else f"Wrote {of.output}")
    of.close()
    return None


def _listen() -> None:
    """Once, as only a window has events."""
    windows = bpy.context.window_manager.windows
    if _measuring and windows:
        with bpy.context.temp_override(window=windows[0]):
            bpy.ops.vgroove.watch_measuring("INVOKE_DEFAULT")


class VGROOVE_PT_measure(InSidebar, bpy.types.Panel):
    """Measure the active material."""

    bl_label = "Measure Material"
    bl_parent_id = "VGROOVE_PT_measured"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator("vgroove.measure_material", icon="MATERIAL")
        for of in _measuring:
            row = layout.row(align=True)
            row.progress(factor=of.done / of.bands, text=f"{of.name}: {of.done} of {of.bands}")
            row.operator("vgroove.stop_measuring", text="", icon="X")
        for text in _said:
            lines(layout, text, context.region.width)


def unregister() -> None:
    """Blender ends, or the extension is switched off."""
    stop()
    for timer in (_look, _listen):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)


CLASSES: tuple[Any, ...] = (
    VGROOVE_OT_measure_material,
    VGROOVE_OT_stop_measuring,
    VGROOVE_OT_watch_measuring,
    VGROOVE_PT_measure,
)
