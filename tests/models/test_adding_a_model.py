# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/adding_a_model.md is enough: its files, written into a copy of the repository, are a model that passes."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.blender, pytest.mark.once]

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "adding_a_model.md"
ROOMS = ("addon", "batch", "cli", "headless", "lab", "nodegroups", "osl", "presets", "tests", "viewer")
FILES = ("__init__.py", "blender_manifest.toml", "pyproject.toml")


def files():
    """{path: content} of every file that the page shows."""
    text = PAGE.read_text(encoding="utf-8")
    return dict(re.findall(r"^`([\w/.]+)`\n\n```\w+\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL))


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The package beside this one, with the model of the page."""
    root = tmp_path_factory.mktemp("copy") / "vgroove"
    for room in ROOMS:
        shutil.copytree(ROOT / room, root / room, ignore=shutil.ignore_patterns("__pycache__"))
    for name in FILES:
        shutil.copy(ROOT / name, root / name)
    for name, content in files().items():
        assert not (root / name).exists(), f"{name} is there already"
        (root / name).write_text(content, encoding="utf-8")
    return root


def run(copy, *command):
    """Standard output of a Python that imports the copy; what went wrong is the failure."""
    environment = os.environ | {"PYTHONPATH": str(copy.parent)}
    done = subprocess.run(
        [sys.executable, *command], cwd=copy, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
    return done.stdout


def test_the_model_of_the_page_passes_the_generic_tests(copy):
    """Values, samples, albedo, file, sockets, both backends, rows of the quick plan: all of test_registry.py."""
    tests = ("tests/models/test_registry.py", "-k", "minnaert or quick_plan")
    found = run(copy, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests)
    passed = int(re.search(r"(\d+) passed", found)[1])
    assert passed >= 10


def test_the_model_of_the_page_renders_by_its_formula(copy):
    """``direct`` in Cycles, by nodes and by OSL, is the reference to float32's rounding; a preset of it is found."""
    found = run(copy, "-c", MEASURE)
    assert all(float(error) < 2e-5 for error in found.split())  # the bar of ``direct``: lab/check
    assert len(found.split()) == 2


def test_the_quick_plan_checks_the_model_of_the_page(copy):
    """A row of each estimator, which passes, and would not of a reference 1 % brighter."""
    assert run(copy, "-c", CHECK).splitlines() == ["closure True False", "direct True False"]


CHECK = """
from vgroove import headless
headless.prepare()
from vgroove.lab.check import plan
rows = [row() for row in plan.quick_plan() if row.func.__module__ == "vgroove.lab.check.minnaert"]
for row in rows:
    print(row.test, row.passed, row.scaled(1.01).passed)
"""

MEASURE = """
import numpy as np
from vgroove import headless
headless.prepare()
from vgroove.addon.blender import gonio
from vgroove.addon.library.presets import parse
text = 'name = "Moon"\\nmodel = "minnaert"\\nalbedo = 0.12\\nlimb = 1.4\\n[source]\\ndata = "test"'
preset, geometry = parse(text, "test/moon", "moon.toml"), gonio.Geometry(40.0)
expected = preset.reference().evaluate(geometry.wi(), geometry.wo())
for backend in ("nodes", "osl"):
    with headless.quiet():
        image = gonio.measure_preset(preset, backend, "direct", geometry, shading_osl=backend == "osl")
    print(np.max(np.abs(image - expected)) / expected.max())
"""
