# SPDX-License-Identifier: GPL-3.0-or-later
"""How a preset's numbers change: the table [time] of its file, checked.

    [time]
    unit = "days"                   # one of UNITS
    range = [0.0, 12.0]             # from the numbers above to the end
    kind = "authored"               # measured, fitted or authored
    [time.m]                        # a table for each number that changes; it starts from the number above
    law = "exponential"             # and what that law asks for, in these units
    end = 0.4
    rate = 0.5

The laws are those of ``reference.trajectory``:

- "exponential": end, rate; or rates and shares, of a law with several. May have begin, as all but "keys".
- "reciprocal": end, rate.
- "logistic": end, rate, middle.
- "power": end, exponent; the end is reached at that of the range.
- "polynomial": coefficients of t, t^2 and so on, t counted from the start.
- "keys": times and values after the start; straight between, geometric for slopes m.

Imports no bpy.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..models import parameter
from ..reference.trajectory import Exponential, Keys, Law, Logistic, Polynomial, Power, Reciprocal, Trajectory
from .checks import PresetError, as_number, as_typed, check_key
from .inputs import shown

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

UNITS = ("s", "min", "h", "days", "weeks", "months", "years", "share")  # "share" of a whole whose length is not known
KINDS = ("measured", "fitted", "authored")
LONGEST = 1e9  # of a range, in its unit
MOST_KEYS = 256
# What a law's table holds; those in brackets may be left out
NEEDED: dict[str, tuple[str, ...]] = {
    "exponential": ("end",),
    "reciprocal": ("end", "rate"),
    "logistic": ("end", "rate", "middle"),
    "power": ("end", "exponent"),
    "polynomial": ("coefficients",),
    "keys": ("times", "values"),
}
OPTIONAL: dict[str, tuple[str, ...]] = {
    "exponential": ("rate", "rates", "shares", "begin"),
    "reciprocal": ("begin",),
    "logistic": ("begin",),
    "power": ("begin",),
    "polynomial": (),
    "keys": (),
}
TEST_AGES = np.linspace(0.0, 1.0, 33)  # where a changing preset is checked to hold together, beside its events


@dataclass(frozen=True)
class Timeline:
    """``unit`` of time, from ``start`` to ``end``; ``kind``: how it is known; ``laws``: the table of each parameter."""

    unit: str
    start: float
    end: float
    kind: str
    laws: dict[str, dict[str, Any]]

    def trajectory(self, parameters: dict[str, Any]) -> Trajectory:
        """The changing ones of ``parameters``, which are those at the start, each by its law."""
        laws = {name: self._law(name, parameters[name]) for name in self.laws}
        ranges = {name: (parameter(name).low, parameter(name).high) for name in self.laws}
        return Trajectory(laws, self.start, self.end, ranges)

    def without(self, names: Iterable[str]) -> Timeline | None:
        """The same but for parameters that are to stand still; None where nothing is left to change."""
        left = {name: table for name, table in self.laws.items() if name not in set(names)}
        return replace(self, laws=left) if left else None

    def _law(self, name: str, start: Any) -> Law:
        table = dict(self.laws[name])
        law, begin = table.pop("law"), table.pop("begin", self.start)
        if law == "exponential":
            rates = table.get("rates") or [table["rate"]]
            return Exponential(start, table["end"], tuple(rates), tuple(table.get("shares", [1.0])), begin)
        if law == "reciprocal":
            return Reciprocal(start, table["end"], table["rate"], begin)
        if law == "logistic":
            return Logistic(start, table["end"], table["rate"], table["middle"], begin)
        if law == "power":
            return Power(start, table["end"], table["exponent"], begin, self.end)
        if law == "polynomial":
            return Polynomial(_about(np.array([start, *table["coefficients"]]), self.start))
        times, values = [self.start, *table["times"]], np.array([start, *table["values"]])
        return Keys(times, values, geometric=parameter(name).is_roughness)

    @cached_property
    def moments(self) -> tuple[float, ...]:
        """Times at which to see whether all that changes holds together."""
        keys = [time for table in self.laws.values() for time in table.get("times", [])]
        return tuple(sorted({*(self.start + TEST_AGES * (self.end - self.start)).tolist(), *keys}))


def plain(value: Any) -> float | tuple[float, float, float]:
    """A number or a colour as presets hold them."""
    array = np.asarray(value)
    return tuple(array.tolist()) if array.ndim else float(array)


def _about(coefficients: ArrayLike, start: float) -> ArrayLike:
    """Coefficients of t for those of t - start."""
    c = np.asarray(coefficients, float)
    if start == 0.0:
        return c
    result = np.zeros_like(c)
    for coefficient in c[::-1]:  # Horner: result (t - start) + coefficient
        result = np.concatenate([np.zeros_like(result[:1]), result[:-1]]) - start * result
        result[0] += coefficient
    return result


def parse(where: str, table: dict[str, Any], parameters: dict[str, Any]) -> Timeline:
    """The table [time] of a preset with these ``parameters`` at its start; PresetError names what does not hold."""
    where = f"{where}: [time]"
    for key in ("unit", "range", "kind"):
        if key not in table:
            example = {"unit": 'unit = "days"', "range": "range = [0.0, 10.0]", "kind": 'kind = "authored"'}[key]
            message = f'{where}: "{key}" is missing; add {example}'
            raise PresetError(message)
    for key, value, allowed in (("unit", table["unit"], UNITS), ("kind", table["kind"], KINDS)):
        if value not in allowed:
            message = f"{where}: {key} must be one of {', '.join(allowed)}, got {shown(value)}"
            raise PresetError(message)
    start, end = _range(where, table["range"])
    laws = {key: value for key, value in table.items() if key not in {"unit", "range", "kind"}}
    if not laws:
        message = f"{where}: nothing changes; add a table such as [time.{next(iter(parameters))}] with a law"
        raise PresetError(message)
    for name, law in laws.items():
        check_key(where, name, parameters)
        laws[name] = _checked(f"{where}: {name}", name, as_typed(where, name, law, dict), parameters[name], start, end)
    timeline = Timeline(table["unit"], start, end, table["kind"], laws)
    try:
        timeline.trajectory(parameters)
    except ValueError as error:
        message = f"{where}: {error}"
        raise PresetError(message) from error
    return timeline


def _range(where: str, values: Any) -> tuple[float, float]:
    ends = [_finite(where, "range", value) for value in as_typed(where, "range", values, list)]
    if len(ends) != 2 or not ends[0] < ends[1]:
        message = f"{where}: range must be two times, the later one last, got {values}"
        raise PresetError(message)
    return ends[0], ends[1]


def _checked(
    where: str, name: str, table: dict[str, Any], start: Any, begin: float, finish: float
) -> dict[str, Any]:  # fmt: skip
    """The table of one law, its numbers as floats; values of the parameter are within the parameter's range."""
    law = _complete(where, table)
    if parameter(name).zero_is_smooth and start == 0.0:
        message = f"{where}: {name} is 0, a smooth interface, which cannot change; start from a slope of 0.0001 or more"
        raise PresetError(message)
    checked: dict[str, Any] = {"law": law}
    for key, value in table.items():
        if key in {"values", "coefficients", "times", "rates", "shares"}:
            read = {"values": _value, "coefficients": _coefficient}.get(key, _finite)
            checked[key] = [read(where, name, one) for one in as_typed(where, key, value, list)]
            if not 1 <= len(checked[key]) <= MOST_KEYS:
                message = f"{where}: {key} must be 1 to {MOST_KEYS}, got {len(checked[key])}"
                raise PresetError(message)
        elif key != "law":
            checked[key] = _value(where, name, value) if key == "end" else _finite(where, key, value)
    times = checked.get("times", [])
    if len(times) != len(checked.get("values", [])) or any(not begin < time <= finish for time in times):
        message = f"{where}: times must be one for each value, after {begin:g} and up to {finish:g}, got {times}"
        raise PresetError(message)
    return checked


def _complete(where: str, table: dict[str, Any]) -> str:
    """The law that a table names; PresetError where the law is unknown, or the table has not what the law needs."""
    law = table.get("law")
    if not isinstance(law, str) or law not in NEEDED:
        message = f"{where}: law must be one of {', '.join(NEEDED)}, got {shown(law)}"
        raise PresetError(message)
    for key in table:
        check_key(where, key, ("law", *NEEDED[law], *OPTIONAL[law]))
    several = ("rates", "shares") if "rates" in table else ("rate",)
    needed = (*NEEDED[law], *several) if law == "exponential" else NEEDED[law]
    for key in needed:
        if key not in table:
            message = f'{where}: "{key}" is missing; law "{law}" needs {", ".join(needed)}'
            raise PresetError(message)
    return str(law)


def _value(where: str, name: str, value: Any) -> Any:
    """A value of the parameter; a slope never becomes 0."""
    number = as_number(where, name, value)
    if parameter(name).zero_is_smooth and number == 0.0:
        message = f"{where}: a slope cannot become 0; use 0.0001 or more"
        raise PresetError(message)
    return number


def _coefficient(where: str, name: str, value: Any) -> Any:
    if not parameter(name).is_rgb:
        return _finite(where, "coefficients", value)
    channels = value if isinstance(value, (list, tuple)) else [value] * 3
    if len(channels) != 3:
        message = f"{where}: coefficients must be numbers or lists of three (R, G, B), got {shown(value)}"
        raise PresetError(message)
    return tuple(_finite(where, "coefficients", one) for one in channels)


def _finite(where: str, key: str, value: Any) -> float:
    number = as_typed(where, key, value, float)
    if not -LONGEST <= number <= LONGEST:  # NaN too
        message = f"{where}: {key} must be between {-LONGEST:g} and {LONGEST:g}, got {shown(value)}"
        raise PresetError(message)
    return float(number)
