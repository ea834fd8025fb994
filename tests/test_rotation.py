# SPDX-License-Identifier: GPL-3.0-or-later
"""What the covering design leaves out takes turns by the date: all of it within a week, and the day is printed."""

from datetime import date, timedelta
from types import SimpleNamespace

from . import conftest

DAY = date(2026, 12, 1)


class Row:
    """A test of one grid; pytest's items have more."""

    def __init__(self, a, b):
        self.path, self.originalname, self.nodeid = "grid.py", "test_grid", f"grid.py::test_grid[{a}-{b}]"
        self.callspec = SimpleNamespace(params={"a": a, "b": b})

    def get_closest_marker(self, name):
        return name == "blender"


ROWS = [Row(a, b) for a in range(6) for b in range(6)]


def run_on(day, cover=1):
    """The names of the rows that are run."""
    items, options = list(ROWS), {"--cover": cover, "--rotate": day}
    hook = SimpleNamespace(pytest_deselected=lambda items: None)
    conftest.pytest_collection_modifyitems(SimpleNamespace(getoption=options.get, hook=hook), items)
    return {item.nodeid for item in items}


def test_a_week_runs_every_row_and_a_day_those_of_the_design():
    """Each row that is left out on one day of seven, the design's on every day."""
    design = run_on(None)
    assert len(design) < len(ROWS)
    nights = [run_on(DAY + timedelta(days)) for days in range(7)]
    assert set.union(*nights) == {row.nodeid for row in ROWS}
    assert set.intersection(*nights) == design
    assert sum(len(night - design) for night in nights) == len(ROWS) - len(design)
    assert run_on(DAY + timedelta(7)) == nights[0]


def test_the_day_is_printed_as_one_would_give_it():
    header = conftest.pytest_report_header(SimpleNamespace(getoption={"--rotate": DAY}.get))
    assert f"--rotate {DAY}" in header
    assert conftest.pytest_report_header(SimpleNamespace(getoption={"--rotate": None}.get)) is None


def test_every_row_is_run_where_all_are_wanted():
    assert len(run_on(None, cover=0)) == len(ROWS)
