# SPDX-License-Identifier: GPL-3.0-or-later
"""Run inside Blender: moves the mouse, clicks and types as an artist would, by a scenario that says what.

blender --enable-event-simulate --python hands.py -- SCENARIO.py NAME

A scenario is a generator: it yields the seconds that Blender may work before it continues. Where a button is depends
on fonts, pixels and everything above it, so it is found by what it does: the mouse goes down the region until the
button below it changes the property, or calls the operator, that was asked for. Pictures and outcome.json are written
beside the scenario.
"""

from __future__ import annotations

import contextlib
import json
import os
import runpy
import subprocess
import sys
import time
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable

    Steps = Generator[float, None, Any]

STEP = 14  # pixels between two looks for a button, which is 20 high
BLINK = 0.05  # seconds in which Blender handles an event that changes little
REST = 0.4  # seconds in which it redraws
SECONDS = 300  # of the processor for a scenario, which does not depend on what else a machine does


class Hands:
    """Mouse, keyboard and eyes in Blender's only window."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.notes: dict[str, Any] = {}
        self.x = self.y = 0

    @property
    def window(self) -> bpy.types.Window:
        return bpy.context.window_manager.windows[0]

    def area(self, kind: str) -> bpy.types.Area:
        return next(one for one in self.window.screen.areas if one.ui_type == kind)

    def region(self, area: bpy.types.Area, kind: str) -> bpy.types.Region:
        return next(one for one in area.regions if one.type == kind)

    def within(self, area: bpy.types.Area, kind: str = "WINDOW") -> Any:
        """The context of an editor: ``with hands.within(area): bpy.ops...``."""
        return bpy.context.temp_override(window=self.window, area=area, region=self.region(area, kind))

    def move(self, x: float, y: float) -> Steps:
        self.x, self.y = int(x), int(y)
        self._send("MOUSEMOVE", "NOTHING")
        yield BLINK

    def click(self, at: tuple[float, float] | None = None, *, button: str = "LEFTMOUSE", **keys: bool) -> Steps:
        if at:
            yield from self.move(*at)
        yield from self.key(button, **keys)

    def key(self, name: str, **keys: bool) -> Steps:
        for value in ("PRESS", "RELEASE"):
            self._send(name, value, **keys)
            yield BLINK
        yield REST

    def type(self, text: str) -> Steps:
        names = {" ": "SPACE", ".": "PERIOD", **dict(zip("0123456789", DIGITS, strict=True))}
        for letter in text:
            self._send(names.get(letter, letter.upper()), "PRESS", unicode=letter)
            self._send(names.get(letter, letter.upper()), "RELEASE")
            yield BLINK
        yield REST

    def drag(self, start: tuple[float, float], end: tuple[float, float], steps: int = 12) -> Steps:
        """With pauses on the way, in which Blender sees that a drag began and what it is over."""
        yield from self.move(*start)
        yield REST  # what is below the mouse wakes up
        self._send("LEFTMOUSE", "PRESS")
        yield BLINK
        ways = [0.01, 0.02, 0.04, *(step / steps for step in range(1, steps + 1))]  # a drag begins slowly
        for part in ways:
            yield from self.move(*(a + (b - a) * part for a, b in zip(start, end, strict=True)))
        yield REST
        self._send("LEFTMOUSE", "RELEASE")
        yield REST

    def _send(self, kind: str, value: str, **more: Any) -> None:
        self.window.event_simulate(type=kind, value=value, x=self.x, y=self.y, **more)

    def under(self, area: bpy.types.Area, kind: str) -> str:
        """What the button below the mouse does: the path of its property or the call of its operator."""
        manager = bpy.context.window_manager
        with self.within(area, kind):
            if bpy.context.property:
                return bpy.context.property[1]
            if not bpy.ops.ui.copy_python_command_button.poll():
                return ""
            manager.clipboard = ""
            bpy.ops.ui.copy_python_command_button()
            return manager.clipboard

    def find(self, area: bpy.types.Area, wanted: str, kind: str = "UI", across: Iterable[float] = (0.6,)) -> Steps:
        """A place on the button whose action holds ``wanted``; looked for downwards at shares of the width."""
        region = self.region(area, kind)
        for share in across:
            for y in range(region.y + region.height - STEP, region.y, -STEP):
                yield from self.move(region.x + region.width * share, y)
                if wanted not in self.under(area, kind):
                    continue
                for nearby in (y, y + STEP, y + 2 * STEP):  # a busy Blender may answer for where the mouse was before
                    yield from self.move(self.x, nearby)
                    yield REST
                    if wanted in self.under(area, kind):
                        return self.x, self.y
        message = f"no button does {wanted!r}"
        raise AssertionError(message)

    def press(self, area: bpy.types.Area, wanted: str, kind: str = "UI", across: Iterable[float] = (0.6,)) -> Steps:
        """Find a button and click it."""
        at = yield from self.find(area, wanted, kind, across)
        yield from self.click(at)

    def enter(self, area: bpy.types.Area, wanted: str, text: str, kind: str = "UI") -> Steps:
        """Type a number over that of a button."""
        yield from self.find(area, wanted, kind)
        yield from self.key("RET")  # edits the number below the mouse
        yield from self.type(text)
        yield from self.key("RET")

    def tab(self, area: bpy.types.Area, name: str) -> Steps:
        """A tab of an editor's sidebar, as N and a click on it would show it."""
        area.spaces.active.show_region_ui = True
        yield REST
        self.region(area, "UI").active_panel_category = name
        yield REST

    def unfold(self, area: bpy.types.Area, wanted: str, within: Iterable[str], kind: str = "UI") -> Steps:
        """Open a panel by its title, looked for from the mouse down.

        Only a panel that is open draws, which tells what a click did. within: the panels that may stand there;
        another one's title that was hit is clicked once more.
        """
        region, drawn = self.region(area, kind), set()
        with watched(within, drawn):
            before = yield from self._drawn(area, drawn)
            for y in range(self.y, region.y, -STEP):
                if wanted in before:
                    return
                yield from self.move(region.x + region.width * 0.35, y)
                if self.under(area, kind):
                    continue
                yield from self.click()
                after = yield from self._drawn(area, drawn)
                if wanted not in after and after != before:
                    yield from self.click()
                else:
                    before = after
        message = f"no title opens {wanted}"
        raise AssertionError(message)

    def _drawn(self, area: bpy.types.Area, drawn: set[str]) -> Steps:
        drawn.clear()
        area.tag_redraw()
        yield REST
        return set(drawn)

    def picture(self, name: str, part: tuple[int, int, int, int] | None = None) -> None:
        """The screen as it is; Blender's own screenshot operator is black on a screen without a display.

        part: left, bottom, width and height, which become a small WebP for the documents.
        """
        command = ["import", "-window", "root"]
        if part:
            x, y, width, height = part
            command += ["-crop", f"{width}x{height}+{x}+{self.window.height - y - height}", "-quality", "88"]
        subprocess.run([*command, str(self.folder / f"{name}.{'webp' if part else 'png'}")], check=True)

    def look(self, name: str) -> np.ndarray:
        """The same as (height, width, 3) values of 0 to 1, from the bottom up as the mouse counts."""
        self.picture(name)
        return self.pixels(self.folder / f"{name}.png")

    def pixels(self, path: Path) -> np.ndarray:
        """An image file as (height, width, 3), from the bottom up."""
        image = bpy.data.images.load(str(path))
        image.colorspace_settings.is_data = True
        values = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(values)
        width, height = image.size
        bpy.data.images.remove(image)
        return values.reshape(height, width, -1)[..., :3]


@contextlib.contextmanager
def watched(names: Iterable[str], drawn: set[str]) -> Generator[None]:
    """Write the names of panels that draw into a set."""
    kinds = {name: getattr(bpy.types, name) for name in names}
    before = {name: kind.draw for name, kind in kinds.items()}

    def seen(name: str) -> Any:
        def draw(panel: Any, context: bpy.types.Context) -> None:
            drawn.add(name)
            before[name](panel, context)

        return draw

    for name, kind in kinds.items():
        kind.draw = seen(name)
    try:
        yield
    finally:
        for name, kind in kinds.items():
            kind.draw = before[name]


DIGITS = "ZERO", "ONE", "TWO", "THREE", "FOUR", "FIVE", "SIX", "SEVEN", "EIGHT", "NINE"


def main() -> None:
    script, name = sys.argv[sys.argv.index("--") + 1 :]
    hands = Hands(Path(script).parent)
    steps = None

    def go() -> float | None:
        nonlocal steps
        failed = ""
        try:
            if time.process_time() > SECONDS:
                message = f"not done after {SECONDS} s of the processor"
                raise TimeoutError(message)  # noqa: TRY301 - as any other failure
            if steps is None:
                steps = runpy.run_path(script)[name](hands)
            return next(steps)
        except StopIteration:
            pass
        except BaseException:  # noqa: BLE001 - whatever it is, the test reports it
            failed = traceback.format_exc()
            hands.picture("failed")
        outcome = {"failed": failed, "notes": hands.notes, "blender": bpy.app.version_string}
        (hands.folder / "outcome.json").write_text(json.dumps(outcome), encoding="utf-8")
        sys.stdout.flush()
        os._exit(bool(failed))  # not by the operator, which asks whether to save

    bpy.app.timers.register(go, first_interval=1.0, persistent=True)


main()
