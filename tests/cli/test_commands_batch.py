# SPDX-License-Identifier: GPL-3.0-or-later
"""`vgroove batch`: planned, rendered, resumed; the same stills as `vgroove render` makes."""

import csv
import re

import numpy as np
import pytest

from ..commands import patient as vgroove
from ..commands import read_exr

pytestmark = [pytest.mark.blender, pytest.mark.usefixtures("blender")]


def test_a_task_that_fails_does_not_keep_the_rest_from_being_rendered(scene_file, tmp_path):
    """An object that is not there: exit 3, one line with the reason, which the table has too."""
    job = tmp_path / "job.toml"
    job.write_text(
        f'[[render]]\nscene = "{scene_file}"\nobject = "Flour"\npreset = "gold"\n'
        f'[[render]]\nscene = "{scene_file}"\nobject = "Floor"\npreset = "gold"\n'
    )
    done = vgroove("batch", job, "-o", tmp_path / "out")
    assert done.code == 3
    assert '1 of 2 tasks failed: "Flour=metals/gold": the scene has no object of that name; it has' in done.err
    with (tmp_path / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["failed", "rendered"]
    assert "no object of that name" in rows[0]["reason"]
    assert len(list((tmp_path / "out").glob("*.exr"))) == 1


@pytest.mark.once
def test_a_still_of_a_batch_is_what_render_makes(tmp_path):
    """The same pixels, but for the rounding of a sum in halves: a unit in the last place of float32 a sample."""
    given = ["--set", "m=0.2", "--samples", "2", "--resolution", "24x16", "--seed", "3"]
    assert vgroove("render", "copper", *given, "-o", tmp_path / "still.exr").code == 0
    job = tmp_path / "job.toml"
    job.write_text('[[render]]\npreset = "copper"\nset.m = 0.2\nsamples = 2\nresolution = "24x16"\nseed = 3\n')
    assert vgroove("batch", job, "-o", tmp_path / "out").code == 0
    (path,) = (tmp_path / "out").glob("*.exr")
    still = read_exr(tmp_path / "still.exr")[0]
    np.testing.assert_allclose(read_exr(path)[0], still, rtol=2 * np.finfo(np.float32).eps)


@pytest.mark.once
def test_a_batch_is_planned_rendered_and_taken_up_again(tmp_path):
    """--dry-run writes nothing; the second run keeps all, and the table of results keeps its seconds."""
    job = tmp_path / "job.toml"
    job.write_text('[[render]]\npreset = ["copper", "gold"]\nseed = [0, 1]\nsamples = 2\nresolution = "24x16"\n')
    planned = vgroove("batch", job, "-o", tmp_path / "out", "--dry-run")
    assert planned.code == 0, planned.err
    assert "4 tasks" in planned.out
    assert re.search(r"about \d+ s by \d processes for 4 tasks, by the speed of the preview scene", planned.out)
    assert not (tmp_path / "out").exists()
    first, again = (vgroove("batch", job, "-o", tmp_path / "out", "--workers", 1) for _ in range(2))
    assert first.code == 0, first.err
    assert "wrote 4 stills" in first.err
    assert "4 of them there already" in again.err
    with (tmp_path / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["label"] for row in rows][:2] == ["lecture/copper, seed 0", "lecture/copper, seed 1"]
    assert all(row["status"] == "there" and float(row["seconds"]) > 0 for row in rows)
    planned = vgroove("batch", job, "-o", tmp_path / "out", "--dry-run").out
    assert "about 0 s by" in planned
    assert "for 0 tasks, by the speed of 4 that are there" in planned
    part = vgroove("batch", job, "-o", tmp_path / "a [/b] part", "--tasks", "2-3", "--workers", 1)
    assert "wrote 2 stills to" in part.err
    assert "a [/b] part" in part.err
    made = {path.name for path in (tmp_path / "a [/b] part").iterdir()}
    assert made == {"results-2-3.csv", *(f"{row['task']}.exr" for row in rows[1:3])}
    (tmp_path / "file").touch()
    within = vgroove("batch", job, "-o", tmp_path / "file" / "out")
    assert within.code == 2
    assert "file/out: cannot be made: Not a directory; choose another with -o" in within.err
    beyond = vgroove("batch", job, "-o", tmp_path / "part", "--tasks", "2-5")
    assert beyond.code == 2
    assert '--tasks "2-5": write A-B, from 1-4: the job has 4 tasks' in beyond.err
    page = vgroove("gallery", tmp_path / "out", "-o", tmp_path / "page.html")
    assert page.code == 0, page.err
    assert (tmp_path / "page.html").read_text(encoding="utf-8").count("<article") == 4
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"results.csv", *(f"{row['task']}.exr" for row in rows)}
