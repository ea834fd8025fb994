# SPDX-License-Identifier: GPL-3.0-or-later
"""What each file of tests spends, as the Markdown table of docs/testing.md.

python tools/test_times.py NAME=FILE.xml...     of runs as `make test` has them, with --junitxml=FILE.xml; a column each

Seconds are those of the tests, added up: two workers take about half as long. Files below a hundredth of the first
run's sum are put together.
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from collections import Counter
from itertools import chain


def spent(path: str) -> Counter[str]:
    """Seconds of each file."""
    found: Counter[str] = Counter()
    for case in ET.parse(path).getroot().iter("testcase"):  # noqa: S314 - pytest's own
        found[": ".join(case.get("classname", "").split(".")[-2:])] += float(case.get("time", 0.0))
    return found


def main() -> None:
    runs = dict(argument.split("=", 1) for argument in sys.argv[1:])
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


if __name__ == "__main__":
    main()
