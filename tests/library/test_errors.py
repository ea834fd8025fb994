# SPDX-License-Identifier: GPL-3.0-or-later
"""One base of errors: what a user can mend is an InputError, in whatever room it is raised."""

import ast
from pathlib import Path

import pytest

from vgroove import cli
from vgroove.addon.library.errors import InputError
from vgroove.addon.library.files import FileError

ROOT = Path(__file__).parent.parent.parent
ROOMS = ("addon", "nodegroups", "headless", "lab", "batch", "cli")
LOST_PROCESSES = {"LostError", "PeerError"}  # no fault of the input


def test_errors_derive_from_the_one_base():
    """All that the package defines, read from the source: some need Blender to be imported."""
    bases = {
        node.name: {base.id for base in node.bases if isinstance(base, ast.Name)}
        for room in ROOMS
        for path in (ROOT / room).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef) and node.name.endswith("Error") and node.bases
    }
    ours = {"InputError"}
    while grown := {name for name, of in bases.items() if of & ours} - ours:
        ours |= grown
    assert {"PresetError", "MaterialError", "SceneError", "OslError", "JobError", "FileError"} < ours
    assert set(bases) - ours <= LOST_PROCESSES


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (InputError("choose another"), 2),
        (FileError("choose another"), 2),
        (FileNotFoundError("choose another"), 2),
        (OSError(28, "choose another"), 3),  # no space left
        (RuntimeError("choose another"), 3),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, Exception) else "",
)
def test_the_command_line_knows_what_is_the_users_to_mend(error, code, capsys):
    """Exit code 2 for it, 3 for a machine that fails; one line."""

    def command():
        raise error

    assert cli.run(command) == code
    said = capsys.readouterr().err
    assert said.startswith("vgroove: ")
    assert "choose another" in said
    assert said.count("\n") == 1


def test_a_fault_of_ours_is_no_line_but_a_traceback():
    """A ValueError that is no InputError must not pass for bad input."""

    def command():
        message = "broadcast"
        raise ValueError(message)

    with pytest.raises(ValueError, match="broadcast"):
        cli.run(command)
