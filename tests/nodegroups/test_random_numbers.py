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

NODES = "\n".join(path.read_text("utf-8") for path in Path(nodegroups.__file__).parent.glob("*.py"))
OSL = "\n".join(path.read_text("utf-8") for path in osl_script.FOLDER.rglob("*.*"))


@pytest.mark.parametrize("streams", [random_numbers.NODE_STREAMS, random_numbers.OSL_STREAMS], ids=["nodes", "OSL"])
def test_no_two_draws_share_a_stream(streams):
    """Nor does a light share one with another draw, however many lights a material is bound to."""
    for (one, first), (other, second) in combinations(streams.items(), 2):
        assert not set(first) & set(second), (one, other)
    assert len(streams["LIGHT"]) >= lamps.LIMIT


def test_node_groups_draw_from_listed_streams_once_each():
    """No call of ``random_numbers`` names a number, and each draw but a light's stands in one place."""
    drawn = Counter(re.findall(r"= random_numbers\(tree, (.+)\)\n", NODES))
    of_lights = drawn.pop('inputs["Stream"]')
    assert drawn == {f'stream("{draw}")': 1 for draw in random_numbers.NODE_STREAMS if draw != "LIGHT"}
    assert of_lights == len(re.findall(r"\brandom_numbers\(tree", NODES)) - len(drawn) - 1  # and its definition


def test_shaders_draw_from_listed_streams_once_each():
    """No call of ``random_number`` names a number; a light's stream comes with the light."""
    drawn = Counter(re.findall(r"\brandom_number\(([^,()]+), seed\)", OSL))
    assert drawn.pop("Stream") == drawn.pop("Stream - STREAM_LIGHT + STREAM_LIGHT_AZIMUTH") == 1
    assert drawn == {f"STREAM_{draw}": 1 for draw in random_numbers.OSL_STREAMS if "LIGHT" not in draw}
    assert drawn.total() + 2 == len(re.findall(r"\brandom_number\(", OSL)) - 1  # and its definition
    assert osl_script.source("lamp").count("#define STREAM_LIGHT_AZIMUTH 60\n") == 1
