# SPDX-License-Identifier: GPL-3.0-or-later
"""report.json: every number of a report, by Blender and by cell. Imports no bpy.

A cell's key is PART/NAME, such as "accuracy/softbox/copper"; module ``cells`` has the type of each part.
"""

from __future__ import annotations

import json
import math
import os
import platform
import re
import sys
import time
from dataclasses import dataclass, field
from importlib import import_module
from importlib.metadata import version
from subprocess import SubprocessError
from typing import TYPE_CHECKING, Any, get_type_hints

import cattrs
import numpy as np
import psutil

from ...addon.library.errors import InputError
from ...addon.library.files import FileError, read_text, write_text
from ...addon.library.inputs import shown
from .cells import PARTS, Flags, Numbers, part_of
from .digest import code

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

FILE = "report.json"
LONGEST_FILE = 200_000_000  # bytes
FORMAT = 3
DIGITS = 9  # of a float; of those near 1 all
PACKAGES = ("numpy", "scipy", "mitsuba")


class ReportError(InputError):
    """A report.json that cannot be used."""


@dataclass(frozen=True)
class Cell:
    """One thing to measure. measure: returns what ``PARTS`` says."""

    key: str
    measure: Callable[[], Any]


@dataclass
class BlenderRun:
    """What was measured on one Blender, and by what.

    versions: of Python and the packages that measure. code: a digest of the code that measured each part. wanted: how
    many cells there will be. seconds: wall time of each cell.
    """

    vgroove: str
    versions: dict[str, str]
    quick: bool
    wanted: int = 0
    code: dict[str, str] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    cells: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Machine:
    """The class of the machine, by which run times can be judged; nothing that names it."""

    system: str
    processor: str
    cores: int
    memory_gb: int


@dataclass
class Report:
    format: int
    machine: Machine
    runs: dict[str, BlenderRun] = field(default_factory=dict)


@dataclass
class Record:
    """A report while it is measured on one Blender. digests: of the code that now measures, by part."""

    path: Path
    blender: str
    report: Report
    digests: dict[str, str]

    @property
    def run(self) -> BlenderRun:
        return self.report.runs[self.blender]

    def missing(self, wanted: Sequence[Cell]) -> list[Cell]:
        return [cell for cell in wanted if cell.key not in self.run.cells]

    def measure(self, wanted: Sequence[Cell]) -> Iterator[tuple[Cell, str]]:
        """Measure each cell and keep it before the next starts; with each the reason why it failed, or ""."""
        for cell in wanted:
            start = time.perf_counter()
            try:
                measured = cell.measure()
            except (RuntimeError, ValueError, ArithmeticError, SubprocessError) as error:
                yield cell, " ".join(f"{type(error).__name__}: {error}".split())
            else:
                self.add(cell.key, measured, time.perf_counter() - start)
                yield cell, ""

    def add(self, key: str, cell: Any, seconds: float = 0.0) -> None:
        """Add a cell and write the file, with what another Blender's process has written to it meanwhile."""
        if self.path.exists():
            self.report.runs |= {name: run for name, run in read(self.path).runs.items() if name != self.blender}
        self.run.cells[key] = cell
        self.run.seconds[key] = round(seconds, 1)
        self.run.code[part_of(key)] = self.digests[part_of(key)]
        write_text(self.path, to_json(self.report))


def cells(*, quick: bool, more: Sequence[Cell] = ()) -> list[Cell]:
    """Everything a report measures, the same in each run. more: cells of what the laboratory may not import.

    A part is a module of that name: ``names`` of its cells, and ``measure`` of what a name is made of.
    """
    parts = {part: import_module(f".{part}", __package__) for part in PARTS}
    return [*(_cell(part, of, name, quick) for part, of in parts.items() for name in of.names(quick=quick)), *more]


def _cell(part: str, of: Any, name: str, quick: bool) -> Cell:  # noqa: FBT001 - called above alone
    return Cell(f"{part}/{name}", lambda: of.measure(*name.split("/"), quick=quick))


def open_or_create(path: Path, blender: str, *, quick: bool, again: Sequence[str] = ()) -> Record:
    """The record at ``path``: resumed if it exists, refused if other code or another machine measured it.

    again: parts to be measured again. ReportError says what differs, and what to do.
    """
    report = read(path) if path.exists() else Report(FORMAT, machine())
    if report.machine != machine():
        message = f"{path}: was measured on another machine; choose another folder with -o"
        raise ReportError(message)
    new = BlenderRun(version("vgroove"), versions(), quick)
    run = report.runs.setdefault(blender, new)
    if differ := list(_differences(run, new)):
        message = f"{path}: holds {' and '.join(differ)}; choose another folder with -o"
        raise ReportError(message)
    run.cells = {key: cell for key, cell in run.cells.items() if part_of(key) not in again}
    run.seconds = {key: seconds for key, seconds in run.seconds.items() if key in run.cells}
    digests = {part: code(part) for part in PARTS}
    measured = {*map(part_of, run.cells)}
    stale = [part for part in PARTS if part in measured and run.code.get(part) != digests[part]]
    if stale:
        options = " ".join(f"--again {part}" for part in stale)
        message = f"{path}: other code measured {' and '.join(stale)}; give {options}, or another folder with -o"
        raise ReportError(message)
    return Record(path, blender, report, digests)


def _differences(old: BlenderRun, new: BlenderRun) -> Iterator[str]:
    """What measured a report, where it is not what would resume it."""
    if old.quick != new.quick:
        yield "a full report, where a quick one is asked for" if new.quick else "a quick report, not a full one"
    before, now = ({"vgroove": run.vgroove} | run.versions for run in (old, new))
    for name in sorted({*before, *now}):
        if before.get(name) != now.get(name):
            yield f"measurements by {name} {before.get(name, 'none')}, which is {now.get(name, 'gone')} here"


def versions() -> dict[str, str]:
    """Versions of what the numbers are measured with, beside Blender."""
    return {"python": platform.python_version()} | {name: version(name) for name in PACKAGES}


def machine() -> Machine:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return Machine(sys.platform, platform.machine(), cores, round(psutil.virtual_memory().total / 2**30))


# The codec


def to_json(report: Report) -> str:
    return json_text(CODEC.unstructure(report))


def json_text(content: Any) -> str:
    """JSON in which a list or a table of plain values is one line."""
    spread = json.dumps(content, indent=1, allow_nan=False)
    return (
        re.sub(r"(?<=[\[{])\n[^\[\]{}]*(?=[\]}])", lambda plain: re.sub(r"\n *", " ", plain[0]).strip(), spread) + "\n"
    )


def read(path: Path) -> Report:
    """What a report.json holds. ReportError if it is none."""
    try:
        return structured(json.loads(read_text(path, LONGEST_FILE)))
    except (ValueError, RecursionError) as error:
        what = str(error) if isinstance(error, FileError | ReportError) else "no report"
        what = "not there" if isinstance(error.__cause__, FileNotFoundError) else what
        message = f"{path}: {what}; name a report.json as this `vgroove report -o DIR` writes it"
        raise ReportError(message) from error


def structured(content: Any) -> Report:
    """The report that JSON holds. ReportError says what is not as ``to_json`` writes it."""
    if not isinstance(content, dict) or "runs" not in content:
        message = "no report"
        raise ReportError(message)
    if content.get("format") != FORMAT:
        message = f"is of format {content.get('format')}, this vgroove reads {FORMAT}"
        raise ReportError(message)
    report = _structured(content, Report, "")
    for blender, run in report.runs.items():
        if not re.fullmatch(r"[0-9]{1,4}(\.[0-9]{1,4}){0,3}", blender):
            message = f"{shown(blender)} is no version of Blender"
            raise ReportError(message)
        for key, cell in run.cells.items():
            if part_of(key) not in PARTS:
                message = f"{shown(key)} is of no part; there are {', '.join(PARTS)}"
                raise ReportError(message)
            run.cells[key] = _structured(cell, PARTS[part_of(key)], f"{key}: ")
    return report


def _structured(value: Any, kind: Any, where: str) -> Any:
    try:
        return CODEC.structure(value, kind)
    except (cattrs.BaseValidationError, TypeError, ValueError, AttributeError) as error:
        message = where + cattrs.transform_error(error)[0]
        raise ReportError(message) from error


def _codec() -> cattrs.Converter:
    made = cattrs.Converter(omit_if_default=True)
    for kind in (str, bool, int):
        made.register_structure_hook(kind, _exact)
    made.register_structure_hook(float, _float)
    made.register_unstructure_hook(float, _rounded)
    made.register_structure_hook_func(lambda kind: kind == Numbers, lambda values, _: _array(values, np.float64))
    made.register_structure_hook_func(lambda kind: kind == Flags, lambda values, _: _array(values, np.bool_))
    made.register_structure_hook_func(lambda kind: hasattr(kind, "_fields"), _named_tuple)
    made.register_unstructure_hook_func(
        lambda kind: kind in (Numbers, Flags, np.ndarray), lambda values: made.unstructure(values.tolist())
    )
    return made


def _named_tuple(values: Any, kind: Any) -> Any:
    """Of types that are not known until they are looked up, which cattrs does not do."""
    types = get_type_hints(kind).values()
    return kind(*(CODEC.structure(value, of) for value, of in zip(values, types, strict=True)))


def _exact(value: Any, kind: type) -> Any:
    if type(value) is not kind:
        message = f"{shown(value)} is no {kind.__name__}"
        raise TypeError(message)
    return value


def _float(value: Any, _: type) -> float:
    if type(value) not in (int, float):
        message = f"{shown(value)} is no number"
        raise TypeError(message)
    return float(value)


def _array(values: Any, kind: type) -> NDArray[Any]:
    """A list of truth values, or of numbers, of which null is nan."""
    types = {bool} if kind is np.bool_ else {int, float, type(None)}
    if not isinstance(values, list) or not types.issuperset(map(type, values)):
        message = f"{shown(values)} is no list of {'truth values' if kind is np.bool_ else 'numbers'}"
        raise TypeError(message)
    return np.asarray(values, kind)


def _rounded(value: float) -> float | None:
    """``DIGITS`` of a number; all near 1, as 1 - 1e-9 is not 1."""
    if not math.isfinite(value):
        return None
    short = float(f"{value:.{DIGITS}g}")
    return value if short in {0.0, 1.0} else short


CODEC = _codec()
