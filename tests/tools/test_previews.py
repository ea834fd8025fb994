# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of presets: the same each time, small, and each of its own material."""

import importlib.util
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from vgroove.addon.library.presets import shipped

pytestmark = pytest.mark.blender

TOOL = Path(__file__).parents[2] / "tools" / "previews.py"
NAMES = ("metals/gold", "glasses/soda_lime_glass_green_tint")
SHIPPED = 8e6  # bytes that all pictures may take together


_spec = importlib.util.spec_from_file_location("previews", TOOL)
previews = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(previews)


def test_what_is_there_is_not_rendered_again(tmp_path, monkeypatch):
    """A run resumes where it was interrupted; with another studio, or where a picture is lost, it renders."""
    ids = [preset.id for preset in previews.wanted([], tmp_path)]
    assert ids == list(shipped())
    done = ids[:5]
    for identity in done:
        (tmp_path / f"{identity}.webp").parent.mkdir(exist_ok=True)
        (tmp_path / f"{identity}.webp").touch()
    digests = {identity: previews.digest(shipped()[identity]) for identity in done}
    (tmp_path / previews.DIGESTS).write_text(json.dumps(digests), encoding="utf-8")
    left = [preset.id for preset in previews.wanted([], tmp_path)]
    assert left == ids[5:]
    (tmp_path / f"{done[0]}.webp").unlink()
    assert previews.wanted([], tmp_path)[0].id == done[0]
    assert len(previews.wanted([], tmp_path, everything=True)) == len(ids)
    monkeypatch.setattr(previews, "STUDIO", b"other lights")
    assert len(previews.wanted([], tmp_path)) == len(ids)


def test_a_picture_is_made_again_if_it_would_change():
    """By another number or shape; not by a name, a source, or an Abbe number, which no picture shows."""
    ruby = shipped()["gems/ruby"]
    made = previews.digest(ruby)
    assert previews.digest(replace(ruby, name="Red Corundum", source={}, notes="x", m_range=None)) == made
    assert previews.digest(replace(ruby, parameters=ruby.parameters | {"abbe": 72.0})) == made
    assert previews.digest(ruby.with_parameters(eta=1.5)) != made
    assert previews.digest(replace(ruby, tags=("transparent",))) != made  # a ball


def pictures(folder, *names):
    subprocess.run([sys.executable, str(TOOL), "--folder", str(folder), *names], check=True, capture_output=True)
    return [(folder / f"{name}.webp").read_bytes() for name in names]


@pytest.mark.once
def test_pictures_are_the_same_each_time_and_show_their_material(tmp_path):
    """Byte for byte; gold is yellow, green glass green where the floor shines through it."""
    first, again = pictures(tmp_path / "a", *NAMES), pictures(tmp_path / "b", NAMES[1])
    assert first[1:] == again
    gold, glass = (np.asarray(Image.open(tmp_path / "a" / f"{name}.webp"), float) for name in NAMES)
    assert gold.shape == glass.shape == (256, 256, 3)
    middle = slice(70, 110), slice(105, 150)
    assert np.all(np.diff(gold[middle].mean(axis=(0, 1))) < -20.0)
    assert glass[middle].mean(axis=(0, 1)).argmax() == 1
    assert max(map(len, first)) <= SHIPPED / len(shipped())
    assert not list(tmp_path.rglob(".*"))  # nothing half written is left
