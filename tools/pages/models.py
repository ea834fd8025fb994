# SPDX-License-Identifier: GPL-3.0-or-later
"""A page for each model: what docs/models/NAME.md says, and between it what the registry and measurements say."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from vgroove.addon.library import presets
from vgroove.addon.models import MODELS, estimators, fresnel, label
from vgroove.lab.report.documents import parameter_table

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from vgroove.addon.models import Model

BEFORE = "## Limits"  # what is generated stands before it
QUALITIES = {"standard": "Standard", "exact": "Exact Lights", "reference": "Reference"}


def pages(root: Path) -> Iterator[tuple[str, str]]:
    """The list of models, and each one's page."""
    folder = root / "docs" / "models"
    measured = json.loads((folder / "measured.json").read_text(encoding="utf-8"))
    texts = {name: _text(folder / f"{name}.md", of) for name, of in MODELS.items()}
    yield "models/index.md", _index(texts)
    for name, text in texts.items():
        said, mark, limits = text.partition(BEFORE)
        yield f"models/{name}.md", said + _generated(root, MODELS[name], measured.get(name)) + mark + limits


def _text(path: Path, model: Model) -> str:
    """What is written by hand; of a model that nobody has written about yet, its name."""
    return path.read_text(encoding="utf-8") if path.is_file() else f"# {model.label}\n\n"


def _index(texts: dict[str, str]) -> str:
    lines = ["# Models\n", "| model | what it is | presets |", "| --- | --- | --- |"]
    for name, text in texts.items():
        first = next((line for line in text.split("\n")[1:] if line), "")
        count = sum(one.model == name for one in presets.shipped().values())
        lines.append(f"| [{MODELS[name].label}]({name}.md) | {first} | {count or ''} |")
    return "\n".join(lines) + "\n"


def _generated(root: Path, model: Model, measured: dict[str, Any] | None) -> str:
    parts = [f"## Parameters\n\n{_parameters(model)}"]
    if (root / "docs" / "models" / f"{model.name}.webp").is_file() and measured:
        preset = presets.find(measured["preset"])
        rows = ", ".join(measured["rows"])
        parts.append(
            f"*{preset.name}*, a row for each input of Blender: {rows}.\n\n![Balls: {rows}]({model.name}.webp)"
        )
    parts.append(f"## Estimators\n\n{_estimators(model, measured)}")
    count = sum(one.model == model.name for one in presets.shipped().values())
    if count:
        parts.append(f'<a href="../catalogue.html#{model.label}">{count} presets</a> have this model.')
    if (root / "addon" / "reference" / f"{model.name}.py").is_file():
        parts.append(f"In NumPy: [`{model.name}`](../api/reference.md#{model.name}).")
    return "\n\n".join(parts) + "\n\n"


def _parameters(model: Model) -> str:
    """Its own, and those of the Fresnel terms that it takes."""
    own = [("", one, label(model.name, one.name)) for one in dict.fromkeys((*model.parameters, *model.lobes))]
    if not own:
        return "It has none: the file says everything."
    table = parameter_table(own)
    if model.has_fresnel:
        terms = [fresnel.KINDS[kind] for kind in model.kinds if kind in fresnel.KINDS]
        rows = [(of.label, one, one.label) for of in terms for one in of.parameters]
        table += f"\n\nand those of one Fresnel term:\n\n{parameter_table(rows, 'term')}"
    return table


def _estimators(model: Model, measured: dict[str, Any] | None) -> str:
    lines = ["| estimator | quality | what it is |", "| --- | --- | --- |"]
    if measured:
        lines = [f"{lines[0]} sun at 20° | at 60° | even sky |", f"{lines[1]} --- | --- | --- |"]
    for name in model.estimators:
        of = estimators.ESTIMATORS[name]
        row = f"| {of.label} | {QUALITIES[of.quality]} | {of.tip} |"
        if measured:
            found = measured["differences"][name]
            l1 = found.get("l1") or (None, None)
            row += "".join(f" {_percent(value)} |" for value in (*l1, found.get("sky")))
        lines.append(row)
    note = ""
    if measured:
        name = presets.find(measured["preset"]).name
        note = (
            f"\n\nMeasured in Cycles on *{name}*: how much of the reflected light is elsewhere than by the reference "
            "(L1) under a sun, and the albedo's difference under an even sky, noise included. Empty: not measured, or "
            "blind to that light."
        )
    return "\n".join(lines) + note


def _percent(value: float | None) -> str:
    """Two digits; what is below single precision's error is 0."""
    if value is None:
        return ""
    return "0" if abs(value) < 5e-5 else f"{100.0 * value:.2g} %"
