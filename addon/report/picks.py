# SPDX-License-Identifier: GPL-3.0-or-later
"""What Automatic picks in each scene of ``accuracy``, at each of its sample counts. Renders nothing.

{"scene": "sun", "subject": "copper", "samples": [4, 16, ...], "estimators": ["closure", "closure", ...],
     "refused": {"direct": "Direct shows bound lamps alone: ..."}}

refused: what it may not pick, and why: its picture would lack light, or lamps would shine into shadows.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from .. import advice, automatic, headless
from ..material import BUILDERS
from . import contenders
from .record import Cell
from .scenes import stage

if TYPE_CHECKING:
    from pathlib import Path

REFUSED = {"alone", "shadows"}  # of ``advice.problems``
SIZE = 8  # pixels, which decide nothing


def cells(*, quick: bool) -> list[Cell]:
    return [
        Cell(f"picks/{name}/{of}", partial(measure, name=name, subject=of, quick=quick))
        for name, of in contenders.pairs(quick=quick)
    ]


def measure(_folder: Path, name: str, subject: str, *, quick: bool) -> dict[str, Any]:
    """One scene and subject."""
    counts, preset, found = contenders.counts(quick=quick), contenders.subjects()[subject], []
    with headless.quiet(), stage(name, SIZE) as shown:
        for samples in counts:
            shown.scene.cycles.samples = samples
            found.append(automatic.pick_estimator(shown.scene, preset))
        refused = {
            estimator: problem.text
            for estimator in BUILDERS[preset.model]
            for problem in advice.problems(shown.scene, "nodes", estimator, preset.m, preset.model)
            if problem.key in REFUSED
        }
    return {
        "scene": name, "subject": subject, "samples": list(counts), "estimators": found, "refused": refused,
    }  # fmt: skip
