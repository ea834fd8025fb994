# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables [[distribution]] of a preset: how its facets are turned. Imports no bpy.

    [[distribution]]
    abc = [10482.1, 0.82]   # or beckmann, ggx or exponential = RMS slope; or points = 2 to 64 values of D
    weight = 0.7            # of several terms: its share of the facets' area; may be left out

Points stand at (k/(N - 1))^2 90 degrees, k from 0 to N - 1, in any unit: D is scaled to unit projected area.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..reference.facet_distribution import FORMULAS, POINTS, Distribution, Term
from .checks import PresetError, as_typed, check_key

if TYPE_CHECKING:
    from collections.abc import Iterable

KINDS = (*FORMULAS, POINTS)


def parse(where: str, tables: Any) -> tuple[Term, ...]:
    """The terms; PresetError names what does not hold."""
    where = f"{where}: [[distribution]]"
    terms = tuple(_term(where, table) for table in as_typed(where, "distribution", tables, list))
    try:
        Distribution(terms)
    except ValueError as error:
        message = f"{where}: {error}"
        raise PresetError(message) from error
    return terms


def _term(where: str, table: Any) -> Term:
    for key in as_typed(where, "a term", table, dict):
        check_key(where, key, ("weight", *KINDS))
    kinds = [key for key in table if key != "weight"]
    if len(kinds) != 1:
        message = f"{where}: a term has one of {', '.join(KINDS)}; got {', '.join(kinds) or 'none'}"
        raise PresetError(message)
    (kind,) = kinds
    given = table[kind] if isinstance(table[kind], list) else [table[kind]]
    numbers = tuple(float(as_typed(where, kind, number, float)) for number in given)
    try:
        return Term(kind, numbers, float(as_typed(where, "weight", table.get("weight", 1.0), float)))
    except ValueError as error:
        message = f"{where}: {error}"
        raise PresetError(message) from error


def tables(terms: Iterable[Term]) -> list[dict[str, Any]]:
    """What ``parse`` reads back to the same."""
    return [{term.kind: term.numbers[0] if len(term.numbers) == 1 else term.numbers} | _weight(term) for term in terms]


def _weight(term: Term) -> dict[str, float]:
    return {} if term.weight == 1.0 else {"weight": term.weight}


def of_record(kept: Iterable[dict[str, Any]]) -> tuple[Term, ...]:
    """Terms that ``dataclasses.asdict`` and JSON took apart."""
    return tuple(Term(one["kind"], tuple(one["numbers"]), one["weight"]) for one in kept)
