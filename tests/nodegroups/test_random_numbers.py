# SPDX-License-Identifier: GPL-3.0-or-later
"""Random streams: one list, and no two draws on one stream."""

import re
from collections import Counter
from itertools import combinations
from pathlib import Path

import pytest

from vgroove import nodegroups
from vgroove.addon.blender import lamps
from vgroove.nodegroups import osl_script, random_numbers

pytestmark = pytest.mark.blender

NODE_FILES = [path.read_text("utf-8") for path in Path(nodegroups.__file__).parent.glob("*.py")]
OSL_FILES = [path.read_text("utf-8") for path in osl_script.FOLDER.rglob("*.*")]


@pytest.mark.parametrize("streams", [random_numbers.NODE_STREAMS, random_numbers.OSL_STREAMS], ids=["nodes", "OSL"])
def test_no_two_draws_share_a_stream(streams):
    """Nor does a light share one with another draw, however many lights a material is bound to."""
    for (one, first), (other, second) in combinations(streams.items(), 2):
        assert not set(first) & set(second), (one, other)
    assert len(streams["LIGHT"]) >= lamps.LIMIT


def test_node_groups_draw_from_listed_streams_once_each():
    """No call of ``random_numbers`` names a number, and a draw stands in one place of each file.

    Phong and Oren-Nayar, which are never in one material, share a stream.
    """
    found = set()
    for text in NODE_FILES:
        drawn = Counter(re.findall(r"= random_numbers\(tree, (.+)\)\n", text))
        of_lights = drawn.pop('inputs["Stream"]', 0)
        assert set(drawn.values()) <= {1}
        defined = len(re.findall(r"def random_numbers\(tree", text))
        assert drawn.total() + of_lights == len(re.findall(r"\brandom_numbers\(tree", text)) - defined
        found |= set(drawn)
    assert found == {f'stream("{draw}")' for draw in random_numbers.NODE_STREAMS if draw != "LIGHT"}


def test_shaders_draw_from_listed_streams_once_each():
    """As node groups; a light's stream comes with the light."""
    found = set()
    for text in OSL_FILES:
        drawn = Counter(re.findall(r"\brandom_number\(([^,()]+), seed\)", text))
        assert set(drawn.values()) <= {1}
        defined = len(re.findall(r"float random_number\(", text))
        assert drawn.total() == len(re.findall(r"\brandom_number\(", text)) - defined
        found |= set(drawn)
    assert found >= {"Stream", "Stream - STREAM_LIGHT + STREAM_LIGHT_AZIMUTH"}
    own = {f"STREAM_{draw}" for draw in random_numbers.OSL_STREAMS if "LIGHT" not in draw}
    assert {name for name in found if not name.startswith("Stream")} == own
    assert osl_script.source("lamp").count("#define STREAM_LIGHT_AZIMUTH 60\n") == 1
