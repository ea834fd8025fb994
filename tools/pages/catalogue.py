# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue: a page with a row for each preset, and a picture where `make previews` has made one."""

from __future__ import annotations

import io
from html import escape
from itertools import groupby
from typing import TYPE_CHECKING

from PIL import Image

from vgroove.addon.library import families, presets

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from vgroove.addon.library.presets import Preset

PIXELS = 48
START = """---
hide: [toc]
---

# Find a preset

Type words of a name, a tag, a family, a model or a source. [presets.md](presets.md) says how presets are made.

<input id="find" type="search" placeholder="gold satin" aria-label="Search" autofocus> <span id="found"></span>

<table id="presets"><thead>
<tr>{head}<th>preset</th><th>how known</th><th>numbers</th><th>source</th></tr></thead><tbody>
"""
END = '</tbody></table>\n\n<script src="static/catalogue.js"></script>\n'


def pages(root: Path) -> Iterator[tuple[str, str | bytes]]:
    """The page, and its pictures."""
    every = sorted(presets.shipped().values(), key=lambda one: (families.number(one.id), one.name.casefold()))
    pictures = {one.id: path for one in every if (path := root / "previews" / f"{one.id}.webp").is_file()}
    lines = [START.format(head="<th></th>" if pictures else "")]
    for number, of in groupby(every, key=lambda one: families.number(one.id)):
        group = list(of)
        title = escape(families.title(group[0].id))
        lines.append(f'<tr class="family" data-family="{number}"><td colspan="5">{title}</td></tr>\n')
        lines += [_row(one, number, title, has_pictures=bool(pictures), pictured=one.id in pictures) for one in group]
    yield "catalogue.md", "".join(lines) + END
    for identity, path in pictures.items():
        yield f"previews/{identity}.webp", _small(path)


def _row(preset: Preset, family: int, title: str, *, has_pictures: bool, pictured: bool) -> str:
    """Everything of the file: nothing in it may be read as HTML."""
    numbers = ", ".join(f"{name} {_number(value)}" for name, value in preset.parameters.items())
    source, known = preset.source.get("data", ""), preset.evidence or preset.source.get("trust", "")
    words = " ".join((preset.name, preset.id, *preset.tags, title, preset.spec.label, source, known)).lower()
    image = f'<img src="previews/{preset.id}.webp" width="{PIXELS}" height="{PIXELS}" alt="" loading="lazy">'
    picture = f"<td>{image if pictured else ''}</td>" if has_pictures else ""
    cells = (f"{escape(preset.name)}<br><code>{preset.id}</code><br>{escape(preset.spec.label)}", escape(known),
             escape(numbers), escape(source))  # fmt: skip
    row = "".join(f"<td>{cell}</td>" for cell in cells)
    return f'<tr data-family="{family}" data-words="{escape(words)}">{picture}{row}</tr>\n'


def _number(value: object) -> str:
    return " ".join(f"{one:.3g}" for one in value) if isinstance(value, tuple) else f"{value:.3g}"


def _small(path: Path) -> bytes:
    held = io.BytesIO()
    with Image.open(path) as full:
        full.resize((2 * PIXELS, 2 * PIXELS)).save(held, "WEBP", quality=75)
    return held.getvalue()
