# SPDX-License-Identifier: GPL-3.0-or-later
"""What Automatic picks in each scene of ``accuracy``, at each of its sample counts. Renders nothing."""

from __future__ import annotations

from ... import headless
from ...addon.blender import facts
from ...addon.blender.material import BUILDERS, NATIVE
from ...addon.choose import automatic
from ...addon.models import estimators
from . import contenders
from .cells import Picks
from .scenes import stage

names = contenders.names
SIZE = 8  # pixels, which decide nothing


def measure(name: str, subject: str, *, quick: bool) -> Picks:
    """One scene and subject."""
    preset, found = contenders.subjects()[subject], []
    with headless.quiet(), stage(name, SIZE) as shown:
        known = facts.of(shown.scene)
        for samples in contenders.counts(quick=quick):
            shown.scene.cycles.samples = samples
            found.append(automatic.pick_estimator(known, preset))
    never = [name for name in BUILDERS[preset.model] if name not in {*NATIVE, *found}]
    return Picks(estimators=tuple(found), refused={name: _refusal(name) for name in never})


def _refusal(estimator: str) -> str:
    """Why Automatic never picks an estimator."""
    return "draws random facets" if estimators.ESTIMATORS[estimator].random else "binds lights"
