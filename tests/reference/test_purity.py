# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference and the presets run without Blender: in a fresh process that refuses bpy, mathutils and SciPy."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
import subprocess
import sys

import pytest

from vgroove.addon import reference

BLOCKED = "import sys; sys.modules.update(dict.fromkeys(['bpy', 'mathutils', 'scipy', 'mpmath', 'rich', 'typer']))\n"
SUBMODULES = sorted(module.name for module in pkgutil.iter_modules(reference.__path__))


def run(program, before=BLOCKED):
    """Standard output of ``program`` in a fresh interpreter, after ``before``."""
    command = [sys.executable, "-W", "error", "-c", before + program]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_blocked_modules_cannot_be_imported():
    """The block itself works, or the tests below would show nothing."""
    printed = run("try:\n    import bpy\nexcept ImportError:\n    print('blocked')")
    assert printed.strip() == "blocked"


@pytest.mark.parametrize("name", ["vgroove", "vgroove.addon.reference", "vgroove.addon.library.presets"])
def test_pure_modules_import_without_blender(name):
    """They import where there is no Blender and no SciPy."""
    assert run(f"import {name}; print('done')").strip() == "done"


def test_reference_imports_numpy_and_nothing_else():
    """Beyond the standard library, importing all of the reference loads NumPy and vgroove, and of vgroove itself alone.

    Nothing is blocked here: an import of SciPy that is only tried would show as well.
    """
    program = (
        "before = set(sys.modules)\n"
        "import vgroove.addon.reference\n"
        f"for name in {SUBMODULES}:\n"
        "    __import__(f'vgroove.addon.reference.{name}')\n"
        "new = sorted(name for name in set(sys.modules) - before if sys.modules[name] is not None)\n"
        "tops = {name.split('.')[0] for name in new} - set(sys.stdlib_module_names)\n"
        "print(*sorted(tops))\n"
        "print(*(name for name in new if name.startswith('vgroove')))"
    )
    tops, own = run(program, before="import sys\n").splitlines()
    # NumPy 1.26's compiled parts leave modules of Cython's behind, which exist only in memory.
    assert [name for name in tops.split() if not name.lstrip("_").startswith("cython_")] == ["numpy", "vgroove"]
    expected = ["vgroove", "vgroove.addon", "vgroove.addon.reference"]
    assert sorted(own.split()) == expected + [f"vgroove.addon.reference.{name}" for name in SUBMODULES]


def test_reference_evaluates_without_blender():
    """A BRDF value, a sample and an albedo need nothing more at run time either."""
    program = (
        "from vgroove.addon.reference import CookTorrance, Schlick, albedo\n"
        "model = CookTorrance(0.3, Schlick(0.95))\n"
        "print(model.evaluate([0, 0, 1], [0, 0, 1])[0], model.sample([0, 0, 1], [0.5] * 4)[1][0], "
        "albedo(model, [0, 0, 1])[0])"
    )
    f, weight, energy = map(float, run(program).split())
    assert f == pytest.approx(0.95 / (4 * 3.141592653589793 * 0.09), rel=1e-14)
    assert 0.9 < weight <= 1.0
    assert 0.9 < energy <= 1.0


@pytest.mark.parametrize("name", ["", *SUBMODULES])
def test_reference_examples_in_docstrings_hold(name):
    """Doctests of every module of the reference."""
    module = importlib.import_module(f"{reference.__name__}.{name}".rstrip("."))
    assert doctest.testmod(module).failed == 0


def test_reference_has_examples_in_docstrings():
    """The search for doctests finds some, in the modules that define functions of the papers."""
    modules = {name: importlib.import_module(f"{reference.__name__}.{name}") for name in SUBMODULES}
    tried = {name: doctest.testmod(module).attempted for name, module in modules.items()}
    assert tried["distributions"] >= 2
    assert tried["fresnel"] >= 3
    assert tried["directions"] >= 1
    assert tried["model"] >= 1
