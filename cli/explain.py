# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove explain``: what a preset's material consists of in a scene, and why."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from ..addon.library import presets
from ..addon.library.errors import InputError
from ..addon.library.inputs import MOST_SAMPLES
from ..batch.job import PREVIEW_SAMPLES
from .environment import start_blender
from .options import AUTO, Backend, BackendOption, Estimator, PresetArgument, SetOption, apply_settings, whole
from .terminal import out

if TYPE_CHECKING:
    from ..addon.blender.material import Choice
    from ..addon.choose.explain import Account

SceneOption = Annotated[
    Path | None,
    typer.Option("--scene", metavar="SCENE.blend", help="Explain for this scene instead of the preview scene"),
]
EstimatorOption = Annotated[Estimator, typer.Option(help="auto: picked for the scene")]
SamplesOption = Annotated[
    int | None,
    typer.Option(parser=whole(1, MOST_SAMPLES), metavar="N", help="Samples per pixel; default: the scene's own"),
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="{material, estimator, backend, lines, size, advice} instead of tables")
]


def explain(
    name: PresetArgument,
    *,
    settings: SetOption = None,
    in_scene: SceneOption = None,
    backend: BackendOption = Backend.NODES,
    estimator: EstimatorOption = AUTO,
    samples: SamplesOption = None,
    as_json: JsonOption = False,
) -> None:
    """Explain a preset's material in a scene: its parts, what was left out and why, and how much that saves."""
    preset = apply_settings(presets.find(name), settings)
    if in_scene is not None and not in_scene.is_file():
        message = f"{in_scene}: no such scene; name a .blend file"
        raise InputError(message)
    start_blender()
    from .. import headless
    from ..addon.choose import advice
    from ..addon.choose import explain as explaining
    from ..headless import scene
    from ..lab.bench import universal

    with headless.quiet():
        stage = scene.open_file(in_scene) if in_scene else scene.preview()
        stage.cycles.samples = samples or (stage.cycles.samples if in_scene else PREVIEW_SAMPLES)
        account = explaining.explain(preset, stage, str(backend), str(estimator))
        problems = [problem.text for problem in advice.problems_with(stage, preset, str(backend), account.estimator)]
        materials = {"built": account.material, "universal": universal.build(account.choice)}
    size = {which: asdict(explaining.size_of(material)) for which, material in materials.items()}
    if as_json:
        lines = [asdict(line) for line in account.lines]
        content = {"material": account.material.name, "estimator": account.estimator, "backend": str(backend)}
        print(json.dumps(content | {"lines": lines, "size": size, "advice": problems}))
        return
    _print_tables(account, size)
    for text in problems:
        out.print(f"advice: {text}", highlight=False, markup=False)


def _print_tables(account: Account, size: dict[str, dict[str, int]]) -> None:
    """What the material has, what it lacks, and its size beside that of the universal material."""
    for title, kept in ((account.material.name, True), ("left out", False)):
        table = Table(title, "why")
        for line in account.lines:
            if line.kept == kept:
                table.add_row(line.what, line.why)
        out.print(table)
    table = Table("", "as built", "universal", caption=universal_caption(account.choice))
    for what, label in (("nodes", "nodes"), ("instructions", "OSL instructions")):
        if size["universal"][what]:
            table.add_row(label, *(str(one[what]) for one in size.values()))
    out.print(table)


def universal_caption(choice: Choice) -> str:
    """What the universal material, beside the one built by ``choice``, can do."""
    from ..lab.bench import universal

    text = "universal: one material whose inputs show any preset, except absorption"
    if terms := universal.form_of(choice).lamps:
        text += f", with terms for {terms} light{'s' * (terms > 1)}"
    if choice.backend == Backend.NODES and not universal.fits():
        text += "; does not fit in this Blender"
    return text + ". Times: docs/report.md"
