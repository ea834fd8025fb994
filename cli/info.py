# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove info``: what a file with a measured BRDF holds."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from .terminal import one_line, out

if TYPE_CHECKING:
    from ..addon.measured import Contents, Summary

FileArgument = Annotated[
    Path, typer.Argument(metavar="FILE", help="MERL .binary, RGL .bsdf, ASTM E1392 text or UTIA .bin")
]


def info(
    file: FileArgument,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="{contents, coverage, summary, angles} instead")] = False,
) -> None:
    """Describe a measured BRDF: format, range, coverage, reciprocity error, albedo by angle, holes."""
    from ..addon import measured
    from ..addon.measured.summary import ANGLES

    found = measured.read(file)
    contents, summary = found.contents, measured.summarize(found)
    if as_json:
        content = {"contents": asdict(contents), "coverage": contents.coverage, "summary": asdict(summary)}
        print(json.dumps(content | {"angles": ANGLES}))
        return
    table = Table(escape(one_line(str(file))), "")
    for name, text in _rows(contents, summary):
        table.add_row(name, escape(one_line(text)))
    out.print(table)
    table = Table("light at", "albedo R", "G", "B")
    for angle, rgb in zip(ANGLES, summary.albedo, strict=True):
        table.add_row(f"{angle} degrees", *(f"{value:.4f}" for value in rgb))
    out.print(table)


def _rows(contents: Contents, summary: Summary) -> list[tuple[str, str]]:
    gains = ", ".join(map(str, summary.gains))
    return [
        ("format", contents.format),
        *([("description", contents.text)] if contents.text else []),
        ("grid", f"{contents.size}; {'isotropic' if contents.isotropic else 'anisotropic'}"),
        ("range", f"{summary.least:.4g} to {summary.greatest:.4g} /sr"),
        ("above 1 /sr", f"{100 * summary.above_one:.3g} % of pairs of directions"),
        (
            "coverage",
            f"{100 * contents.coverage:.4g} % of {contents.entries - contents.below} entries above the horizon",
        ),
        ("holes", f"{contents.holes}; filled {contents.filled}" if contents.holes else "none"),
        *([("below the horizon", f"{contents.below} entries")] if contents.below else []),
        ("reciprocity error", f"{100 * summary.reciprocity:.3g} % (mean difference over mean value)"),
        ("albedo above 1", f"with the light at {gains} degrees" if gains else "nowhere"),
    ]
