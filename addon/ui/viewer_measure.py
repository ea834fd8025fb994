# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure in Cycles: the active material's values as points in the BRDF Viewer's plots, by another Blender."""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import bpy
import numpy as np

from . import background, viewer
from .text import lines

if TYPE_CHECKING:
    from ..blender.measuring import Points
    from ..reference.directions import Floats

MODULE = ".addon.blender.measuring"
PAUSE = 0.25  # seconds between looks at the other Blender
NEAR = 1e-3  # radians; a light that turned by less is the one that was measured under
NO_OSL = "This Blender has no OSL, which the instrument's camera is written in. Those from blender.org have it"


@dataclass(frozen=True)
class Measured:
    """wi: to the light, (3,). points: by plot."""

    wi: Floats
    points: dict[str, Points]


_measured: dict[int, Measured] = {}  # by the material's session_uid
_running: list[Job] = []  # at most one


def points_of(of: bpy.types.Material, wi: Floats, plot: str) -> Points | None:
    """What was measured of a material under this light; None if nothing was."""
    found = _measured.get(of.session_uid)
    if found is None or np.linalg.norm(found.wi - wi) > NEAR:
        return None
    return found.points[plot]


class Job:
    """A measurement in another Blender, and its folder."""

    def __init__(self, of: bpy.types.Material, wi: Floats, *, shading_osl: bool) -> None:
        from ..blender import measuring  # here, as Blender imports this file when it starts

        self.name, self.uid, self.wi = of.name, of.session_uid, wi
        self.folder = Path(tempfile.mkdtemp(prefix="vgroove-"))
        try:
            theta_i = float(np.degrees(np.arctan2(np.hypot(wi[0], wi[1]), wi[2])))
            phi_i = float(np.degrees(np.arctan2(wi[1], wi[0])))
            measuring.hand_over(of, theta_i, phi_i, self.folder, shading_osl=shading_osl)
            self.blender = background.Job(command(self.folder))
        except Exception:
            self._clear()
            raise

    @property
    def progress(self) -> float:
        from ..blender import measuring  # here, as Blender imports this file when it starts

        return measuring.progress_in(self.folder)

    def finish(self) -> str:
        """Take the points of a process that has ended; why there are none, or ""."""
        try:
            problem = self._take()
        except OSError as error:
            problem = str(error)
        self._clear()
        return problem and f"{self.name} was not measured: {problem}"

    def _take(self) -> str:
        from ..blender import measuring  # here, as Blender imports this file when it starts

        if why := self.blender.failure():
            return f"Blender in the background ended with {self.blender.process.returncode}: {why}"
        _measured[self.uid] = Measured(self.wi, measuring.points_in(self.folder))
        return ""

    def stop(self) -> None:
        self.blender.stop()
        self._clear()

    def _clear(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)


def unavailable() -> str:
    """Why this Blender cannot measure; "" if it can."""
    if not bpy.app.build_options.cycles_osl:
        return NO_OSL
    return "" if command(Path()) else "Blender runs as a module of Python, where measuring.measure does the same"


def command(folder: Path) -> list[str]:
    """The other Blender's command line; empty where Blender is a module of Python and has no program."""
    return background.command(MODULE, str(folder))


class VGROOVE_OT_measure(bpy.types.Operator):
    """Measure the active material in Cycles."""

    bl_idname = "vgroove.measure"
    bl_label = "Measure in Cycles"
    bl_description = (
        "Measure the active material, whatever its nodes are, as Cycles renders it under this light. The values appear "
        "as points in the plots. It takes some seconds in the background; Esc stops it"
    )
    bl_options: ClassVar[set[str]] = {"REGISTER"}
    if TYPE_CHECKING:
        report: Any
        poll_message_set: Any

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reasons = (
            unavailable(),
            "A material is being measured" if _running else "",
            "" if viewer.candidates(context) else "Give the active object a material",
        )
        reason = next(filter(None, reasons), "")
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene, of = context.scene, viewer.candidates(context)[0]
        wi = viewer.toward_light(scene, getattr(context, "region_data", None), viewer.frame(scene))
        if wi is None or wi[2] <= 0.0:
            self.report({"WARNING"}, "There is no light above the surface. Choose one, or let it come from Angles")
            return {"CANCELLED"}
        osl = scene.render.engine == "CYCLES" and scene.cycles.shading_system
        try:
            self.job = Job(of, wi, shading_osl=bool(osl))
        except OSError as error:
            self.report({"ERROR"}, f"{of.name} cannot be measured: {error}")
            return {"CANCELLED"}
        _running.append(self.job)
        scene.vgroove_viewer.show = True
        manager = context.window_manager
        self.timer = manager.event_timer_add(PAUSE, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if self.job not in _running:  # the extension was switched off
            return self._end(context, {"CANCELLED"})
        if event.type == "ESC" and event.value == "PRESS":
            self.job.stop()
            self.report({"INFO"}, f"{self.job.name} is not measured")
            return self._end(context, {"CANCELLED"})
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self.job.blender.is_running:
            context.workspace.status_text_set(f"Measuring {self.job.name}: {self.job.progress:.0%}    Esc: Stop")
            viewer.redraw()  # the panel's line
            return {"PASS_THROUGH"}
        problem = self.job.finish()
        if problem:
            self.report({"ERROR"}, problem)
            return self._end(context, {"CANCELLED"})
        self.report({"INFO"}, f"{self.job.name} is measured")
        return self._end(context, {"FINISHED"})

    def cancel(self, context: bpy.types.Context) -> None:
        """Another file is opened, or Blender ends."""
        if self.job in _running:
            self.job.stop()
        self._end(context, {"CANCELLED"})

    def _end(self, context: bpy.types.Context, how: set[str]) -> set[str]:
        if self.job in _running:
            _running.remove(self.job)
        context.window_manager.event_timer_remove(self.timer)
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        viewer.redraw()
        return how


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The button, or how far it is; and what is shown."""
    column = layout.column()
    if reason := unavailable():
        lines(column, reason, context.region.width, icon="INFO")
    if _running:
        column.progress(text=f"Measuring {_running[0].name}", factor=_running[0].progress)
    else:
        column.operator("vgroove.measure", icon="LIGHTPROBE_SPHERE")
    found = [(one, _measured[one.session_uid]) for one in viewer.candidates(context) if one.session_uid in _measured]
    for one, of in found:
        theta = np.degrees(np.arctan2(np.hypot(of.wi[0], of.wi[1]), of.wi[2]))
        column.label(text=f"{one.name}: points at {theta:.1f}°")


def unregister() -> None:
    """No more measurements, and none kept."""
    while _running:
        _running.pop().stop()
    _measured.clear()


CLASSES = (VGROOVE_OT_measure,)
