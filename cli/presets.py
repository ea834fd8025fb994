# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove presets``: the list of presets, as a table or as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from ..addon.library import presets
from .terminal import out, warn

if TYPE_CHECKING:
    from ..addon.library.presets import Preset


def list_presets(
    query: Annotated[str, typer.Argument(help="Words to find in id, name and tags")] = "",
    *,
    as_json: Annotated[
        bool, typer.Option("--json", help="A list of {id, name, family, model, parameters, source}")
    ] = False,
) -> None:
    """List the presets, including yours in the folder that VGROOVE_PRESETS names."""
    found = presets.search(query)
    for error in presets.load_errors():
        warn(f"preset skipped: {error}")
    if as_json:
        print(json.dumps([_as_json(preset) for preset in found], indent=1))
        return
    table = Table("id", "name", "parameters", "source")
    for preset in found:
        table.add_row(preset.id, escape(preset.name), _numbers(preset), escape(preset.source["data"]))
    out.print(table)


def _as_json(preset: Preset) -> dict[str, Any]:
    return {
        "id": preset.id, "name": preset.name, "family": preset.family, "model": preset.model,
        "parameters": preset.parameters, "source": preset.source,
    } | ({"time": asdict(preset.time)} if preset.time else {})  # fmt: skip


def _numbers(preset: Preset) -> str:
    """The parameters in one line, and which of them change over time."""
    numbers = ", ".join(f"{key} {_plain(value)}" for key, value in preset.parameters.items())
    if time := preset.time:
        numbers += f"; changes from {time.start:g} to {time.end:g} {time.unit}: {', '.join(time.laws)}"
    return numbers


def _plain(value: float | tuple[float, ...]) -> str:
    return " ".join(f"{part:g}" for part in value) if isinstance(value, tuple) else f"{value:g}"
