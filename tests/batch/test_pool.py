# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that are killed, stuck, greedy or interrupted: every task once, whole files, the pixels of a quiet run."""

import csv
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

from vgroove.addon.library.files import NODE
from vgroove.batch import child as batch_child
from vgroove.batch import pool
from vgroove.batch.job import parse
from vgroove.batch.task import Renderer
from vgroove.headless import memory
from vgroove.headless.pipe import LostError

pytestmark = pytest.mark.blender

VERSIONS = {"vgroove": "test"}
RENDERER = "vgroove.batch.child"  # in a process's command line
JOB = '[[render]]\nscene = "bare.blend"\n'
SMALL = JOB + 'samples = 2\nresolution = "24x16"\n'
STUCK = JOB + "samples = 16777216\n"


@pytest.fixture
def folder(bare_scene):
    """One with bare.blend and an empty folder "out"."""
    (bare_scene / "out").mkdir()
    return bare_scene


def limits(**changes):
    return pool.Limits(**{"workers": 2, "memory": 10**10} | changes)


def batch(job, folder, workers=2):
    """The command, begun in a session of its own."""
    (folder / "job.toml").write_text(job, encoding="utf-8")
    command = [str(Path(sys.executable).parent / "vgroove"), "batch", "job.toml", "-o", "out", f"--workers={workers}"]
    return subprocess.Popen(
        command,
        cwd=folder,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509 - which shells ignore behind an &
    )


def stills(folder):
    return sorted((folder / "out").glob("*.exr"))


def wait_for(condition, seconds=60.0):
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


def rows(folder):
    with (folder / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def check_whole(folder, same_as_quiet, tasks):
    """Every task's picture is there as one quiet process renders it, and nothing else."""
    same_as_quiet(stills(folder), tasks)
    assert {path.suffix for path in (folder / "out").iterdir()} <= {".exr", ".csv"}


@pytest.mark.once
def test_kills_cost_nothing(folder, same_as_quiet, family):
    """kill -9 of both processes, then of one more: each task once, as a quiet run has it."""
    tasks = parse(SMALL + f"seed = {list(range(12))}\n", "job", folder)
    found, kills = [], 0
    for outcome in pool.outcomes(tasks, folder / "out", VERSIONS, limits()):
        found.append(outcome)
        if len(found) % 2 and kills < 3:
            for one in family(os.getpid(), RENDERER)[: 3 - kills]:
                one.kill()
                kills += 1
    assert kills == 3
    assert {one.status for one in found} <= {"rendered", "there"}  # killed before it could say so
    assert sorted(one.name for one in found) == sorted(task.identity(VERSIONS) for task in tasks)
    check_whole(folder, same_as_quiet, tasks)


def test_a_process_that_is_killed_while_it_starts_is_started_again(folder, monkeypatch):
    """As often as ``STARTS``; one that ends of itself, as where there is no Blender, is not."""
    killed = [LostError("was killed")] * 2

    class Killed(batch_child.Child):
        def __init__(self, *arguments):
            if killed:
                raise killed.pop()
            super().__init__(*arguments)

    monkeypatch.setattr(pool, "Child", Killed)
    tasks = parse(SMALL + "seed = 1\n", "job", folder)
    (found,) = pool.outcomes(tasks, folder / "out", VERSIONS, limits(workers=1))
    assert (found.status, killed) == ("rendered", [])
    killed.append(LostError("no bpy", signalled=False))
    with pytest.raises(LostError, match="Blender does not start: no bpy"):
        list(pool.outcomes(tasks, folder / "again", VERSIONS, limits(workers=1)))


@pytest.mark.once
def test_a_task_that_is_stuck_is_set_aside_and_the_rest_goes_on(folder, same_as_quiet):
    """After three tries, with the reason."""
    tasks = parse(STUCK + SMALL + "seed = [0, 1, 2]\n", "job", folder)
    found = list(pool.outcomes(tasks, folder / "out", VERSIONS, limits(timeout=3.0)))
    assert sorted(one.status for one in found) == ["failed", "rendered", "rendered", "rendered"]
    stuck = next(one for one in found if one.status == "failed")
    assert (stuck.name, stuck.tries) == (tasks[0].identity(VERSIONS), 3)
    assert stuck.reason == "took longer than 3 s; give more with --timeout"
    check_whole(folder, same_as_quiet, tasks[1:])


@pytest.mark.once
def test_a_process_makes_room_for_a_new_one(folder, monkeypatch):
    """After so many tasks, or where it holds too much; tasks of one scene go to one process."""
    begun = []

    class Counted(batch_child.Child):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            begun.append(self.pid)

        def held(self):
            return 10**9

    monkeypatch.setattr(pool, "Child", Counted)
    tasks = parse(SMALL + f"seed = {list(range(3))}\n", "job", folder)
    for change, number, count in (({"recycle": 2}, 3, 2), ({"memory": 12 * 10**8}, 2, 2), ({}, 2, 1)):
        (folder / "out").mkdir(exist_ok=True)
        begun.clear()
        found = list(pool.outcomes(tasks[:number], folder / "out", VERSIONS, limits(workers=1, **change)))
        assert {one.status for one in found} == {"rendered"}
        assert len(begun) == count
        shutil.rmtree(folder / "out")


def test_what_a_process_may_hold_is_watched(folder, monkeypatch):
    """It is ended before the machine has no memory left, and the task says so."""
    monkeypatch.setattr(pool, "TRIES", 1)
    tasks = parse(STUCK, "job", folder)
    (found,) = pool.outcomes(tasks, folder / "out", VERSIONS, limits(memory=10**8))
    assert found.status == "failed"
    assert "took more memory than 100 MB; give more with --memory or fewer --workers" in found.reason


@pytest.mark.once
def test_a_full_disk_ends_the_work(folder):
    """As does anything else that keeps files from being written: one line, exit 3, nothing half written."""
    process = batch(SMALL + f"seed = {list(range(300))}\n", folder)
    wait_for(lambda: stills(folder))
    (folder / "out").rename(folder / "gone")
    (folder / "out").touch()
    errors = process.communicate(timeout=60)[1].splitlines()
    assert process.returncode == 3
    assert len([line for line in errors if not line.startswith("rendering")]) == 1, errors
    assert errors[-1].startswith("vgroove: ")


@pytest.mark.once
def test_what_a_killed_batch_left_is_finished(folder, same_as_quiet, family):
    """Kill -9 of the parent: its processes end too, and the same command renders the rest only."""
    job = SMALL + f"seed = {list(range(40))}\n"
    process = batch(job, folder)
    children = wait_for(lambda: family(process.pid, RENDERER))
    wait_for(lambda: len(stills(folder)) >= 5)
    process.kill()
    process.communicate()
    assert not psutil.wait_procs(children, timeout=10)[1]
    before = {path: path.stat().st_mtime_ns for path in stills(folder)}
    assert 5 <= len(before) < 40
    again = batch(job, folder, workers=1)
    errors = again.communicate(timeout=120)[1]
    assert again.returncode == 0, errors
    assert f"{len(before)} of them there already" in errors
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert sum(row["status"] == "there" and float(row["seconds"]) > 0.0 for row in rows(folder)) == len(before)
    check_whole(folder, same_as_quiet, parse(job, "job", folder))


@pytest.mark.once
def test_ctrl_c_stops_cleanly(folder, family):
    """Exit 130, one line, no process left, a table of what was done, and the same command goes on."""
    job = SMALL + f"seed = {list(range(200))}\n"
    process = batch(job, folder)
    children = wait_for(lambda: family(process.pid, RENDERER))
    wait_for(lambda: len(stills(folder)) >= 5)
    os.killpg(process.pid, signal.SIGINT)
    errors = process.communicate(timeout=20)[1].splitlines()
    assert process.returncode == 130
    assert errors[-1] == "vgroove: interrupted", errors
    assert not any("Traceback" in line for line in errors)
    assert not psutil.wait_procs(children, timeout=10)[1]
    done = [row for row in rows(folder) if row["status"] == "rendered"]
    assert {row["status"] for row in rows(folder)} == {"rendered", "left"}
    assert done
    assert len(done) <= len(stills(folder)) < 200
    assert not list((folder / "out").glob(".*"))


@pytest.mark.once
def test_two_batches_in_one_folder_do_not_harm_each_other(folder, same_as_quiet):
    """At once, each to the end."""
    job = SMALL + f"seed = {list(range(20))}\n"
    for process in [batch(job, folder, workers=1), batch(job, folder, workers=1)]:
        errors = process.communicate(timeout=120)[1]
        assert process.returncode == 0, errors
    assert len(rows(folder)) == 20
    check_whole(folder, same_as_quiet, parse(job, "job", folder))


def test_the_folder_that_one_stands_in_is_not_imported_from(folder, monkeypatch):
    """As Python does unless it is told otherwise."""
    (folder / "queue.py").write_text("raise SystemExit('of the current folder')\n", encoding="utf-8")
    monkeypatch.chdir(folder)
    (found,) = pool.outcomes(parse(SMALL, "job", folder), folder / "out", VERSIONS, limits())
    assert found.status == "rendered"


def test_a_scene_that_changed_meanwhile_is_not_taken_for_the_one_that_was_named(folder):
    tasks = parse(SMALL, "job", folder)
    with (folder / "bare.blend").open("ab") as file:
        file.write(b"\0")
    (found,) = pool.outcomes(tasks, folder / "out", VERSIONS, limits())
    assert (found.status, found.tries) == ("failed", 1)
    assert "has changed since the job was read" in found.reason
    (folder / "bare.blend").unlink()
    found = Renderer(folder / "out", VERSIONS).attempt(tasks[0])
    assert found.status == "failed"
    assert found.reason == f"{folder / 'bare.blend'}: cannot be read here"


def test_a_container_has_what_it_was_given(tmp_path, monkeypatch):
    """Where it was given less than the machine has left."""
    monkeypatch.setattr(memory, "_GROUP", tmp_path)
    whole = psutil.virtual_memory().available
    for most, expected in (("3000000", 2_000_000), ("1", 0), ("max", None), (str(10**18), None)):
        (tmp_path / "memory.max").write_text(most)
        (tmp_path / "memory.current").write_text("1000000\n")
        assert memory.free() == (pytest.approx(whole, rel=0.5) if expected is None else expected)


def test_what_was_killed_with_its_parent_is_swept(tmp_path, monkeypatch):
    """Folders of processes whose parent is gone, and no others."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    gone, here, other = (tmp_path / f"vgroove-{name}" for name in (f"{2**22 + 1}-abc", f"{os.getpid()}-abc", "abc"))
    for path in (gone, here, other):
        path.mkdir()
    batch_child.sweep_scratch()
    assert sorted(tmp_path.iterdir()) == sorted([here, other])


def test_what_old_processes_left_half_written_is_swept(tmp_path):
    """But not what someone may still write, nor files of others."""
    old, new, other = (
        tmp_path / name
        for name in (f".{'a' * 32}.77-{NODE}.exr", f".{'b' * 32}.78-{NODE}.exr", f".notes.77-{NODE}.txt")
    )
    for path in (old, new, other):
        path.touch()
    for path in (old, other):
        os.utime(path, (1e9, 1e9))
    batch_child.sweep(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted([new, other])
    batch_child.sweep(tmp_path, 78)
    assert list(tmp_path.iterdir()) == [other]


def test_the_machine_decides_what_is_not_given():
    """As many processes as cores and memory allow and tasks need."""
    free = memory.free()
    assert pool.limits(1).workers == 1
    assert pool.limits(1000).workers in range(1, pool.cores() + 1)
    assert pool.limits(1000, memory=int(free * 0.7)).workers == 1
    given = pool.limits(1000, workers=7)
    assert (given.workers, given.threads) == (7, max(1, pool.cores() // 7))
    np.testing.assert_allclose(given.memory, free / 7, rtol=0.5)
