# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the page in docs/viewer.md, by Chromium.

python tools/viewer_picture.py docs/images
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import browser
from PIL import Image

from vgroove.addon.library import presets
from vgroove.viewer import page

# The presets of each picture, and what is set on the page
PICTURES = {
    "viewer_page": (("lecture/copper", "diffuse/plaster", "plastics/red_plastic"), "{log: true, thetaI: 60}"),
    "viewer_lecture": (("lecture/cook_torrance_brdf_viewer", "lecture/ward_brdf_viewer"), "{}"),
}
SIZE = 1280, 1080


def take(to: Path, names: tuple[str, ...], state: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        path.write_text(page.page([(one.name, one) for one in map(presets.find, names)]), encoding="utf-8")
        chromium = browser.Browser(Path(folder) / "profile")
        try:
            errors = chromium.open(path, size=SIZE)
            assert not errors, errors
            chromium.run(f"Object.assign(handle.state(), {state}); handle.changed()")
            chromium.run("await new Promise(requestAnimationFrame)")
            chromium.run(f"return {browser.DRAWN}")
            chromium.picture(path.with_suffix(".png"))
        finally:
            chromium.close()
        Image.open(path.with_suffix(".png")).save(to, quality=80, method=6)


def main(folder: Path) -> None:
    for name, (names, state) in PICTURES.items():
        take(folder / f"{name}.webp", names, state)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
