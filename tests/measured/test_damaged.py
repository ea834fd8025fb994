# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files are refused in one line, or read as what they are: with finite values, in bounded memory."""

import os
import tracemalloc

import numpy as np
import pytest

from vgroove.addon.library.files import FileError
from vgroove.addon.measured import read, reading, tabulate, write_merl
from vgroove.addon.reference import Lambert

from .damage import content_of, damaged
from .makers import AZIMUTHS, astm_text, directions, rgl_arrays, tensor_file, utia_bytes

SMALL = 400_000  # bytes that a reader may need for itself: modules, tables of a small file, a line's numbers
MOST_LETTERS = 300


def peak_of(path):
    """The largest memory while a file is read, and what reading gave: a table, or the line."""
    tracemalloc.start()
    try:
        found = read(path)
    except FileError as error:
        found = str(error)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak, found


def test_there_are_at_least_200():
    assert len(damaged()) >= 200
    assert len(set(damaged())) == len(damaged())


@pytest.mark.parametrize("ending", [".bsdf", ".astm", ".bin", ".binary", ".dat"])
def test_each_is_refused_in_one_line_and_nothing_is_written(ending, tmp_path):
    """With the file's name, in words for people, within three times the file's memory."""
    for kind, seed in [(kind, seed) for other, kind, seed in damaged() if other == ending]:
        path = tmp_path / f"damaged{ending}"
        path.write_bytes(content_of(ending, kind, seed))
        peak, said = peak_of(path)
        assert isinstance(said, str), (kind, seed)
        assert said.startswith(f"{path}: "), said
        assert said.isprintable(), (kind, said)
        assert len(said) < len(str(path)) + MOST_LETTERS, said
        assert not any(word in said for word in ("Error", "array", "Traceback", "dtype(")), said
        assert peak < 3 * path.stat().st_size + SMALL, (kind, seed, peak)
        assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("ending", "kind", "words"),
    [
        (".bsdf", "swapped", "bytes are swapped"),
        (".bsdf", "huge", "get the whole file"),
        (".bsdf", "missing", "has no field"),
        (".bsdf", "nan", "must "),
        (".astm", "points", "NUM_POINTS says"),
        (".bin", "swapped", "bytes are swapped"),
        (".bin", "cut", "is cut off"),
        (".binary", "swapped", "bytes are swapped"),
        (".binary", "cut", "is cut off"),
        (".binary", "wrong", "is cut off"),
        (".binary", "longer", "is too long"),
        (".binary", "gigantic", "has 2147483647 x 2147483647 x 2147483647 entries"),
        (".binary", "invalid", "holds no reflectance"),
        (".dat", "noise", "has none of the formats"),
        (".dat", "nothing", "is empty"),
    ],
)
def test_the_line_says_what_is_wrong(ending, kind, words, tmp_path):
    path = tmp_path / f"damaged{ending}"
    path.write_bytes(content_of(ending, kind, 0))
    with pytest.raises(FileError, match=words):
        read(path)


def test_what_is_no_regular_file_or_too_large_is_refused(tmp_path, monkeypatch):
    """Before it is read: the large one here is sparse."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "large").touch()
    os.truncate(tmp_path / "large", 2**40)
    for name, words in {
        "pipe": "is a pipe",
        "large": "has 1099511627776 bytes",
        ".": "is a folder",
        "no": "No such",
    }.items():
        with pytest.raises(FileError, match=words):
            read(tmp_path / name)
    assert reading.MOST_BYTES < 2**30


def test_reading_takes_less_than_three_times_the_file(tmp_path):
    """Of each format; a file of random bits flipped in its numbers is read, or refused, within that too."""
    write_merl(tmp_path / "a.binary", tabulate(Lambert(0.5).evaluate))
    whole = {
        "b.bsdf": tensor_file(rgl_arrays(1, AZIMUTHS["all"])),
        "c.bin": utia_bytes(Lambert(0.5).evaluate),
        "d.astm": astm_text(Lambert(0.5).evaluate, step=7.5).encode(),
    }
    for name, content in whole.items():
        (tmp_path / name).write_bytes(content)
    for path in sorted(tmp_path.iterdir()):
        peak, found = peak_of(path)
        assert not isinstance(found, str), found
        assert peak < 3 * path.stat().st_size + SMALL, path


@pytest.mark.parametrize("seed", range(20))
def test_flipped_bits_give_finite_values_or_one_line(seed, tmp_path):
    """In the last half of a file, where its numbers are."""
    rng = np.random.default_rng(seed)
    arrays = rgl_arrays(seed, AZIMUTHS["half"])
    for name, content in {"a.bsdf": tensor_file(arrays), "b.bin": utia_bytes(Lambert(0.5).evaluate)}.items():
        bits = np.frombuffer(content, np.uint8).copy()
        at = rng.integers(len(bits) // 2, len(bits), 50)
        bits[at] ^= (1 << rng.integers(0, 8, at.size)).astype(np.uint8)
        path = tmp_path / name
        path.write_bytes(bits.tobytes())
        _, found = peak_of(path)
        if not isinstance(found, str):
            f = found.evaluate(*directions(300, seed))
            assert np.isfinite(f).all()
            assert (f >= 0).all()
