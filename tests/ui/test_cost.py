# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene of many materials costs: the time of Apply, and the size of the file."""

import time
from itertools import zip_longest
from statistics import median

import pytest

from vgroove import headless
from vgroove.addon.library import families, presets
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender

COUNT = 20
# Bytes that so many, of eight models, add to a file that is not compressed: a socket takes 0.5 kB of it. On 5.3 they have
# the formula for EEVEE, too, which takes 1.5 MB.
LARGEST = 4_400_000 if versions.LIGHT_NODES else 3_000_000


def some_of_every_family():
    """So many presets, the first of every family before the second of any."""
    shipped = list(presets.shipped())
    listed = [[one for one in shipped if families.title(one) == title] for title in families.TITLES]
    return [one for row in zip_longest(*listed) for one in row if one is not None][:COUNT]


def apply(extension, identity):
    """Wall time in s of Apply alone."""
    extension.context.scene.vgroove.preset = identity
    with headless.quiet():
        start = time.perf_counter()
        assert extension.ops.vgroove.apply() == {"FINISHED"}
        return time.perf_counter() - start


def size(extension, path):
    """Bytes of the open file, saved."""
    with headless.quiet():
        extension.ops.wm.save_as_mainfile(filepath=str(path), compress=False)
    return path.stat().st_size


def add_cube(extension):
    with headless.quiet():
        extension.ops.mesh.primitive_cube_add()
    return extension.context.object


def select(extension, item):
    extension.ops.object.select_all(action="DESELECT")
    item.select_set(True)
    extension.context.view_layer.objects.active = item


def append(extension, path, name):
    """Wall time in s of appending a material by Blender and giving it to the object."""
    with headless.quiet():
        start = time.perf_counter()
        with extension.data.libraries.load(str(path)) as (_, into):
            into.materials = [name]
        extension.context.object.active_material = into.materials[0]
        extension.context.view_layer.update()
        return time.perf_counter() - start


def test_files_stay_small_and_apply_is_as_quick_as_an_append(extension, tmp_path):
    """20 presets add little to Blender's own half MB and the objects; Apply takes less than appending the same materials from it.

    Both make a node tree and have the scene evaluated, in turn, so that what else runs slows both; of either the median
    is taken. An append reads the file and brings a copy of every group, which Apply reuses: it takes 0.3 times as long.
    """
    chosen, data, path = some_of_every_family(), extension.data, tmp_path / "saved.blend"
    cubes = [add_cube(extension) for _ in chosen]
    own = size(extension, tmp_path / "own.blend")
    for cube, identity in zip(cubes, chosen, strict=True):
        select(extension, cube)
        apply(extension, identity)
    made = [material.name for material in data.materials if "vgroove" in material]
    assert len(made) == COUNT
    assert size(extension, path) - own < LARGEST
    with headless.quiet():
        extension.ops.wm.read_factory_settings()
    apply(extension, chosen[0])  # builds groups for the first time
    for identity in chosen:
        apply(extension, identity)
    pairs = [(apply(extension, one), append(extension, path, name)) for one, name in zip(chosen, made, strict=True)]
    ours, theirs = (median(of) for of in zip(*pairs, strict=True))
    assert ours < theirs
