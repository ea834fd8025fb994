# SPDX-License-Identifier: GPL-3.0-or-later
"""What `make demo` prints at its end works as it is printed."""

import importlib.util
import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.blender

ROOT = Path(__file__).parents[2]


@pytest.mark.once
def test_the_command_that_the_demo_names_runs(monkeypatch, tmp_path):
    """In the folder where the demo ran, without uv: here with less to render, and the picture elsewhere."""
    monkeypatch.chdir(ROOT)
    spec = importlib.util.spec_from_file_location("demo", ROOT / "tools" / "demo.py")
    demo = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(demo)
    line, _, name = demo.next_command().rpartition(" ")
    assert not line.startswith("/")
    picture = tmp_path / name
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)}
    done = subprocess.run(
        ["sh", "-c", f"{line} {picture} --samples 1 --resolution 8x8"],
        env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert picture.is_file()
