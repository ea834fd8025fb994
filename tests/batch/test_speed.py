# SPDX-License-Identifier: GPL-3.0-or-later
"""What docs/batch.md says of time and memory holds, as the report measures it, at fewer stills."""

import pytest

from vgroove.batch import cost
from vgroove.batch.job import parse

pytestmark = [pytest.mark.blender, pytest.mark.once]


def test_a_batch_has_eight_times_the_throughput_of_a_process_a_still(blender, tmp_path):
    """At 24 stills, over which the start of a batch is spread less than over 1,000; both in the same minute."""
    single = cost.single_render_seconds(1, tmp_path)
    batch = cost.batch_seconds(24, tmp_path)
    single = (single + cost.single_render_seconds(1, tmp_path)) / 2.0
    assert single / batch > 8.0


def test_little_is_done_outside_cycles(blender, tmp_path):
    """Under 15 % of what its render call takes, at 256 x 256 and 64 samples."""
    outside, _ = cost.one_process(parse(cost.job(4, 256, 64), "job", tmp_path)[:2], tmp_path)
    assert outside < 0.15


def test_no_memory_is_left_behind(blender, tmp_path):
    """Under 20 kB a task, once all was needed once; until some fifty tasks later memory is still being divided up."""
    _, slope = cost.one_process(parse(cost.job(200, 32, 4), "job", tmp_path), tmp_path)
    assert slope < 20_000
