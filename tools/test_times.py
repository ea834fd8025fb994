# SPDX-License-Identifier: GPL-3.0-or-later
"""What each file of tests spends, as the Markdown table of docs/testing.md.

python tools/test_times.py NAME=FILE.xml...     of runs with --junitxml=FILE.xml; a column each
python tools/test_times.py --slow FILE.xml...   writes tests/data/slow.txt: the tests that `make test` leaves to
                                                `make test-once`, as they took over two seconds in one of the runs

Seconds are those of the tests, added up: two workers take about half as long. Files below a hundredth of the first
run's sum are put together.
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from collections import Counter
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

SLOW = 2.0  # seconds
LIST = Path(__file__).parents[1] / "tests" / "data" / "slow.txt"


def cases(path: str) -> Iterable[tuple[str, str, float]]:
    """Module, name and seconds of each test."""
    for case in ET.parse(path).getroot().iter("testcase"):  # noqa: S314 - pytest's own
        yield case.get("classname", ""), case.get("name", ""), float(case.get("time", 0.0))


def spent(path: str) -> Counter[str]:
    """Seconds of each file."""
    found: Counter[str] = Counter()
    for module, _, seconds in cases(path):
        found[": ".join(module.split(".")[-2:])] += seconds
    return found


def write_slow(paths: list[str]) -> None:
    """Their names, as pytest has them, one a line."""
    found = {
        f"{module.replace('.', '/')}.py::{name}"
        for path in paths
        for module, name, seconds in cases(path)
        if seconds > SLOW
    }
    LIST.write_text("".join(f"{name}\n" for name in sorted(found)), encoding="utf-8")
    print(f"{LIST}: {len(found)} tests")


def print_table(runs: dict[str, str]) -> None:
    """A column for each run; its name and its file."""
    columns = {name: spent(path) for name, path in runs.items()}
    first = next(iter(columns.values()))
    large = [file for file, seconds in first.most_common() if seconds >= first.total() / 100.0]
    print("| file | " + " | ".join(columns) + " |")
    print("| --- |" + " --- |" * len(columns))
    for file in large:
        print(f"| {file} | " + " | ".join(f"{of[file]:.0f}" for of in columns.values()) + " |")
    others = [sum(of[file] for file in set(chain(*columns.values())) - set(large)) for of in columns.values()]
    print("| others | " + " | ".join(f"{seconds:.0f}" for seconds in others) + " |")
    print("| all | " + " | ".join(f"{of.total():.0f}" for of in columns.values()) + " |")


def main() -> None:
    if sys.argv[1] == "--slow":
        write_slow(sys.argv[2:])
    else:
        print_table(dict(argument.split("=", 1) for argument in sys.argv[1:]))


if __name__ == "__main__":
    main()
