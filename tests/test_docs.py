# SPDX-License-Identifier: GPL-3.0-or-later
"""What the documents say can be run, and what they point at is there."""

import doctest
import re
import textwrap
from pathlib import Path

import pytest

from vgroove.addon import presets

ROOT = Path(__file__).parent.parent
PAGES = ["README.md", "CONTRIBUTING.md", *sorted(str(p.relative_to(ROOT)) for p in (ROOT / "docs").glob("*.md"))]


def test_the_examples_in_the_readme_give_what_they_show():
    failed, tried = doctest.testfile(str(ROOT / "README.md"), module_relative=False)
    assert tried >= 4
    assert failed == 0


@pytest.mark.parametrize("page", PAGES)
def test_links_and_pictures_are_there(page):
    path = ROOT / page
    for target in re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8")):
        assert (path.parent / target).is_file(), target


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_every_make_target_that_is_named_exists(page):
    targets = set(re.findall(r"^([a-z0-9.-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE))
    named = set(
        re.findall(r"(?:^    |`)make ([a-z0-9.-]+)", (ROOT / page).read_text(encoding="utf-8"), flags=re.MULTILINE)
    )
    assert named
    assert named <= targets


def cells(row):
    return [cell.strip() for cell in row.strip().strip("|").split("|")]


def test_automatic_is_within_ten_percent_of_the_best():
    """In every row of docs/error.md, which bench/error.py writes: what is bold against the least."""
    rows = [
        cells(line) for line in (ROOT / "docs" / "error.md").read_text(encoding="utf-8").splitlines() if "**" in line
    ]
    rows = [row for row in rows if row[0].replace(".", "").isdigit()]
    assert len(rows) == 3 * 3 * 5  # scenes, slopes, sample counts
    for row in rows:
        errors = [float(cell.strip("*").split()[0]) for cell in row[2:]]
        (picked,) = (error for error, cell in zip(errors, row[2:], strict=True) if cell.startswith("**"))
        assert picked <= 1.1 * min(errors), row


def test_the_preset_that_is_shown_as_an_example_holds():
    """And so does the one at the top of the module."""
    (shown,) = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "presets.md").read_text(encoding="utf-8"), re.DOTALL)
    (other,) = re.findall(r"checked\.\n\n(.*?)\n\nOther models", presets.__doc__, re.DOTALL)
    assert presets.parse(shown, "mine/old_bronze", "example").tags == ("metal", "alloy")
    assert presets.parse(textwrap.dedent(other), "mine/copper", "example").m_range == (0.02, 0.5)


def test_the_readme_says_how_many_presets_there_are():
    assert f"\n{len(presets.shipped())} presets" in (ROOT / "README.md").read_text(encoding="utf-8")
