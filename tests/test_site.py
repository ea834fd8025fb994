# SPDX-License-Identifier: GPL-3.0-or-later
"""The site: it builds without a warning, needs no network, and its tutorials do what they say."""

import importlib.util
import json
import os
import re
import subprocess
import sys
from html import unescape
from pathlib import Path

import pytest

from vgroove.addon.library import presets
from vgroove.addon.models import MODELS, PARAMETERS
from vgroove.batch import job

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
LOADED = re.compile(r'<(?:script|img|iframe|link)\b[^>]*?\b(?:src|href)="([^"]+)"')
# Of Blender's own, and keys: what the artist's pages name that is not in addon/ui
BLENDERS = {
    "Edit > Preferences > Get Extensions", "Install from Disk", "File > New > General", "Delete", "Add > Mesh",
    "Shade Smooth", "Render", "Render Engine", "Cycles", "View > Align View > Align Active Camera to View",
    "Render > Render Image", "Image > Save As", "Open Shading Language", "Multiple Importance", "Khronos PBR Neutral",
    "search for", "Direct", "Standard",
}  # fmt: skip


def load(path):
    """A module of tools/, which is no package."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Built; mkdocs ends with an error if a page, a link or an anchor is missing."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    quiet = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, env=quiet)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.once
def test_every_model_has_a_page_and_every_preset_a_row(site):
    """Of what is generated; the pages have their equations."""
    for name, of in MODELS.items():
        page = (site / "models" / f"{name}.html").read_text(encoding="utf-8")
        assert f'<h1 id="{of.label.lower().replace(" ", "-")}">{of.label}' in page
        assert '<math xmlns="http://www.w3.org/1998/Math/MathML" display="block"' in page, name
        assert all(f"<code>{one.name}</code>" in page for one in (*of.parameters, *of.lobes)), name
    rows = re.findall(r"<br><code>([\w/]+)</code>", (site / "catalogue.html").read_text(encoding="utf-8"))
    assert sorted(rows) == sorted(presets.shipped())


@pytest.mark.once
def test_no_page_loads_anything_from_elsewhere(site):
    """And what a page loads is there. The viewer's page is one file."""
    for page in site.rglob("*.html"):
        for target in map(unescape, LOADED.findall(page.read_text(encoding="utf-8"))):
            if not target.startswith("data:"):
                assert "//" not in target, (page, target)
                assert page.name == "404.html" or (page.parent / target.partition("?")[0]).exists(), (page, target)


@pytest.mark.once
def test_a_dead_link_is_seen(tmp_path):
    """So that a site that builds has none."""
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("[no](gone.md)", encoding="utf-8")
    settings = "site_name: x\nvalidation: {links: {not_found: warn}}\n"
    (tmp_path / "mkdocs.yml").write_text(settings, encoding="utf-8")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict"]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 1


def test_pages_of_models_are_those_of_the_registry():
    """A page for each, named as in Blender, with limits and sources; pictures of at most 100 kB."""
    assert {path.stem for path in (DOCS / "models").glob("*.md")} == MODELS.keys()
    for name, of in MODELS.items():
        text = (DOCS / "models" / f"{name}.md").read_text(encoding="utf-8")
        assert text.startswith(f"# {of.label}\n")
        assert "$$" in text
        assert re.findall(r"^## (.*)$", text, re.MULTILINE) == ["Limits", "Sources"]
    assert all(path.stat().st_size < 100_000 for path in (DOCS / "models").glob("*.webp"))
    measured = json.loads((DOCS / "models" / "measured.json").read_text(encoding="utf-8"))
    for name, of in measured.items():
        assert set(of["differences"]) == set(MODELS[name].estimators)
        assert presets.find(of["preset"]).model == name


@pytest.mark.parametrize("page", ["tutorial.md", "faq.md"])
def test_buttons_are_named_as_in_the_panel(page):
    """What stands in italics is a text of addon/ui, of a fix or of a quality, or Blender's own."""
    folders = (ROOT / "addon" / "ui", ROOT / "addon" / "choose")
    code = "\n".join(path.read_text(encoding="utf-8") for folder in folders for path in folder.glob("*.py"))
    texts = set(re.findall(r'f?"([^"\n]+)"', code)) | {"Allow 12 Bounces"} | {one.label for one in PARAMETERS.values()}
    text = re.sub(r"\s+", " ", (DOCS / page).read_text(encoding="utf-8"))
    named = set(re.findall(r"(?<!\*)\*([^*]+)\*(?!\*)", text))
    assert named
    assert named - texts - BLENDERS == set()


def test_the_job_of_the_tutorial_is_a_thousand_stills(tmp_path):
    (shown,) = re.findall(r"```toml\n(.*?)```", (DOCS / "tutorial_batch.md").read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "metals.toml").write_text(shown, encoding="utf-8")
    assert len(job.load(tmp_path / "metals.toml")) == 1000


@pytest.mark.once
@pytest.mark.blender
def test_the_notebook_gives_what_it_shows():
    """Its text; a picture may differ by a pixel."""
    notebook = load(ROOT / "tools" / "pages" / "notebook.py")
    path = DOCS / "tutorial_research.ipynb"

    def texts(cells):
        return [[one.get("text") for one in cell.outputs] for cell in cells if cell.cell_type == "code"]

    shown = texts(notebook.nbformat.read(path, as_version=4).cells)
    assert len(shown) == 5
    assert texts(notebook.run(path).cells) == shown
