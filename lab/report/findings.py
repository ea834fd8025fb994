# SPDX-License-Identifier: GPL-3.0-or-later
"""All that was measured on one Blender, as pages, plots and documents read it. Imports no bpy.

Errors are shares of the truth's root mean square, times are seconds of the processor.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ..bench.cells import Picks, part_of
from .contest import Contest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..bench.cells import Case, Everyday, LeftOut, Table
    from ..bench.record import BlenderRun, Report
    from .contest import Pick, Win
    from .curve import Curve

DEFAULT = (5, 2)  # the Blender whose figures pages show


@dataclass(frozen=True)
class Run:
    """One Blender's measurements. lacks: how many are still missing; seconds: wall time."""

    blender: str
    record: BlenderRun

    @property
    def quick(self) -> bool:
        return self.record.quick

    @property
    def lacks(self) -> int:
        return max(self.record.wanted - len(self.record.cells), 0)

    @property
    def seconds(self) -> float:
        return sum(self.record.seconds.values())

    @cached_property
    def contests(self) -> list[Contest]:
        picks, none = self._cells("picks"), Picks(estimators=())
        return [Contest(cell, picks.get(what, none)) for what, cell in self._cells("accuracy").items()]

    @property
    def cases(self) -> list[Case]:
        return [case for cell in self._cells("stability").values() for case in cell]

    @property
    def left_out(self) -> list[LeftOut]:
        return [one for cell in self._cells("left_out").values() for one in cell]

    @property
    def everyday(self) -> list[Everyday]:
        return [one for cell in self._cells("everyday").values() for one in cell]

    @property
    def tables(self) -> dict[str, dict[str, Table]]:
        """For documents, by cell and name."""
        return self._cells("figures")

    @property
    def curves(self) -> Iterator[tuple[Contest, Curve]]:
        for contest in self.contests:
            for curve in contest.curves.values():
                yield contest, curve

    @property
    def picks(self) -> list[tuple[Contest, Pick]]:
        return [(contest, pick) for contest in self.contests for pick in contest.picks]

    @property
    def wins(self) -> list[tuple[Contest, Win]]:
        return [(contest, win) for contest in self.contests for win in contest.wins]

    def _cells(self, part: str) -> dict[str, Any]:
        return {key.partition("/")[2]: cell for key, cell in self.record.cells.items() if part_of(key) == part}


def runs(report: Report) -> list[Run]:
    """The default Blender first, then the newest."""
    names = sorted(report.runs, key=lambda name: (_version(name)[:2] == DEFAULT, _version(name)), reverse=True)
    return [Run(blender, report.runs[blender]) for blender in names]


def _version(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split("."))
