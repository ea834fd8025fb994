# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured BRDFs are imported as presets of one's own: at once, or after a look at both forms."""

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest
from PIL import Image

from vgroove import headless
from vgroove.addon.choose.compare import FIT, TABLE, Compared
from vgroove.addon.library import presets
from vgroove.addon.measured import tabulate, write_merl
from vgroove.addon.measured.as_preset import Source
from vgroove.addon.reference import CookTorrance, Lambert, Schlick, Sum

from ..measured.makers import utia_bytes
from .panel import drawn

pytestmark = pytest.mark.blender
RED = Sum(Lambert([0.8, 0.1, 0.05]), CookTorrance(0.2, Schlick(0.4)), 0.6, 0.3)
# In place of Blender: what a comparison leaves in its folder.
FILES = """
import pathlib, shutil, sys
folder = pathlib.Path(sys.argv[2])
for path in pathlib.Path(sys.argv[1]).iterdir():
    shutil.copy(path, folder)
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("measured") / "Red Paint.binary"
    write_merl(path, tabulate(RED.evaluate))
    return path


@pytest.fixture
def bring(extension, own_folder, file):
    """The operator, as a script calls it."""

    def call(**options):
        with headless.quiet():
            return extension.ops.vgroove.import_measured(**{"filepath": str(file)} | options)

    return call


def test_the_table_becomes_a_preset_with_a_copy(bring, extension, own_folder, file):
    """It is chosen, names the copy, and is applied if asked; a second one gets another name and the same copy."""
    cube = extension.context.object
    assert bring(form="table", apply=True) == {"FINISHED"}
    of = presets.find("mine/red_paint")
    assert of.table.file == str(own_folder / f"red_paint_{of.table.sha256[:8]}.binary")
    assert (own_folder / of.table.file).read_bytes() == file.read_bytes()
    assert extension.context.scene.vgroove.preset == of.id
    assert cube.active_material.name.startswith("Red Paint")
    assert bring(form="table", copy_table=False) == {"FINISHED"}
    assert presets.find("mine/red_paint_2").table.file == str(file)
    assert len(list(own_folder.iterdir())) == 3


def test_a_fit_says_how_near_it_comes(bring, capfd):
    """In the report, at 45 degrees; its numbers are those that the table was made of."""
    with pytest.MonkeyPatch.context() as patch:
        said = []
        patch.setattr(
            "vgroove.addon.ui.measured.keep",
            lambda _self, _context, preset, says: said.append((preset, says)) or {"FINISHED"},
        )
        assert bring(form="fit", lobes=1) == {"FINISHED"}
    ((preset, says),) = said
    assert says.startswith("differs by 0.")
    assert " % of the light at 45 degrees" in says
    assert preset.m == pytest.approx(0.2, rel=0.01)


@pytest.mark.parametrize("form", ["table", "fit", "compare"])
def test_a_bad_file_is_refused_in_one_line(bring, own_folder, file, tmp_path_factory, form):
    """No measured BRDF, a missing one, and an anisotropic one; nothing is written."""
    folder = tmp_path_factory.mktemp("bad")
    (folder / "a.bin").write_bytes(utia_bytes(Lambert(0.5).evaluate))
    (folder / "b.binary").write_bytes(file.read_bytes()[:-8])
    for name, says in (("a.bin", "is anisotropic"), ("b.binary", "is cut off"), ("c.binary", "No such file")):
        with pytest.raises(RuntimeError, match=says) as raised:
            bring(form=form, filepath=str(folder / name))
        assert len(str(raised.value).strip().splitlines()) == 1
    assert list(own_folder.iterdir()) == []


def test_it_is_a_line_of_file_import(extension):
    from vgroove.addon.ui import measured

    assert measured._draw_import in extension.types.TOPBAR_MT_file_import._dyn_ui_initialize()


# --- both forms ---------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def compared(file, tmp_path_factory):
    """A folder as the other Blender leaves it, but for the pictures, which are plain."""
    of = Compared(tmp_path_factory.mktemp("compared"))
    of.write(Source.read(file), 1, "cook_torrance")
    for form in (TABLE, FIT):
        Image.new("RGB", (8, 8)).save(of.picture(form))
    return of.folder


def work(measured):
    """Calls the timer's function as Blender does, until it has ended."""
    end = time.monotonic() + 60.0
    while measured._look() is not None:
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.mark.once
def test_the_other_blender_makes_both(file, tmp_path):
    """By its script alone. Where the ball is lit: the fit is near, so means differ by less than 5 of 255; it is red."""
    from vgroove.addon.ui import background, measured

    script = "import sys; sys.modules['vgroove'] = None\n" + background.script(measured.MODULE)
    line = [sys.executable, "-c", script, "--", str(file), str(tmp_path), "1", "cook_torrance"]
    path = os.environ | {"PYTHONPATH": str(Path(OpenImageIO.__file__).parents[1])}  # which Blender's own Python has
    done = subprocess.run(line, env=path, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    of = Compared(tmp_path)
    assert of.says.startswith("differs by")
    table, fit = (np.asarray(Image.open(of.picture(form)).convert("RGB"), float) for form in (TABLE, FIT))
    a, b = (one[60:160, 90:170].mean(axis=(0, 1)) for one in (table, fit))
    assert np.abs(a - b).max() < 5.0
    assert a[0] > a[1] + 50.0


def test_the_panel_shows_both_and_one_is_kept(bring, extension, own_folder, compared, monkeypatch):
    """The fit's residual stands below; what is kept is saved and chosen, and stays when the comparison is closed."""
    from vgroove.addon.ui import measured

    monkeypatch.setattr(
        measured, "command", lambda _path, folder, *_: [sys.executable, "-c", FILES, str(compared), str(folder)]
    )
    assert bring() == {"FINISHED"}
    assert "background" in " ".join(drawn(extension, measured.VGROOVE_PT_measured).texts)
    with pytest.raises(RuntimeError, match="Import a measured BRDF first"):
        extension.ops.vgroove.keep_measured(form="fit")
    work(measured)
    shown = drawn(extension, measured.VGROOVE_PT_measured)
    assert "differs by" in " ".join(shown.texts)
    assert [text for name, text in shown.buttons if name == "vgroove.keep_measured"] == ["Add", "Add and Apply"] * 2
    with headless.quiet():
        assert extension.ops.vgroove.keep_measured(form="fit", apply=True) == {"FINISHED"}
        assert extension.ops.vgroove.keep_measured(form="table") == {"FINISHED"}
    assert presets.find("mine/red_paint_fit").parameters["m_1"] == pytest.approx(0.2, rel=0.01)
    assert presets.find("mine/red_paint").table.file.startswith(str(own_folder))
    folder = measured._compared[0].folder
    assert extension.ops.vgroove.close_measured() == {"FINISHED"}
    assert not folder.exists()
    assert len(list(own_folder.iterdir())) == 3


def test_what_goes_wrong_in_the_background_is_shown(bring, extension, monkeypatch):
    """The last line of the other Blender; and one that still runs is ended with the extension."""
    from vgroove.addon.ui import measured

    line = [sys.executable, "-c", "raise OSError('disk full')"]
    monkeypatch.setattr(measured, "command", lambda *_: line)
    bring()
    work(measured)
    assert "disk full" in " ".join(drawn(extension, measured.VGROOVE_PT_measured).texts)
    line[-1] = "import time; time.sleep(60)"
    bring()
    (of,) = measured._compared
    measured.close()
    assert not of.job.is_running
    assert not of.folder.exists()


def test_blender_as_a_module_compares_nothing(bring):
    with pytest.raises(RuntimeError, match="no background"):
        bring(form="compare")
