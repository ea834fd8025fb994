# SPDX-License-Identifier: GPL-3.0-or-later
"""Sidak's correction: limits for many tests at once, of which noise alone fails any with probability ``MISTAKEN``."""

from __future__ import annotations

from scipy.stats import norm

MISTAKEN = 0.01


def chance(tests: int) -> float:
    """The probability with which each of ``tests`` tests may fail by chance."""
    return float(1.0 - (1.0 - MISTAKEN) ** (1.0 / tests))


def limit(tests: int, sides: int = 2) -> float:
    """How large a standard normal value, or with two sides its absolute value, may be in each of ``tests`` tests."""
    return float(norm.isf(chance(tests) / sides))
