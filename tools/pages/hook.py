# SPDX-License-Identifier: GPL-3.0-or-later
"""What the site has beside docs/: README as its front page, models, presets, docstrings, the viewer's page, formulas.

mkdocs calls the functions whose names begin with ``on_``.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import catalogue
import models
import notebook
from latex2mathml.converter import convert
from mkdocs.structure.files import File, Files

from vgroove.addon.library import presets
from vgroove.addon.models import MODELS
from vgroove.viewer import page as viewer

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
STATIC = Path(__file__).parent / "static"
LECTURE = {"Cook-Torrance": "lecture/cook_torrance_brdf_viewer", "Ward": "lecture/ward_brdf_viewer"}
API = {
    "reference": ("Models in NumPy", "vgroove.addon.reference"),
    "library": ("Presets", "vgroove.addon.library"),
    "measured": ("Measured BRDFs", "vgroove.addon.measured"),
    "plots": ("Plots", "vgroove.lab.plots"),
}
FORMULA = re.compile(r"\$\$(.+?)\$\$|(?<![\w$])\$([^$\n]+?)\$(?!\w)", re.DOTALL)
CODE = re.compile(r"(```.*?```|`[^`\n]*`)", re.DOTALL)
MARK = re.compile(r"<!-- /?report.*?-->")  # where a line begins with one, Markdown would begin a block
HELD = "formula@{}@"  # in the text until it is HTML, as Markdown would read into MathML


def on_startup(**_: Any) -> None:
    """The package by its name, for the docstrings: what of this folder is part of it."""
    package = ROOT / ".cache" / "pages" / "vgroove"
    package.mkdir(parents=True, exist_ok=True)
    for name in ("__init__.py", "addon", "lab"):
        if not (package / name).is_symlink():
            (package / name).symlink_to(ROOT / name)


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """The registry's models in the navigation."""
    for entry in config.nav or ():
        if "Models" in entry:
            entry["Models"] = ["models/index.md", *({of.label: f"models/{name}.md"} for name, of in MODELS.items())]
    return config


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Beside what docs/ holds."""
    for source, content in made():
        if (old := files.get_file_from_path(source)) is not None:
            files.remove(old)
        files.append(File.generated(config, source, content=content))
    return files


def made() -> Iterator[tuple[str, str | bytes]]:
    """The pages and files that are made, by their place in the site."""
    for name in ("README", "CONTRIBUTING", "CHANGELOG"):
        text = (ROOT / f"{name}.md").read_text(encoding="utf-8")
        yield "index.md" if name == "README" else f"{name.lower()}.md", moved(text)
    for path in STATIC.iterdir():
        yield f"static/{path.name}", path.read_bytes()
    for path in (ROOT / "docs").glob("*.ipynb"):
        yield f"{path.stem}.md", notebook.as_markdown(path)
    yield from models.pages(ROOT)
    yield from catalogue.pages(ROOT)
    yield from _api()
    yield "lecture.md", _lecture()
    yield "static/lecture.html", viewer.page([(name, presets.find(of)) for name, of in LECTURE.items()])


def moved(text: str) -> str:
    """A page of the repository's top folder, with its links as they are from the site's."""
    text = re.sub(r"\]\(docs/", "](", text)
    return re.sub(r"\]\((README|CONTRIBUTING|CHANGELOG)\.md", lambda m: f"]({PLACES[m[1]]}", text)


PLACES = {"README": "index.md", "CONTRIBUTING": "contributing.md", "CHANGELOG": "changelog.md"}


def _api() -> Iterator[tuple[str, str]]:
    """A page for each part of the API, with the docstrings of its modules."""
    for name, (title, module) in API.items():
        folder = ROOT / Path(*module.split(".")[1:])
        found = [f"{module}.{path.stem}" for path in sorted(folder.glob("[!_]*.py"))] if folder.is_dir() else [module]
        parts = [f"## {one.rpartition('.')[2]}\n\n::: {one}\n    options: {{heading_level: 3}}" for one in found]
        start = f"# {title}\n\n`{module}`, by its docstrings. Conventions are on the [front page](../index.md).\n\n"
        yield f"api/{name}.md", start + "\n\n".join(parts) + "\n"


def _lecture() -> str:
    return (
        "# The lecture's BRDFs\n\nThe two materials of the lecture's BRDF viewer, Cook and Torrance's model and "
        "Ward's, as `vgroove view` shows them. [viewer.md](viewer.md) says what each part shows. "
        '<a href="static/lecture.html">Open it alone</a>.\n\n'
        '<iframe class="viewer" src="static/lecture.html" title="Lobes, slices and albedo"></iframe>\n'
    )


def on_page_markdown(text: str, *, page: Page, **_: Any) -> str:
    """Lists as forges indent them; formulas of pages that have some are held back until the page is HTML."""
    text = _indented(MARK.sub("", text))
    found: list[str] = []

    def hold(match: re.Match[str]) -> str:
        block = match[1] is not None
        formula = convert((match[1] or match[2]).strip(), display="block" if block else "inline")
        found.append(f'<span class="formula">{formula}</span>' if block else formula)
        return HELD.format(len(found) - 1)

    if page.file.src_uri == "paper.md" or page.file.src_uri.startswith("models/"):
        pieces = CODE.split(text)
        pieces[::2] = [FORMULA.sub(hold, piece) for piece in pieces[::2]]
        text = "".join(pieces)
    page.meta["formulas"] = found
    return text


def on_page_content(text: str, *, page: Page, **_: Any) -> str:
    for number, formula in enumerate(page.meta.get("formulas", ())):
        text = text.replace(HELD.format(number), formula)
    return text


def _indented(text: str) -> str:
    """Two or three spaces below a list's item are four to this Markdown, and a list begins after an empty line."""
    lines, fenced, before = [], False, ""
    for line in text.split("\n"):
        fenced ^= line.lstrip().startswith("```")
        if not fenced and re.match(r" {2,3}\S", line):
            line = "    " + line.lstrip()  # noqa: PLW2901
        is_item = re.match(r"(?:[-*]|\d+\.) ", line)
        if not fenced and is_item and before and not re.match(r"(?:[-*]|\d+\.) |    ", before):
            lines.append("")
        lines.append(line)
        before = line
    return "\n".join(lines)
