# SPDX-License-Identifier: GPL-3.0-or-later
"""The site in Chromium, opened as files: it fits, asks no network, and both searches find."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_spec = importlib.util.spec_from_file_location("browser", ROOT / "tools" / "browser.py")
browser = sys.modules["browser"] = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(browser)

WAIT = """const until = async (test) => {
  for (let k = 0; !test() && k < 400; k += 1) await new Promise((go) => setTimeout(go, 50));
};"""
ELSEWHERE = "return performance.getEntriesByType('resource').map((e) => e.name).filter((n) => !/^(file|data):/.test(n))"


@pytest.fixture(scope="module")
def visit(tmp_path_factory):
    """Opens a page of the site, built for this."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, env=os.environ | {"NO_MKDOCS_2_WARNING": "1"})
    try:
        running = browser.Browser(tmp_path_factory.mktemp("profile"))
    except browser.UnavailableError as error:
        pytest.exit(str(error), returncode=3)

    def go(page, *look, fragment=""):
        running.visit((folder / page).as_uri() + fragment, *look)
        return running

    yield go
    running.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (420, 900)])
@pytest.mark.parametrize("page", ["index.html", "models/cook_torrance.html", "catalogue.html", "lecture.html"])
def test_it_fits_and_asks_no_network(visit, page, size, scheme):
    """And it is as light or dark as the system."""
    opened = visit(page, size, scheme)
    assert opened.run("return document.documentElement.scrollWidth") <= size[0]
    assert opened.run(ELSEWHERE) == []
    shown = "(document.body.dataset.mdColorScheme === 'slate')"
    assert opened.run(f"{WAIT} await until(() => {shown} === {str(scheme == 'dark').lower()}); return {shown}") == (
        scheme == "dark"
    )
    broken = "return [...document.images].filter((i) => i.complete && !i.naturalWidth).map((i) => i.src)"
    assert opened.run(broken) == []


def test_the_catalogue_finds_what_its_address_says(visit):
    """Every word has to be there; families without a row disappear."""
    opened = visit("catalogue.html", fragment="#gold%20satin")
    shown = "return [...document.querySelectorAll('#presets tr[data-words]')].filter((r) => !r.hidden)"
    rows = opened.run(shown + ".map((r) => r.dataset.words)")
    assert 0 < len(rows) < 20
    assert all("gold" in row and "satin" in row for row in rows)
    assert (
        opened.run("location.hash = '#nothing-like-it'; await new Promise((go) => setTimeout(go, 50));" + shown) == []
    )
    assert opened.run("return document.getElementById('found').textContent").startswith("No match")


def test_the_themes_search_works_without_a_server(visit):
    """By static/iframe-worker.js."""
    opened = visit("index.html")
    found = opened.run(
        WAIT
        + """const field = document.querySelector('.md-search__input');
        field.focus(); field.value = 'grazing';
        field.dispatchEvent(new Event('keyup', { bubbles: true }));
        const items = () => document.querySelectorAll('.md-search-result__item').length;
        await until(items); return items();"""
    )
    assert found >= 5
