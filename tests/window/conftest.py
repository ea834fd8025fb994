"""A Blender with a window, set up once; the extension from this folder's zip, with its asset library."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


def load(path):
    """A script of tools/, under its own name."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = sys.modules[path.stem] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def window():
    """A Blender with a window; where its system cannot be set up, an error of one line, not a skip."""
    machine = load(ROOT / "tools" / "window" / "machine.py")
    try:
        machine.set_up()
    except machine.UnavailableError as error:
        pytest.exit(str(error), returncode=3)
    return load(ROOT / "tools" / "window" / "session.py")


@pytest.fixture(scope="session")
def session(window, tmp_path_factory):
    """With the extension installed."""
    installed = window.Session("tests")
    package = load(ROOT / "tools" / "package.py")
    installed.install(package.package(tmp_path_factory.mktemp("dist")))
    if not (installed.extension / "assets").exists():  # a zip without the library, which `make package` adds
        assets = [sys.executable, str(ROOT / "tools" / "assets.py"), str(installed.extension / "assets")]
        subprocess.run(assets, check=True)
    return installed


@pytest.fixture
def run(session):
    """A function that runs a scenario of ``steps_*.py`` in the window and returns what it noted."""

    def play(path, name, settings="with"):
        return session.run(HERE / f"{path}.py", name, settings)

    return play
