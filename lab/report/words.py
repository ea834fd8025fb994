# SPDX-License-Identifier: GPL-3.0-or-later
"""How the numbers of a report are written. Imports nothing."""

from __future__ import annotations


def percent(share: float) -> str:
    return f"{short(100.0 * share)} %"


def times(factor: float) -> str:
    return f"{factor:.2f} ×" if factor < 10.0 else f"{short(factor)} ×"


def short(value: float) -> str:
    """Three digits, and all that stand before the point."""
    return f"{value:.3g}" if abs(value) < 1000.0 else f"{value:.0f}"


def bias(value: float | None, bound: float | None) -> str:
    """value: None where it cannot be distinguished from 0, but does not exceed ``bound``; that is None if unknown."""
    if value is not None:
        return percent(value)
    return "" if bound is None else f"< {percent(bound)}" if bound < 1.0 else "not known"


def number(value: float) -> str:
    """With a minus that is as wide as a digit."""
    return f"{value:.2f}".replace("-", "−")
