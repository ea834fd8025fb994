# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks beyond one machine: an OpenJD template that openjd-cli runs, and a Dask scheduler with workers, on loopback."""

import csv
import json
import random
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest

from vgroove.batch import cluster as cluster_of_tasks
from vgroove.batch import openjd
from vgroove.batch.job import JobError, parse
from vgroove.batch.pool import Limits

pytestmark = [pytest.mark.blender, pytest.mark.once]

BIN = Path(sys.executable).parent
RENDERER = "vgroove.batch.child"  # in a process's command line
JOB = '[[render]]\nscene = "bare.blend"\nsamples = 2\nresolution = "24x16"\n'


@pytest.fixture
def folder(bare_scene):
    """One with bare.blend."""
    return bare_scene


def run(folder, *command, **options):
    process = subprocess.Popen(
        list(map(str, command)), cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options
    )
    said = process.communicate(timeout=240)[0]
    return process.returncode, said


def stills(folder):
    return sorted((folder / "out").glob("*.exr"))


def rows(folder):
    with (folder / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


# Open Job Description


def test_the_template_is_valid_and_a_farm_runs_it_in_pieces(folder, same_as_quiet):
    """By openjd's own model and command: 5 tasks, at first 2 in one go, then more as they are quick."""
    job = JOB + "seed = [0, 1, 2, 3, 4]\n"
    (folder / "stills.toml").write_text(job, encoding="utf-8")
    code, said = run(folder, BIN / "vgroove", "batch", "stills.toml", "-o", "out", "--openjd", "farm.json")
    assert code == 0, said
    assert not (folder / "out").exists()
    code, said = run(folder, BIN / "openjd", "check", "farm.json")
    assert code == 0, said
    given = ["-p", f"Command={BIN / 'vgroove'}", "-p", "Stills=2"]
    code, said = run(folder, BIN / "openjd", "run", "farm.json", *given)
    assert code == 0, said
    pieces = sorted(path.stem.removeprefix("results-") for path in (folder / "out").glob("*.csv"))
    assert pieces[0] == "1-2"
    assert pieces[-1].endswith("-5")
    same_as_quiet(stills(folder), parse(job, "job", folder))
    template = json.loads((folder / "farm.json").read_text(encoding="utf-8"))
    files = {one["name"]: one.get("default") for one in template["parameterDefinitions"] if one["type"] == "PATH"}
    assert files == {"Job": "stills.toml", "Scene1": "bare.blend", "Output": "out"}


def test_what_is_elsewhere_has_no_default(tmp_path):
    """Farms refuse one outside the template's folder."""
    tasks = parse('[[render]]\npreset = "copper"', "job", tmp_path)
    template = openjd.template(tmp_path / "a" / "job.toml", tmp_path / "b", tmp_path / "a" / "out", tasks)
    assert not any("default" in one for one in template["parameterDefinitions"] if one["type"] == "PATH")


@pytest.mark.parametrize(("name", "message"), [("a.xml", "unknown ending"), ("no/a.json", "the folder")])
def test_a_template_that_cannot_be_written_is_refused(tmp_path, name, message):
    tasks = parse('[[render]]\npreset = "copper"', "job", tmp_path)
    with pytest.raises((JobError, OSError), match=message):
        openjd.write(tmp_path / name, tmp_path / "job.toml", tmp_path, tasks)


# Dask


@pytest.fixture
def cluster(folder, family):
    """A scheduler and two workers of one thread, each kept alive by its nanny: (address, scheduler, nannies)."""
    options = {"cwd": folder, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    common = ["--no-dashboard", "--scheduler-file", "cluster.json"]
    begun = []

    def begin():
        (folder / "cluster.json").unlink(missing_ok=True)
        begun.append(
            subprocess.Popen([BIN / "dask", "scheduler", "--host", "127.0.0.1", "--port", "0", *common], **options)
        )
        more = ["--nworkers", "2", "--nthreads", "1", "--memory-limit", "0", "--local-directory", "dask"]
        begun.append(subprocess.Popen([BIN / "dask", "worker", *more, *common], **options))
        end = time.monotonic() + 60
        while not (folder / "cluster.json").is_file():
            assert time.monotonic() < end
            time.sleep(0.1)
        return json.loads((folder / "cluster.json").read_text())["address"], *begun[-2:]

    yield begin
    for process in begun:
        for one in [*family(process.pid), process]:
            one.kill()
        process.wait()


def begin_batch(folder, address, job):
    (folder / "job.toml").write_text(job, encoding="utf-8")
    command = [BIN / "vgroove", "batch", "job.toml", "-o", "out", "--cluster", address]
    return subprocess.Popen(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def test_killed_workers_cost_nothing(folder, cluster, family, same_as_quiet):
    """kill -9 of a random worker: each task once, the pixels of a quiet run; its renderer ends with it."""
    address, _, nannies = cluster()
    job, kills, draw = JOB + f"seed = {list(range(24))}\n", 0, random.Random(6)  # noqa: S311 - which one is killed
    process = begin_batch(folder, address, job)
    before = 0
    while process.poll() is None:
        if len(stills(folder)) > before + 2 and kills < 3 and (workers := family(nannies.pid, "spawn_main")):
            draw.choice(workers).kill()
            before, kills = len(stills(folder)), kills + 1
        time.sleep(0.05)
    errors = process.communicate()[1]
    assert process.returncode == 0, errors
    assert kills == 3
    assert len({row["task"] for row in rows(folder)}) == len(rows(folder)) == 24
    assert {row["status"] for row in rows(folder)} <= {"rendered", "there"}  # killed before it could say so
    same_as_quiet(stills(folder), parse(job, "job", folder))


def test_a_scheduler_that_is_killed_is_told_and_the_rest_is_finished(folder, cluster, family, same_as_quiet):
    """One line, exit 3, no renderer left; the same command on a new one renders the rest only."""
    address, scheduler, nannies = cluster()
    job = JOB + f"seed = {list(range(40))}\n"
    process = begin_batch(folder, address, job)
    while len(stills(folder)) < 5:
        assert process.poll() is None
        time.sleep(0.05)
    scheduler.kill()
    errors = process.communicate(timeout=60)[1]
    assert process.returncode == 3, errors
    lines = [line for line in errors.splitlines() if not line.startswith("rendering")]
    assert len(lines) == 1, errors
    assert lines[0].startswith(f"vgroove: {address}: the Dask scheduler is gone; start it")
    renderers = family(nannies.pid, RENDERER)
    nannies.kill()
    nannies.wait()
    assert not psutil.wait_procs(renderers, timeout=30)[1]
    before = len(stills(folder))
    address, *_ = cluster()
    process = begin_batch(folder, address, job)
    errors = process.communicate(timeout=120)[1]
    assert process.returncode == 0, errors
    assert f"{before} of them there already" in errors
    same_as_quiet(stills(folder), parse(job, "job", folder))


def test_a_machine_of_another_blender_ends_the_work(folder, monkeypatch):
    """Rather than use up the tries of tasks; so does one that does not see the folder."""
    monkeypatch.setattr("distributed.get_worker", lambda: SimpleNamespace(address="tcp://farm:1"))
    (task,) = parse(JOB, "job", folder)
    limit = Limits(1, 0)
    with pytest.raises(RuntimeError, match=r"tcp://farm:1 has Blender .*, and 1\.0 was asked for; take it out"):
        cluster_of_tasks.render_on_worker(task, folder, {"blender": "1.0"}, limit, {})
    with pytest.raises(FileNotFoundError, match=r"there is no such folder on tcp://farm:1"):
        cluster_of_tasks.render_on_worker(task, folder / "none", {}, limit, {})


def test_no_scheduler_is_one_line(folder):
    """Exit 2, nothing written."""
    process = begin_batch(folder, "tcp://127.0.0.1:1", JOB)
    errors = process.communicate(timeout=60)[1]
    assert process.returncode == 2
    assert errors.startswith("vgroove: tcp://127.0.0.1:1: no Dask scheduler answers there")
    assert len(errors.splitlines()) == 1
    assert not (folder / "out").exists()
