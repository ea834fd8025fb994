# SPDX-License-Identifier: GPL-3.0-or-later
"""What Automatic picks in each scene of ``accuracy``, at each of its sample counts. Renders nothing."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ... import headless
from ...addon.blender import facts
from ...addon.blender.material import BUILDERS, EVERY_LAMP, NATIVE
from ...addon.choose import automatic
from . import contenders
from .cells import Picks
from .record import Cell
from .scenes import stage

if TYPE_CHECKING:
    from pathlib import Path

SIZE = 8  # pixels, which decide nothing


def cells(*, quick: bool) -> list[Cell]:
    return [
        Cell(f"picks/{name}/{of}", partial(measure, name=name, subject=of, quick=quick))
        for name, of in contenders.pairs(quick=quick)
    ]


def measure(_folder: Path, name: str, subject: str, *, quick: bool) -> Picks:
    """One scene and subject."""
    preset, found = contenders.subjects()[subject], []
    with headless.quiet(), stage(name, SIZE) as shown:
        known = facts.of(shown.scene)
        for samples in contenders.counts(quick=quick):
            shown.scene.cycles.samples = samples
            found.append(automatic.pick_estimator(known, preset))
    never = [name for name in BUILDERS[preset.model] if name not in {*NATIVE, *found}]
    why = {name: "binds lights" if name in EVERY_LAMP else "draws random facets" for name in never}
    return Picks(estimators=tuple(found), refused=why)
