# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender is prepared before anything imports it; each Blender test starts from an empty file.

A test that renders a grid of rows (models, estimators, backends, slopes, ...) is run on some of them, chosen so that
each value is in one of them at least: what breaks mostly does so for one value. ``--cover 2`` holds each pair of
values of two parameters too. Grids without Blender hold each pair on 5.2; on 4.5, whose Python and NumPy are older
too, each value, and on 5.3, which has those of 5.2, they are left out. What takes long and hardly depends on Blender,
and deliberate errors, which show that a check can fail, are marked ``once`` and run on 5.2 alone, by `make test-once`;
what is more of the same is marked ``more``. On 5.2 `make test` also leaves the tests of data/slow.txt to `make
test-once`, so that it ends within ten minutes.

``--rotate 2026-12-01`` adds a seventh of what is left out, another one each day: seven nights of `make test-all` run
every row on every Blender, and `make test-every` does so at once (``--cover 0``).
"""

import contextlib
import sys
import zlib
from datetime import date
from functools import partial
from itertools import combinations
from pathlib import Path

import numpy as np
import psutil
import pytest

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - prepare() must come first

from vgroove.addon.blender import gonio, images  # noqa: E402
from vgroove.batch.outcome import RECORD, read_record  # noqa: E402
from vgroove.batch.task import Renderer  # noqa: E402
from vgroove.headless import scene  # noqa: E402
from vgroove.lab.report.findings import DEFAULT  # noqa: E402
from vgroove.nodegroups import versions  # noqa: E402

collect_ignore = ["window", "page"]  # need Debian's Blender and Chromium: `make test-window` and `make test-page`
NIGHTS = 7  # in which --rotate comes round
SLOW = frozenset(Path(__file__).parent.joinpath("data", "slow.txt").read_text(encoding="utf-8").splitlines())
PIXELS, SAMPLES, SPACING = 16, 16, 2.5  # of a tile with a ball of radius 1


def pytest_addoption(parser):
    text = "rows of Blender tests: 0 all, 1 each value once at least, 2 each pair of values"
    parser.addoption("--cover", type=int, choices=(0, 1, 2), default=1, help=text)
    text = "beside those rows a seventh of the others, by this date, as in 2026-12-01; another seventh the next day"
    parser.addoption("--rotate", type=date.fromisoformat, metavar="DATE", help=text)
    parser.addoption("--write", action="store_true", help="write the table of test_revisions.py")


def pytest_report_header(config):
    day = config.getoption("--rotate")
    return f"rows by date: --rotate {day}, part {day.toordinal() % NIGHTS + 1} of {NIGHTS}" if day else None


def pytest_itemcollected(item):
    if item.nodeid in SLOW:
        item.add_marker("slow")


def pytest_collection_modifyitems(config, items):
    strength, rows = config.getoption("--cover"), {}
    default, python = versions.version() == DEFAULT, sys.version_info >= (3, 13)
    marks = ("more",) if default else ("more", "once")
    left = {item for item in items if strength and any(map(item.get_closest_marker, marks))}
    if strength and not default and python:
        left |= {item for item in items if not item.get_closest_marker("blender")}
    for item in items:
        if strength and item not in left and hasattr(item, "callspec"):
            least = 2 if default and not item.get_closest_marker("blender") else 1
            rows.setdefault((item.path, item.originalname, max(strength, least)), []).append(item)
    kept = {item for (*_, values), of in rows.items() for item in covering(of, values)}
    left |= {item for of in rows.values() for item in of} - kept
    if (day := config.getoption("--rotate")) is not None:
        left = {item for item in left if zlib.crc32(item.nodeid.encode()) % NIGHTS != day.toordinal() % NIGHTS}
    if left:
        config.hook.pytest_deselected(items=list(left))
        items[:] = [item for item in items if item not in left]


def covering(rows, strength):
    """Rows that hold all that any holds: values, or pairs of them; each time the one that holds most of the rest."""
    holds = {}
    for row in rows:
        values = list(enumerate(_values(row.callspec.params.values())))
        holds[row] = set(combinations(values, min(strength, len(values))))
    wanted = set().union(*holds.values())
    while wanted:
        best = max(rows, key=lambda row: len(holds[row] & wanted))
        yield best
        wanted -= holds[best]


def _values(parameters):
    """The values of a row as text; those of a tuple one by one."""
    for one in parameters:
        if isinstance(one, tuple | list):
            yield from _values(one)
        elif isinstance(one, partial):  # a row of ``vgroove check``
            yield from _values((one.func, *one.args, *filter(None, [one.keywords])))
        else:
            yield getattr(one, "__name__", None) or repr(one)


@pytest.fixture
def blender():
    """Bpy with an empty file, and its chatter kept off the terminal."""
    _empty_file()
    yield bpy
    _empty_file()


def _empty_file():
    """Not by factory settings, which read preferences and add-ons anew and take five times as long."""
    with headless.quiet():
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


@pytest.fixture
def instrument():
    """Blender for measurements, which leave the file as it was: node groups stay, as building them takes longer."""
    return bpy


@pytest.fixture
def empty_material(blender):
    """A function that makes a material with an empty tree on either Blender."""

    def make(name="Test"):
        material = versions.empty_material(name)
        material.cycles.emission_sampling = "NONE"
        return material

    return make


@pytest.fixture
def balls(blender):
    """A function that renders a ball of each material below a sky: (balls, pixels within the ball, 3).

    The materials come from a function that is given the scene; the sky is white, or white above the horizon or below.
    """
    across = (np.arange(PIXELS) + 0.5) * SPACING / PIXELS - SPACING / 2.0
    within = np.hypot(*np.meshgrid(across, across)) < 0.95

    def render(make, *, osl=False, lit="all", samples=SAMPLES, seed=0):
        mesh = scene.ball_mesh(32, 16)
        mesh.materials.append(None)
        with headless.quiet(), gonio.stage((PIXELS, PIXELS), samples=samples, seed=seed, shading_osl=osl) as stage:
            gonio.light(stage, gonio.Geometry(furnace=True, lit=lit))
            sky = stage.world.cycles  # as quick_sky has it
            sky.sampling_method, sky.sample_map_resolution = "MANUAL", 512
            made = make(stage)
            side = int(np.ceil(np.sqrt(len(made))))
            stage.render.resolution_x = stage.render.resolution_y = PIXELS * side
            for index, material in enumerate(made):
                item = blender.data.objects.new("Ball", mesh)
                item.material_slots[0].link = "OBJECT"
                item.material_slots[0].material = material
                item.location = (SPACING * (index % side), -SPACING * (index // side), 0.0)
                stage.collection.objects.link(item)
            middle = SPACING * (side - 1) / 2.0
            gonio.look_down(stage, SPACING * side, (middle, -middle, 9.0))
            image = gonio.rendered(stage)
        tiles = image.reshape(side, PIXELS, side, PIXELS, 3).transpose(0, 2, 1, 3, 4)
        return tiles.reshape(side * side, PIXELS, PIXELS, 3)[: len(made), within]

    return render


@pytest.fixture
def quick_sky(monkeypatch):
    """Have Cycles sample environment maps by 512 x 256 cells: with its own choice each render takes 1.4 s more."""

    def light_by(shown, *given, real=scene.light_by):
        real(shown, *given)
        shown.world.cycles.sampling_method, shown.world.cycles.sample_map_resolution = "MANUAL", 512

    monkeypatch.setattr(scene, "light_by", light_by)


@pytest.fixture
def bare_scene(blender, tmp_path):
    """A folder with bare.blend, which opens and renders at once: the preview scene in the dark but for its sun."""
    with headless.quiet():
        shown = scene.preview()
        shown.world = None
        blender.ops.wm.save_as_mainfile(filepath=str(tmp_path / "bare.blend"))
    return tmp_path


@pytest.fixture
def same_as_quiet(blender, tmp_path):
    """A function that checks that pictures are those of tasks as one process renders them that nobody disturbs."""

    def check(pictures, tasks):
        record = read_record(images.attribute(pictures[0], RECORD))
        renderer = Renderer(tmp_path / "quiet", record["versions"])
        renderer.folder.mkdir()
        with headless.quiet():
            paths = [renderer.folder / f"{renderer.render(task).name}.exr" for task in tasks]
        wanted, found = ({path.name: images.load(path).tobytes() for path in of} for of in (paths, pictures))
        assert len(set(wanted.values())) == len(tasks)
        assert found == wanted

    return check


@pytest.fixture
def family():
    """A function that lists the processes below one that have a word in their command lines."""

    def find(pid, word=""):
        found = []
        try:
            for one in psutil.Process(pid).children(recursive=True):
                with contextlib.suppress(psutil.Error):  # it ended meanwhile
                    found += [one] * (word in " ".join(one.cmdline()))
        except psutil.NoSuchProcess:
            pass
        return found

    return find
