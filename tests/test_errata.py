# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/errata.md shows the numbers that tools/errata.py computes."""

import importlib.util
from pathlib import Path

ROOT = Path(__file__).parent.parent


def load_tool():
    spec = importlib.util.spec_from_file_location("errata", ROOT / "tools" / "errata.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_holds_every_table_to_the_digit():
    page = (ROOT / "docs" / "errata.md").read_text(encoding="utf-8")
    tables = load_tool().tables()
    assert len(tables) == 3
    for table in tables:
        assert table in page


def test_the_corrected_column_is_right_and_the_printed_one_is_not():
    """The corrected D integrates to 1 and the corrected F head-on is ((eta - 1)/(eta + 1))^2; as printed neither."""
    area, head_on, _ = ([row.strip("| ").split(" | ") for row in t.splitlines()[2:]] for t in load_tool().tables())
    for row in area:
        assert row[3] == "1.000000"
        assert row[1] == "0.785398"  # pi/4
    for row in head_on:
        assert row[4] == row[1]
        assert row[2] != row[1]
        assert row[3] != row[1]
