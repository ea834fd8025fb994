# SPDX-License-Identifier: GPL-3.0-or-later
"""How quick the page of `vgroove view` is in Chromium on a software rasteriser: eight lobes at 800 x 600.

python tools/page_speed.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import browser

from vgroove.addon.library import presets
from vgroove.viewer import page

NAMES = (
    "lecture/copper", "diffuse/plaster", "ceramics/bone_china", "alum_bronze_merl", "vinyl_record", "car_paints/blue",
    "alabaster", "phong/phong_red_plastic",
)  # fmt: skip
SIZE = 800, 600
SECONDS = 4
# Moves the mouse at each frame, from a press on the lobe to a release; frames a second that are drawn meanwhile.
DRAG = """
const plot = document.querySelector(".wide .plot"), box = plot.getBoundingClientRect();
const send = (kind, x, y) => plot.dispatchEvent(new PointerEvent(kind,
  {clientX: x, clientY: y, pointerId: 1, button: 0, buttons: 1, bubbles: true, isPrimary: true}));
plot.setPointerCapture = () => {};
const [x, y] = START;
send("pointerdown", x, y);
const begin = performance.now();
let frames = 0;
while (performance.now() - begin < SECONDS) {
  frames += 1;
  send("pointermove", x + 60 * Math.sin(frames / 9), y + 20 * Math.cos(frames / 9));
  await new Promise(requestAnimationFrame);
}
send("pointerup", x, y);
return frames / ((performance.now() - begin) / 1000);
"""
CORNER = "[box.left + 30, box.top + 30]"


def measure() -> dict[str, float]:
    """From opening to the first picture, and frames while turning and moving the light.

    The processor's time is that of the page's own thread, which other work on a machine does not change.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        path.write_text(page.page([(one.name, one) for one in map(presets.find, NAMES)]), encoding="utf-8")
        chromium = browser.Browser(Path(folder) / "profile")
        try:
            chromium.open(path, size=SIZE)  # once for what Chromium itself loads
            errors = chromium.open(path, size=SIZE)
            assert not errors, errors
            first = 'const one = performance.getEntriesByName("first")[0]; return one.startTime + one.duration;'
            turning = DRAG.replace("START", CORNER).replace("SECONDS", str(1000 * SECONDS))
            moving = (
                "const begin = performance.now(); let frames = 0;"
                f"while (performance.now() - begin < {1000 * SECONDS}) {{ frames += 1;"
                "handle.state().thetaI = 45 + Math.round(30 * Math.sin(frames / 9)); handle.changed();"
                "await new Promise(requestAnimationFrame); }"
                "return frames / ((performance.now() - begin) / 1000);"
            )
            found = {"first picture, ms": chromium.run(first)}
            chromium.call("Performance.enable", timeDomain="threadTicks")
            for name, script in (("turning", turning), ("moving the light", moving)):
                before = _busy(chromium)
                rate = chromium.run(script)
                busy = (_busy(chromium) - before) / (rate * SECONDS)
                found |= {f"{name}, frames a second": rate, f"{name}, ms of the processor for a frame": 1e3 * busy}
            return found
        finally:
            chromium.close()


def _busy(chromium: browser.Browser) -> float:
    """Seconds that the page's thread has worked."""
    metrics = chromium.call("Performance.getMetrics")["metrics"]
    return next(one["value"] for one in metrics if one["name"] == "TaskDuration")


if __name__ == "__main__":
    for name, value in measure().items():
        print(f"{name}: {value:.1f}")
