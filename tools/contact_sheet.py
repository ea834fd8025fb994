# SPDX-License-Identifier: GPL-3.0-or-later
"""Every preset's picture on one sheet, by family.

python tools/contact_sheet.py FILE.webp      from previews/, which tools/previews.py makes
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from vgroove.addon.library import families
from vgroove.addon.library.presets import shipped

PREVIEWS = Path(__file__).parent.parent / "previews"
TILE, COLUMNS, HEADING = 72, 16, 30
PAPER, INK = (250, 250, 250), (40, 40, 40)


def sheet() -> Image.Image:
    """A heading and rows of pictures for each family; FileNotFoundError where a picture is missing."""
    sections: dict[str, list[str]] = {}
    for preset in sorted(shipped().values(), key=lambda one: (families.number(one.id), one.id)):
        sections.setdefault(families.of(preset), []).append(preset.id)
    rows = {title: -(-len(members) // COLUMNS) for title, members in sections.items()}
    height = sum(HEADING + TILE * count for count in rows.values())
    page = Image.new("RGB", (TILE * COLUMNS, height), PAPER)
    pen, font = ImageDraw.Draw(page), ImageFont.load_default(size=15)
    top = 0
    for title, members in sections.items():
        pen.text((6, top + 7), f"{title} ({len(members)})", fill=INK, font=font)
        for index, identity in enumerate(members):
            picture = Image.open(PREVIEWS / f"{identity}.webp").resize((TILE, TILE), Image.Resampling.LANCZOS)
            page.paste(picture, (TILE * (index % COLUMNS), top + HEADING + TILE * (index // COLUMNS)))
        top += HEADING + TILE * rows[title]
    return page


if __name__ == "__main__":
    sheet().save(sys.argv[1], quality=75, method=6)
