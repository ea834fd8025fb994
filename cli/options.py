# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that several commands have, and the parsers of their values."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from ..addon.library import inputs
from ..addon.library.errors import InputError
from ..addon.library.inputs import MOST_SAMPLES, MOST_SEED
from ..addon.models import estimators
from ..addon.reference.hybrid import BOUNDS

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..addon.library.presets import Preset

T = TypeVar("T")


class Backend(StrEnum):
    NODES = "nodes"
    OSL = "osl"


if TYPE_CHECKING:
    Estimator = StrEnum
else:
    Estimator = StrEnum("Estimator", {name.upper(): name for name in ("auto", *estimators.ALL)})
AUTO = Estimator("auto")


def whole(low: int, high: int) -> Callable[[Any], int]:
    """A parser of whole numbers from ``low`` to ``high``."""
    return _parser(lambda text: inputs.whole(text, low, high))


def real(low: float = -math.inf, high: float = math.inf) -> Callable[[Any], float]:
    """A parser of finite numbers from ``low`` to ``high``."""
    return _parser(lambda text: inputs.real(text, low, high))


def _parser(read: Callable[[str], T]) -> Callable[[Any], T]:
    def parse(value: Any) -> T:  # a default is a number already
        try:
            return read(str(value))
        except InputError as error:
            raise typer.BadParameter(str(error)) from error

    return parse


PresetArgument = Annotated[str, typer.Argument(metavar="PRESET", help="A preset's id, or the end of one: copper")]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Change a parameter: m=0.2, eta=1.5, f0=0.9,0.6,0.5 (repeatable)"),
]
BackendOption = Annotated[Backend, typer.Option(help="nodes: every device; osl: CPU and OptiX")]
BoundOption = Annotated[
    float,
    typer.Option(
        parser=real(*BOUNDS), metavar="SHARE", help="hybrid: largest error, as a share of the reflected light"
    ),
]
SamplesOption = Annotated[int, typer.Option(parser=whole(1, MOST_SAMPLES), metavar="N", help="Samples per pixel")]
SeedOption = Annotated[
    int, typer.Option(parser=whole(0, MOST_SEED), metavar="N", help="Seed of Cycles' random numbers")
]
TimeOption = Annotated[
    float | None,
    typer.Option("--time", parser=real(), metavar="T", help="For presets that change: the time, in the preset's unit"),
]


def apply_settings(preset: Preset, settings: list[str] | None, at_time: float | None = None) -> Preset:
    """The preset at a time, with the parameters of ``--set``. InputError if it has no such time or parameter."""
    if at_time is not None:
        if preset.time is None:
            message = f"--time: preset {preset.id} does not change over time; leave it out"
            raise InputError(message)
        preset = preset.at(at_time)
    changes: dict[str, Any] = {}
    for item in settings or []:
        name, equals, text = item.partition("=")
        try:
            values = [inputs.real(part.strip()) for part in text.split(",")]
        except InputError:
            equals = ""
        if not equals:
            message = f'--set "{item}": write NAME=NUMBER or NAME=R,G,B, as in m=0.2 or f0=0.9,0.6,0.5'
            raise InputError(message)
        changes[name] = values[0] if len(values) == 1 else values
    return preset.with_parameters(**changes)


def parse_resolution(text: str) -> tuple[int, int]:
    """Width and height in pixels, of text WIDTHxHEIGHT. InputError for any other."""
    try:
        return inputs.size(text)
    except InputError as error:
        message = f'resolution "{text}": {error}'
        raise InputError(message) from error
