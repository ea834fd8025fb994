# SPDX-License-Identifier: GPL-3.0-or-later
"""The files that a stranger reads first: what to cite, what to report and how, what changes images."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
FORMS = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("[!c]*.yml"))
MARK = "*Images change:*"


def read(path):
    return yaml.safe_load((ROOT / path).read_text(encoding="utf-8"))


def test_what_to_cite_is_this_version():
    """With the keys that the format needs, and the papers that README names."""
    cited = read("CITATION.cff")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert {"cff-version", "message", "title", "authors"} <= cited.keys()
    assert (cited["version"], cited["license"]) == (project["version"], project["license"])
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"https://doi\.org/([\w./]+\w)", readme)) <= {one["doi"] for one in cited["references"]}


def test_forms_ask_for_what_is_needed():
    """Each has a name, ids of its own and something to fill in; for pictures that is versions, scene and account."""
    assert len(FORMS) == 3
    for path in FORMS:
        form = read(path)
        assert {"name", "description", "body"} <= form.keys()
        ids = [field["id"] for field in form["body"]]
        assert len(set(ids)) == len(ids)
        assert any(field.get("validations", {}).get("required") for field in form["body"])
        assert all(field["type"] in {"input", "textarea"} and field["attributes"]["label"] for field in form["body"])
    picture = read(".github/ISSUE_TEMPLATE/wrong_picture.yml")
    assert [field["id"] for field in picture["body"]] == ["version", "blender", "happened", "scene", "explain"]
    assert "vgroove explain" in picture["body"][-1]["attributes"]["description"]


def test_the_changelog_marks_what_changes_images():
    """By one mark, which it explains, at the beginning of an entry."""
    head, *sections = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split("\n## ")
    assert MARK in head
    entries = [line for text in sections for line in re.findall(r"^- .*", text, flags=re.MULTILINE)]
    assert sum(line.startswith(f"- {MARK}") for line in entries) >= 4
    assert not [line for line in entries if MARK.casefold() in line.casefold() and not line.startswith(f"- {MARK}")]


@pytest.mark.parametrize("page", ["SECURITY.md", "CODE_OF_CONDUCT.md"])
def test_their_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#:]+)\)", (ROOT / page).read_text(encoding="utf-8")):
        assert (ROOT / target).is_file(), target
