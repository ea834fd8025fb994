# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of the page in docs/viewer.md, by Chromium.

python tools/viewer_picture.py docs/images/viewer_page.webp
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import browser
from PIL import Image

from vgroove.addon.library import presets
from vgroove.viewer import page

NAMES = ("lecture/copper", "diffuse/plaster", "plastics/red_plastic")
SIZE = 1280, 1080


def main(to: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        path.write_text(page.page([(one.name, one) for one in map(presets.find, NAMES)]), encoding="utf-8")
        chromium = browser.Browser(Path(folder) / "profile")
        try:
            errors = chromium.open(path, size=SIZE)
            assert not errors, errors
            chromium.run("Object.assign(handle.state(), {log: true, thetaI: 60}); handle.changed()")
            chromium.run("await new Promise(requestAnimationFrame)")
            chromium.run(f"return {browser.DRAWN}")
            chromium.picture(path.with_suffix(".png"))
        finally:
            chromium.close()
        Image.open(path.with_suffix(".png")).save(to, quality=80, method=6)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
