# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a batch before and after it."""

import csv
import math
from pathlib import Path

import pytest

from vgroove.batch import results
from vgroove.batch.job import parse
from vgroove.batch.outcome import Outcome
from vgroove.batch.pool import TRIES, Tries

HERE = Path()


def named(text):
    tasks = parse("[[render]]\n" + text, "job.toml", HERE)
    return {task.identity({}): task for task in tasks}


def test_the_time_of_what_is_left_follows_what_was_rendered():
    """Two of four tasks took 1 s beside their bookkeeping: the other two take as long, by two processes at once."""
    tasks = named('preset = "copper"\nseed = [0, 1, 2, 3]\nsamples = 10\nresolution = "100x100"')
    first = dict.fromkeys(list(tasks)[:2], 1.0 + results.EACH)
    said = results.estimate(tasks, first, 2)
    assert said.startswith(f"about {results.START + 1.0 + results.EACH:.0f} s by 2 processes for 2 tasks, ")
    assert said.endswith("by the speed of 2 that are there")


def test_the_time_without_anything_to_go_by_is_that_of_the_preview_scene():
    """In proportion to pixels and samples; to a tenth of an error it is a hundred times that."""
    (many,) = named('preset = "copper"\nsamples = 1000\nresolution = "1000x1000"').values()
    assert results.rays(many) == 1e9
    said = results.estimate({"a": many}, {}, 1)
    assert said.startswith(
        f"about {1e9 / results.RAYS / 60:.0f} min by 1 processes for 1 tasks, by the speed of the pre"
    )
    coarse, fine = named('preset = "copper"\nerror = [0.1, 0.01]').values()
    assert results.rays(fine) == pytest.approx(100 * results.rays(coarse))


def test_what_a_scene_decides_is_said_to_be_unknown(tmp_path):
    (tmp_path / "a.blend").write_bytes(b"")
    (task,) = parse('[[render]]\nscene = "a.blend"', "job.toml", tmp_path)
    assert math.isnan(results.rays(task))
    assert results.estimate({"a": task}, {}, 1).endswith(
        "for 0 tasks, by the speed of the preview scene, and 1 whose scene decides"
    )


@pytest.mark.parametrize(
    ("seconds", "text"), [(0, "0 s"), (89, "89 s"), (90, "2 min"), (5399, "90 min"), (9000, "2.5 h")]
)
def test_durations_are_for_people(seconds, text):
    assert results.duration(seconds) == text


def test_a_row_a_task(tmp_path):
    """What was not come to is left; an error that is not known is empty."""
    tasks = named('preset = "copper"\nseed = [0, 1, 2]')
    first, second, third = tasks
    outcomes = {
        first: Outcome(first, "rendered", 2.0, 1.5, 64, 0.0123456, 3 * 10**8),
        third: Outcome(third, "failed", reason="a, b", tries=3),
    }
    path = tmp_path / "results.csv"
    results.write(path, tasks, outcomes)
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["rendered", "left", "failed"]
    assert list(rows[0].values()) == [
        first, "rendered", "2.000", "1.500", "64", "0.01235", "300", "1", "lecture/copper, seed 0", ""
    ]  # fmt: skip
    assert (rows[2]["error"], rows[2]["reason"], rows[2]["tries"]) == ("", "a, b", "3")
    assert results.read_seconds(tmp_path) == {first: 2.0}
    assert rows[1]["task"] == second


def test_tries_are_counted_and_reasons_kept():
    """Each reason once; a task that goes well after all says how many it took."""
    tries = Tries()
    for reason in ("slow", "slow", "large")[: TRIES - 1]:
        assert tries.settle(Outcome("a", "stumbled", reason=reason)) is None
    found = tries.settle(Outcome("a", "stumbled", reason="large"))
    assert (found.status, found.tries, found.reason) == ("failed", TRIES, "slow; then large")
    assert tries.settle(Outcome("b", "stumbled", reason="slow")) is None
    assert tries.settle(Outcome("b", "rendered")).tries == 2
    assert tries.settle(Outcome("c", "failed", reason="no such object")).tries == 1
