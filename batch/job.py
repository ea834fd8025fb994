# SPDX-License-Identifier: GPL-3.0-or-later
"""A job file (TOML) and the tasks that it stands for. Imports no bpy.

Every ``[[render]]`` table is a grid: its keys are those of ``vgroove render``, and a key with a list is an axis.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import os
from dataclasses import asdict, dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ..addon.library import presets
from ..addon.library.checks import PresetError, as_typed, check_key
from ..addon.library.errors import InputError
from ..addon.library.files import FileError, check_regular, one_root, read_text
from ..addon.library.inputs import MOST_SAMPLES, MOST_SEED, frame_range, shown, size, toml
from ..addon.library.inputs import name as name_in_blend
from ..addon.models import PARAMETERS, base_name, estimators, parameter
from ..addon.reference.hybrid import BOUNDS, DEFAULT_BOUND

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from ..addon.library.presets import Preset

T = TypeVar("T")
PREVIEW = "preview"  # the scene that comes with vgroove; its ball takes the preset
PREVIEW_SAMPLES, PREVIEW_SIZE = 128, (640, 480)  # of it by default; a .blend has its own
BACKENDS = ("nodes", "osl")
ESTIMATORS = ("auto", *estimators.ALL)
OUTPUTS = ("exr", "png")
MOST_TASKS = 1_000_000
ERRORS = 1e-4, 1.0  # that can be asked for; a hundredth of one takes ten thousand times as long
LONGEST_FILE = 1_000_000  # bytes
# The keys of a table, and their defaults
DEFAULTS: dict[str, Any] = {
    "scene": PREVIEW, "object": "", "preset": [], "assign": {}, "set": {}, "time": [], "frames": "",
    "backend": "nodes", "estimator": "auto", "bound": DEFAULT_BOUND, "dispersion": False, "multiple_scattering": False,
    "samples": [], "error": [], "seed": 0, "resolution": [], "output": "exr",
}  # fmt: skip
TOP = ("render",)


class JobError(PresetError):
    """A job file that does not hold."""


@dataclass(frozen=True)
class Task:
    """One still, and everything that decides its pixels.

    assignments: objects of the scene and the preset of each, at the task's time.
    samples, resolution: the scene's own where None; a preview has numbers.
    error: of noise, relative (``mean.Mean.error``), at which the still is done; in place of samples.
    labels: where the task stands in the grid, for people; not part of what it is.
    """

    scene: str
    digest: str  # of the scene file's content; empty for the preview scene
    assignments: tuple[tuple[str, Preset], ...]
    frame: int | None
    backend: str
    estimator: str
    bound: float
    dispersion: bool
    multiple_scattering: bool
    samples: int | None
    error: float | None
    seed: int
    resolution: tuple[int, int] | None
    outputs: tuple[str, ...]
    labels: tuple[tuple[str, str], ...] = ()

    def content(self) -> dict[str, Any]:
        """What decides the pixels, as JSON has it; names, sources and places of files do not."""
        materials = [
            [name, of.model, of.kind, of.flags, sorted(of.parameters.items()), *map(asdict, of.distribution)]
            + ([of.table.sha256] if of.table else [])
            for name, of in sorted(self.assignments)
        ]
        bounces = self.multiple_scattering and any(of.can_bounce for _, of in self.assignments)
        more = {"multiple_scattering": True} if bounces else {}  # tasks without it keep their names
        return more | {
            "scene": self.digest or PREVIEW, "materials": materials, "backend": self.backend,
            "frame": self.frame if self.digest else None,  # nothing else moves in the preview scene
            "estimator": self.estimator, "bound": self.bound if self.estimator in {"auto", "hybrid"} else None,
            "dispersion": self.dispersion and any(of.can_disperse for _, of in self.assignments),
            "samples": self.samples, "error": self.error, "seed": self.seed, "resolution": self.resolution,
        }  # fmt: skip

    def identity(self, versions: dict[str, str]) -> str:
        """The task's name: 32 hex digits of a SHA-256 of its content, and of the versions that render it."""
        text = json.dumps([self.content(), versions], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:32]

    @property
    def place(self) -> tuple[Any, ...]:
        """What requires reopening the scene: tasks with the same place render fastest one after another.

        Of a scene that it keeps, Cycles may remember that light was scattered or taken below a surface.
        """
        kinds = []
        for name, of in self.assignments:
            taken = of.parameters.get("absorption")
            kinds.append((name, of.model, isinstance(taken, tuple) and any(taken)))
        return self.scene, self.digest, self.backend, tuple(sorted(kinds))

    @cached_property
    def label(self) -> str:
        """The task in words."""
        return ", ".join(value if name == "preset" else f"{name} {value}" for name, value in self.labels)


def digest_of(path: Path) -> str:
    """The SHA-256 of a file's content, or of none where it cannot be read."""
    try:
        check_regular(path)
        state = path.stat()
        return _digest(path, state.st_mtime_ns, state.st_size)
    except OSError:
        return ""


@lru_cache(maxsize=4096)
def _digest(path: Path, _changed: int, _size: int) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def load(path: Path) -> list[Task]:
    """The tasks of a job file, each once, in the order of the file; JobError or PresetError if it does not hold.

    Scenes are looked for beside the file.
    """
    try:
        text = read_text(path, LONGEST_FILE)
    except FileError as error:
        message = f"{path}: cannot be read: {error}"
        raise JobError(message) from error
    return parse(text, str(path), path.parent)


def parse(text: str, where: str, folder: Path) -> list[Task]:
    """The tasks of a job in TOML ``text``; ``where`` opens every JobError."""
    try:
        data = toml(text)
    except InputError as error:
        message = f"{where}: {error}"
        raise JobError(message) from error
    for key in data:
        check_key(where, key, TOP)
    tables = as_typed(where, "render", data.get("render", []), list)
    if not tables:
        message = f'{where}: nothing to render; add a table [[render]] with preset = "copper"'
        raise JobError(message)
    grids, count = [], 0
    for number, table in enumerate(tables, 1):
        here = f"{where}: render {number}"
        grids.append(_Grid(here, as_typed(here, "[[render]]", table, dict), folder))
        count += grids[-1].count
        if count > MOST_TASKS:
            message = f"{here}: makes {shown(count)} tasks in all, more than {MOST_TASKS}; make several jobs of it"
            raise JobError(message)
    found: dict[str, Task] = {}
    for grid in grids:
        for task in grid.tasks():
            name = task.identity({})
            same = found.setdefault(name, task)
            if same.scene != task.scene:
                pair = f"{task.scene} and {same.scene}"
                message = f"{grid.where}: {pair} are the same file, and would be one still; name one of them"
                raise JobError(message)
            more = tuple(kind for kind in task.outputs if kind not in same.outputs)
            if more:  # a table that came before wanted less of it
                found[name] = replace(same, outputs=same.outputs + more)
    return list(found.values())


class _Grid:
    """One table [[render]]: its axes, each a list of values that hold."""

    def __init__(self, where: str, table: dict[str, Any], folder: Path) -> None:
        for key in table:
            check_key(where, key, DEFAULTS)
        self.where, self.table = where, DEFAULTS | table
        self.folder = folder
        self.object = as_typed(where, "object", self.table["object"], str)
        if self.object:
            self.read("object", name_in_blend, self.object)
        text = as_typed(where, "frames", self.table["frames"], str)
        self.frames = self.read("frames", frame_range, text) if text else range(0)
        self.outputs = tuple(self.choices("output", OUTPUTS))
        fixed = as_typed(where, "assign", self.table["assign"], dict)
        self.fixed = tuple(
            (self.read("assign", name_in_blend, name), self.find_preset("assign", preset))
            for name, preset in fixed.items()
        )
        changes = as_typed(where, "set", self.table["set"], dict)
        self.axes: dict[str, list[Any]] = {
            "scene": [self.scene(one) for one in self.values("scene")],
            "preset": [self.find_preset("preset", one) for one in self.values("preset")] or [None],
            **{f"set.{name}": _axis(where, name, value) for name, value in changes.items()},
            "time": [self.number("time", one) for one in self.values("time")] or [None],
            "frame": list(self.frames) or [None],
            "backend": self.choices("backend", BACKENDS),
            "estimator": self.choices("estimator", ESTIMATORS),
            "bound": [self.number("bound", one, *BOUNDS) for one in self.values("bound")],
            **{
                name: [as_typed(where, name, one, bool) for one in self.values(name)]
                for name in ("dispersion", "multiple_scattering")
            },
            "samples": [self.whole("samples", one, 1, MOST_SAMPLES) for one in self.values("samples")] or [None],
            "error": [self.number("error", one, *ERRORS) for one in self.values("error")] or [None],
            "seed": [self.whole("seed", one, 0, MOST_SEED) for one in self.values("seed")],
            "resolution": [self.size(one) for one in self.values("resolution")] or [None],
        }
        self.holds_together()

    @property
    def count(self) -> int:
        return math.prod(map(len, self.axes.values()))

    def holds_together(self) -> None:  # noqa: C901 - one condition a line
        """What one key asks of another."""
        shown = [path for path, _ in self.axes["scene"]]
        chosen = [one for one in self.axes["preset"] if one is not None]
        message = ""
        if PREVIEW in shown and (self.object or self.fixed):
            message = "object and assign go with a .blend; the preview scene shows the preset itself"
        elif PREVIEW in shown and not chosen:
            message = 'preset is missing; add preset = "copper"'
        elif chosen and set(shown) != {PREVIEW} and not self.object:
            message = 'object is missing: which of the scene\'s gets the preset? add object = "Ball"'
        elif self.object and not chosen:
            message = f'object "{self.object}" has no preset to get; add preset = "copper"'
        elif self.object in dict(self.fixed):
            message = f'"{self.object}" is the object of preset and in assign too; take one of them out'
        elif self.axes["time"] != [None] and self.frames:
            message = "time shows moments and frames a sequence; give one of them"
        elif self.axes["samples"] != [None] and self.axes["error"] != [None]:
            message = "samples says how many, and error how few would do; give one of them"
        elif self.table["set"] and not chosen:
            message = "set changes parameters of preset, which is missing"
        moved = [one for one in [*chosen, *(one for _, one in self.fixed)] if one.time]
        if not message and self.axes["time"] != [None] and not moved:
            message = "time: none of the presets changes over time; leave it out"
        if message:
            message = f"{self.where}: {message}"
            raise JobError(message)

    def tasks(self) -> Iterator[Task]:
        """The grid's points, the last axis first."""
        varied = [name for name, axis in self.axes.items() if len(axis) > 1 or name in {"preset", "time", "frame"}]
        for values in itertools.product(*self.axes.values()):
            at = dict(zip(self.axes, values, strict=True))
            path, digest = at["scene"]
            assignments = [(name, self.at_point(one, at)) for name, one in self.fixed]
            if at["preset"] is not None:
                changes = {name[4:]: value for name, value in at.items() if name.startswith("set.")}
                assignments.append((self.object or "Ball", self.at_point(self.changed(at["preset"], changes), at)))
            if path == PREVIEW:
                at["resolution"] = at["resolution"] or PREVIEW_SIZE
                at["samples"] = at["samples"] or (None if at["error"] else PREVIEW_SAMPLES)
            labels = tuple((name.removeprefix("set."), _text(at[name])) for name in varied if at[name] is not None)
            yield Task(
                path, digest, tuple(assignments), at["frame"], at["backend"], at["estimator"], at["bound"],
                at["dispersion"], at["multiple_scattering"], at["samples"], at["error"], at["seed"], at["resolution"],
                self.outputs, labels,
            )  # fmt: skip

    def changed(self, preset: Preset, changes: dict[str, Any]) -> Preset:
        try:
            return preset.with_parameters(**changes)
        except PresetError as error:
            message = f"{self.where}: set: {error}"
            raise JobError(message) from error

    def at_point(self, preset: Preset, at: dict[str, Any]) -> Preset:
        """The preset as it is at the point's time, or as far through its course as the frame is through the frames."""
        if preset.time is None:
            return preset
        if at["time"] is not None:
            return preset.at(at["time"])
        if at["frame"] is None:
            return replace(preset, time=None)
        age = (at["frame"] - self.frames[0]) / max(self.frames[-1] - self.frames[0], 1)
        return preset.at(float(preset.trajectory().time(age)))

    # One value of a key

    def values(self, key: str) -> list[Any]:
        value = self.table[key]
        if value == [] and value is not DEFAULTS[key]:
            message = f"{self.where}: {key} is an empty list; give a value or leave it out"
            raise JobError(message)
        return value if isinstance(value, list) else [value]

    def scene(self, value: Any) -> tuple[str, str]:
        """PREVIEW, or a .blend by its path and the SHA-256 of its content."""
        name = as_typed(self.where, "scene", value, str)
        if name == PREVIEW:
            return PREVIEW, ""
        path = one_root(Path(os.path.normpath(self.folder.absolute() / name)))
        if path.suffix != ".blend" or not path.is_file():
            message = f'{self.where}: scene "{name}": no such .blend in {self.folder.absolute()}, nor is it "{PREVIEW}"'
            raise JobError(message)
        return str(path), digest_of(path)

    def find_preset(self, key: str, value: Any) -> Preset:
        name = as_typed(self.where, key, value, str)
        try:
            return presets.find(name)
        except PresetError as error:
            message = f"{self.where}: {key}: {error}"
            raise JobError(message) from error

    def choices(self, key: str, known: Sequence[str]) -> list[str]:
        for value in self.values(key):
            if as_typed(self.where, key, value, str) not in known:
                message = f'{self.where}: unknown {key} "{value}"; use {", ".join(known)}'
                raise JobError(message)
        return self.values(key)

    def number(self, key: str, value: Any, low: float = -math.inf, high: float = math.inf) -> float:
        try:
            number = float(as_typed(self.where, key, value, float))
        except OverflowError:  # an integer of hundreds of digits
            number = math.inf
        if not (math.isfinite(number) and low <= number <= high):
            span = f" from {low:g} to {high:g}" if math.isfinite(low) else ""
            message = f"{self.where}: {key} must be a number{span}, got {number:g}"
            raise JobError(message)
        return number

    def whole(self, key: str, value: Any, low: int, high: int) -> int:
        if not isinstance(value, int) or isinstance(value, bool) or not low <= value <= high:
            message = f"{self.where}: {key} must be a whole number from {low} to {high}, got {shown(value)}"
            raise JobError(message)
        return value

    def size(self, value: Any) -> tuple[int, int]:
        return self.read("resolution", size, as_typed(self.where, "resolution", value, str))

    def read(self, key: str, reader: Callable[[str], T], text: str) -> T:
        """What a function of ``inputs`` makes of a text."""
        try:
            return reader(text)
        except InputError as error:
            message = f"{self.where}: {key} {shown(text)}: {error}"
            raise JobError(message) from error


def _is_rgb(name: str) -> bool:
    return base_name(name) in PARAMETERS and parameter(name).is_rgb


def _axis(where: str, name: str, value: Any) -> list[Any]:
    """Values of a parameter. For a colour, a list of numbers is one value, a list of lists several."""
    if value == []:
        message = f"{where}: set.{name} is an empty list; give a value or leave it out"
        raise JobError(message)
    several = isinstance(value, list) and (not _is_rgb(name) or any(isinstance(one, list) for one in value))
    return value if several else [value]


def _text(value: Any) -> str:
    """A value of an axis for people."""
    if hasattr(value, "id"):
        return str(value.id)
    if isinstance(value, (list, tuple)):
        return Path(value[0]).stem if isinstance(value[0], str) else "x".join(f"{part:.12g}" for part in value)
    return f"{value:.12g}" if isinstance(value, float) else str(value)
