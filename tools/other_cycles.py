# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes tests/data/until_5_2.blend or since_5_3.blend with the running Blender, for the tests of updated files.

uv run python tools/other_cycles.py         and once more in .venv-5.3
"""

from __future__ import annotations

from pathlib import Path

from vgroove import headless
from vgroove.addon.library import presets

headless.prepare()

import bpy  # noqa: E402

from vgroove.addon.blender.material import Choice, build  # noqa: E402
from vgroove.addon.reference import cycles  # noqa: E402

FOLDER = Path(__file__).parent.parent / "tests" / "data"
MATERIALS = (
    ("chalk", "diffuse/chalk", Choice("nodes", "fit")),
    ("chalk osl", "diffuse/chalk", Choice("osl", "closure")),
    ("frosted osl", "glasses/frosted_glass", Choice("osl", "closure")),
    ("copper", "lecture/copper", Choice("nodes", "closure")),
)


def main() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name, preset, choice in MATERIALS:
        made = build(presets.find(preset), choice)
        made.name, made.use_fake_user = name, True
    with headless.quiet():
        bpy.ops.wm.save_as_mainfile(
            filepath=str(FOLDER / f"{cycles.version()}.blend"), compress=True, check_existing=False
        )


if __name__ == "__main__":
    main()
