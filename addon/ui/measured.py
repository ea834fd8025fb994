# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured BRDFs become presets of the user's own: the table itself, or what is fitted to it.

Another Blender fits and renders both pictures; the panel shows them, and the artist keeps one. Scripts name the form.
"""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import bpy.utils.previews
from bpy_extras.io_utils import ImportHelper

from ..library import presets
from ..library import writing as preset_files
from ..library.errors import InputError
from . import background, pictures, thumbnails
from .own_presets import FILE_PATH, poll_folder
from .panels import InSidebar
from .text import lines

if TYPE_CHECKING:
    from ..choose.compare import Compared
    from ..library.presets import Preset

ENDINGS = "*.binary;*.bsdf;*.astm;*.bin"
FORMATS = "MERL .binary, RGL .bsdf, ASTM E1392 text or UTIA .bin"
MODULE = ".addon.choose.compare"
LARGE = 6.0  # scale of the two pictures
FORMS = (
    ("table", "Measured", "The table itself. Exact Lights and Reference render it; Standard shows what is near it"),
    ("fit", "Fitted", "A diffuse part and lobes that come nearest to the table; their values can be edited"),
)
COMPARE = ("compare", "Compare", "Shows a picture of both in the panel Measured BRDF, to choose one")
_models: list[tuple[str, str, str]] = []  # Blender keeps no texts of its own
_compared: list[Comparison] = []  # at most one


class Comparison:
    """A file whose two forms another Blender makes. OSError if it cannot be started."""

    def __init__(self, path: Path, lobes: int, kind: str) -> None:
        from ..choose.compare import Compared

        self.path, self.failure = path, ""
        self.folder = Path(tempfile.mkdtemp(prefix="vgroove-"))
        self.made: Compared = Compared(self.folder)
        self.icons: Any = None  # once both pictures are there
        try:
            self.job = background.Job(command(path, self.folder, lobes, kind))
        except OSError:
            shutil.rmtree(self.folder, ignore_errors=True)
            raise

    @property
    def is_running(self) -> bool:
        return self.icons is None and not self.failure

    def look(self) -> None:
        """Take over what has ended."""
        if not self.is_running or self.job.is_running:
            return
        self.failure = self.job.failure()
        if not self.failure:
            self.icons = bpy.utils.previews.new()
            for form, *_ in FORMS:
                self.icons.load(form, str(self.made.picture(form)), "IMAGE")

    def close(self) -> None:
        """Nothing stays of it."""
        if self.is_running:
            self.job.stop()
        if self.icons is not None:
            bpy.utils.previews.remove(self.icons)
        shutil.rmtree(self.folder, ignore_errors=True)


def command(path: Path, folder: Path, lobes: int, kind: str) -> list[str]:
    """The other Blender's command line; empty where there is none."""
    return background.command(MODULE, str(path), str(folder), str(lobes), kind)


def models(_self: Any, _context: Any) -> list[tuple[str, str, str]]:
    """What can be fitted, as Blender's items."""
    if not _models:
        from ..measured.lobes import KINDS
        from ..models import MODELS

        _models.extend((name, MODELS[name].label, f"At most {of.most} lobes") for name, of in KINDS.items())
    return _models


class Keeps:
    """What ``keep`` asks of an operator."""

    copy_table: bpy.props.BoolProperty(
        name="Copy Table", description="Copy the file beside your presets; if off, the preset names it where it is",
        default=True,
    )  # fmt: skip
    apply: bpy.props.BoolProperty(name="Apply", description="Apply the preset to the selected objects", default=False)


class VGROOVE_OT_import_measured(bpy.types.Operator, ImportHelper, Keeps):
    """Make a preset of a measured BRDF."""

    bl_idname = "vgroove.import_measured"
    bl_label = "Import Measured BRDF"
    bl_description = f"Make a preset of a measured BRDF: {FORMATS}"
    bl_options = {"REGISTER", "UNDO"}  # of the choice; files stay

    filename_ext = ".binary"
    filepath: FILE_PATH
    filter_glob: bpy.props.StringProperty(default=ENDINGS, options={"HIDDEN"})
    form: bpy.props.EnumProperty(name="As", description="What the preset is", items=(COMPARE, *FORMS))
    model: bpy.props.EnumProperty(name="Model", description="What is fitted to the table", items=models)
    lobes: bpy.props.IntProperty(name="Lobes", description="How many lobes the fit may have", default=2, min=1, max=4)

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return poll_folder(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..measured.as_preset import Source
        from ..measured.lobes import KINDS

        path, lobes = Path(bpy.path.abspath(self.filepath)), min(self.lobes, KINDS[self.model].most)
        try:
            source = Source.read(path)
            if not source.table.contents.isotropic:
                self.report({"ERROR"}, f"{path} is anisotropic; presets take isotropic measurements")
                return {"CANCELLED"}
            if self.form == COMPARE[0]:
                return self._compare(path, lobes)
            if self.form == FORMS[0][0]:
                preset, says = source.as_table(str(path.absolute())), ""
            else:
                *_, last = source.fits(lobes, self.model, "l1")
                preset, says = last.preset, last.says
        except (InputError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return keep(self, context, preset, says)

    def _compare(self, path: Path, lobes: int) -> set[str]:
        if not command(path, path, lobes, self.model):
            self.report({"ERROR"}, "Blender as a Python module has no background; set As to Measured or Fitted")
            return {"CANCELLED"}
        close()
        _compared.append(Comparison(path, lobes, self.model))
        bpy.app.timers.register(_look, first_interval=background.PAUSE, persistent=True)
        self.report({"INFO"}, f"Fitting and rendering {path.name}: see the panel Measured BRDF")
        return {"FINISHED"}


class VGROOVE_OT_keep_measured(bpy.types.Operator, Keeps):
    """Keep one of the two forms as a preset."""

    bl_idname = "vgroove.keep_measured"
    bl_label = "Add to My Presets"
    bl_description = "Save this form as a preset in your folder"
    bl_options = {"REGISTER", "UNDO"}  # of the choice and of the material; the file stays

    form: bpy.props.EnumProperty(name="As", description="What the preset is", items=FORMS)

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        of = next(text for form, _, text in FORMS if form == properties.form)
        return f"{of}. Saves it as a preset in your folder" + " and applies it" * properties.apply

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        if not _compared or _compared[0].icons is None:
            cls.poll_message_set("Import a measured BRDF first")
            return False
        return poll_folder(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        made = _compared[0].made
        try:
            preset, says = made.preset(self.form), made.says if self.form == FORMS[1][0] else ""
        except (InputError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return keep(self, context, preset, says)


class VGROOVE_OT_close_measured(bpy.types.Operator):
    """Close the comparison."""

    bl_idname = "vgroove.close_measured"
    bl_label = "Close"
    bl_description = "Stop the comparison and remove its pictures; presets that you added stay"
    bl_options = {"INTERNAL"}

    def execute(self, _context: bpy.types.Context) -> set[str]:
        close()
        return {"FINISHED"}


def keep(operator: Any, context: bpy.types.Context, preset: Preset, says: str) -> set[str]:
    """Save a preset by a free name, with its table beside it if wanted; choose it, and apply it if wanted."""
    folder = presets.user_folder()
    if folder is None:
        return {"CANCELLED"}
    try:
        if preset.table is not None and operator.copy_table:
            preset = replace(preset, table=preset_files.copy_table(preset.table, folder))
        saved = preset_files.save(replace(preset, name=preset_files.free_name(preset.name, folder)), folder)
    except (InputError, OSError) as error:
        operator.report({"ERROR"}, str(error))
        return {"CANCELLED"}
    context.scene.vgroove.preset = saved.id
    pictures.request(saved.id)
    operator.report({"INFO"}, f"{saved.name} saved in {folder}" + f"; it {says}" * bool(says))
    if not operator.apply:
        return {"FINISHED"}
    if not bpy.ops.vgroove.apply.poll():
        operator.report({"WARNING"}, f"{saved.name} is saved; select objects to apply it")
        return {"FINISHED"}
    try:
        bpy.ops.vgroove.apply()  # within this operator's step of undo
    except RuntimeError as error:  # what it reports as an error
        operator.report({"WARNING"}, str(error).removeprefix("Error: ").strip())
    return {"FINISHED"}


class VGROOVE_PT_measured(InSidebar, bpy.types.Panel):
    """Import measured BRDFs, and measure materials."""

    bl_label = "Measured BRDF"
    bl_parent_id = "VGROOVE_PT_material"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, width = self.layout, context.region.width
        layout.operator("vgroove.import_measured", icon="IMPORT")
        for of in _compared:
            _draw(layout.box(), of, width)


def _draw(box: bpy.types.UILayout, of: Comparison, width: int) -> None:
    row = box.row()
    row.label(text=of.path.name)
    row.operator("vgroove.close_measured", text="", icon="X")
    if of.failure:
        lines(box, of.failure, width, icon="ERROR")
    elif of.icons is None:
        lines(box, "Fitting and rendering in the background...", width)
    else:
        row = box.row()
        for form, label, _ in FORMS:
            column = row.column(align=True)
            column.label(text=label)
            column.template_icon(icon_value=of.icons[form].icon_id, scale=LARGE)
            for text, apply in (("Add", False), ("Add and Apply", True)):
                button = column.operator("vgroove.keep_measured", text=text)
                button.form, button.apply = form, apply
        lines(box, f"Fitted {of.made.says}", width)


def close() -> None:
    """No comparison any more."""
    while _compared:
        _compared.pop().close()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)


def _look() -> float | None:
    """Called by Blender until the comparison is there."""
    for of in _compared:
        of.look()
        if of.is_running:
            return background.PAUSE
    thumbnails.redraw()
    return None


def _draw_import(self: Any, _context: bpy.types.Context) -> None:
    self.layout.operator("vgroove.import_measured", text="Measured BRDF (.binary, .bsdf, .astm, .bin)")


def register() -> None:
    """A line of File > Import."""
    bpy.types.TOPBAR_MT_file_import.append(_draw_import)


def unregister() -> None:
    """Blender ends, or the extension is switched off."""
    bpy.types.TOPBAR_MT_file_import.remove(_draw_import)
    close()


CLASSES = (
    VGROOVE_OT_import_measured,
    VGROOVE_OT_keep_measured,
    VGROOVE_OT_close_measured,
    VGROOVE_PT_measured,
)
