# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove info``: what a file with a measured BRDF holds."""

import json

import pytest

from vgroove.addon.reference import Lambert

from ..commands import vgroove
from ..measured.damage import ENDINGS, WHOLE_MERL, content_of
from ..measured.makers import astm_text, rgl_arrays, tensor_file, utia_bytes

LAMBERT = Lambert([0.6, 0.3, 0.1]).evaluate


@pytest.fixture
def files(line):
    contents = {
        "a.bsdf": tensor_file(rgl_arrays()),
        "b.astm": astm_text(LAMBERT, step=30.0).encode(),
        "c.bin": utia_bytes(LAMBERT),
    }
    for name, content in contents.items():
        (line.folder / name).write_bytes(content)
    return line


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("a.bsdf", ["RGL .bsdf", "made for a test", "1 phi_i x 5 theta_i", "isotropic"]),
        ("b.astm", ["ASTM E1392", "SAMPLE_NAME made for a test", "108 pairs of directions"]),
        ("c.bin", ["UTIA .bin", "anisotropic", "coverage", "100 %"]),
    ],
)
def test_it_says_what_is_in_the_file(files, name, words):
    done = vgroove("info", name)
    assert done.code == 0, done.err
    shown = " ".join(done.out.replace("│", " ").split())
    for word in (*words, "range", "reciprocity error", "albedo", "85 degrees"):
        assert word in shown


def test_json_has_the_numbers(files):
    """Those of Lambert's albedo."""
    done = vgroove("info", "c.bin", "--json")
    found = json.loads(done.out)
    assert set(found) == {"contents", "coverage", "summary", "angles"}
    assert found["contents"]["entries"] == 288**2
    assert found["coverage"] == 1.0
    for rgb in found["summary"]["albedo"]:
        assert rgb == pytest.approx([0.6, 0.3, 0.1], rel=5e-3)


CASES = [(ending, kind) for ending, kinds in ENDINGS.items() for kind in kinds]


@pytest.mark.parametrize(("ending", "kind"), [*CASES, (".binary", "invalid")])
def test_damaged_files_end_with_one_line(line, ending, kind):
    """With exit code 2, and nothing is written."""
    assert "invalid" in WHOLE_MERL
    (line.folder / f"damaged{ending}").write_bytes(content_of(ending, kind, 1))
    assert line.refuses("info", f"damaged{ending}").startswith(f"vgroove: damaged{ending}: ")


@pytest.mark.parametrize("name", ["missing.binary", "."])
def test_what_is_no_file_ends_with_one_line(line, name):
    assert line.refuses("info", name).startswith(f"vgroove: {name}: ")
