# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: the lecture's six to the digit, and one clear line for whatever is wrong with a file."""

import re
import time
import tomllib

import numpy as np
import pytest

from vgroove.addon.library import presets
from vgroove.addon.library.checks import PresetError
from vgroove.addon.library.presets import FOLDER, all_presets, find, load, load_folder, parse
from vgroove.addon.models import parameter
from vgroove.addon.reference import Glass, OrenNayar, albedo, spherical

GOOD = 'name = "A"\nmodel = "cook_torrance"\nm = 0.3\n[fresnel]\nf0 = [0.9, 0.6, 0.5]\n[source]\ndata = "somewhere"\n'

LECTURE = {
    "water": (0.02, 0.02, 0.02),
    "plastic": (0.05, 0.05, 0.05),
    "glass": (0.08, 0.08, 0.08),
    "diamond": (0.17, 0.17, 0.17),
    "copper": (0.95, 0.64, 0.54),
    "aluminium": (0.91, 0.92, 0.92),
}


@pytest.mark.parametrize(("name", "f0"), LECTURE.items())
def test_the_lecture_table_is_kept_to_the_digit(name, f0):
    """F0 as printed, found by bare name and by id."""
    preset = find(name)
    assert preset.parameters["f0"] == f0
    assert preset is find(f"lecture/{name}")
    assert preset.source["data"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("m = 0.3", "m = 0", None),
        ("m = 0.3", "m = 20.0", "x.toml: m must be between 0.0001 and 10 .*got 20"),
        ("m = 0.3", "m = -1", "x.toml: m must be between"),
        ("m = 0.3", "m = nan", "x.toml: m must be between .* got nan"),
        ("m = 0.3", 'm = "rough"', "x.toml: m must be a number, got 'rough'"),
        ("m = 0.3", "m = true", "x.toml: m must be a number, got True"),
        ("m = 0.3", "", 'x.toml: "m" is missing; add m = 0.3'),
        ("m = 0.3", "m = 0.3\nslope = 1", 'x.toml: unknown key "slope"'),
        ("m = 0.3", "m = 0.3\nsorce = 1", 'x.toml: unknown key "sorce"; did you mean "source"?'),
        ("0.9,", "1.1,", "x.toml: f0 must be between 0 and 1, got 1.1"),
        ("[0.9, 0.6, 0.5]", "[0.9, 0.6]", "x.toml: f0 must be one number or three"),
        (
            "f0 = [0.9, 0.6, 0.5]",
            "n = 1",
            r"x.toml: \[fresnel\] must hold f0, or f0 and f82_tint, or eta, or n and k; got n",
        ),
        ("f0 = [0.9, 0.6, 0.5]", "", r"x.toml: \[fresnel\] must hold .*got nothing"),
        ("f0 = [0.9, 0.6, 0.5]", "eta = 0.01", "x.toml: eta must be between 0.1 and 10, got 0.01"),
        ("cook_torrance", "gouraud", 'x.toml: unknown model "gouraud"; use one of cook_torrance'),
        ('data = "somewhere"', 'data = " "', r'x.toml: \[source\] has no "data"'),
        ('[source]\ndata = "somewhere"', "", 'x.toml: "source" is missing'),
        ('"A"', '"A', "x.toml: not valid TOML"),
        ('name = "A"', 'name = "A"\nname = "B"', "x.toml: not valid TOML"),
    ],
)
def test_a_bad_file_is_one_line_with_file_and_key(old, new, message):
    """What is wrong, where, and the value; nothing else comes up."""
    text = GOOD.replace(old, new)
    if message is None:
        assert parse(text, "t/x", "x.toml").m == 0
        return
    with pytest.raises(PresetError, match=message) as caught:
        parse(text, "t/x", "x.toml")
    assert "\n" not in str(caught.value)


def test_an_abbe_number_goes_with_what_is_clear():
    """It is kept, and a sheet or what has none does not disperse."""
    water = (presets.FOLDER / "liquids/water.toml").read_text(encoding="utf-8")
    assert parse(water, "t/x", "x.toml").parameters["abbe"] == pytest.approx(55.76)
    with pytest.raises(PresetError, match=r"x.toml: abbe must be .*1000"):
        parse(water.replace("abbe = 55.76", "abbe = 1001"), "t/x", "x.toml")
    with pytest.raises(PresetError, match=r'x.toml: unknown key "abbe"'):
        parse(f"abbe = 50\n{GOOD}", "t/x", "x.toml")
    assert find("liquids/water").with_parameters(abbe=30.0).can_disperse
    assert not find("liquids/water").with_parameters(abbe=0.0).can_disperse
    able = {one: find(one).can_disperse for one in ("liquids/water", "glasses/window", "gems/ruby", "metals/gold")}
    assert able == {"liquids/water": True, "glasses/window": False, "gems/ruby": False, "metals/gold": False}


def test_two_files_of_one_id_are_refused(tmp_path):
    """Names that differ only in case would be one file on some systems."""
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "x.toml").write_text(GOOD)
    (tmp_path / "a" / "X.toml").write_text(GOOD)
    with pytest.raises(PresetError, match="duplicate id"):
        load_folder(tmp_path)


def test_an_unreadable_file_is_one_line(tmp_path):
    """Missing, or not text."""
    with pytest.raises(PresetError, match="cannot be read"):
        load(tmp_path / "none.toml")
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(PresetError, match="cannot be read"):
        load(tmp_path / "b.toml")


def test_unknown_names_suggest_what_is_near():
    with pytest.raises(PresetError, match='unknown preset "coper"; did you mean "copper"'):
        find("coper")
    with pytest.raises(PresetError, match='"vgroove presets" lists them'):
        find("zzzzzz")


def test_parameters_change_within_their_ranges():
    """--set goes through the same checks as a file."""
    changed = find("copper").with_parameters(m=0.5, f0=0.2)
    assert changed.parameters == {"m": 0.5, "f0": (0.2, 0.2, 0.2)}
    assert find("copper").m == 0.3
    with pytest.raises(PresetError, match='preset lecture/copper: unknown key "eta"'):
        find("copper").with_parameters(eta=1.5)


GLASS = 'name = "G"\nmodel = "glass"\nm = 0.1\neta = 1.5\n[source]\ndata = "x"\n'
ROUGH = 'name = "R"\nmodel = "oren_nayar"\nalbedo = [0.5, 0.5, 0.5]\nsigma = 0.3\n[source]\ndata = "x"\n'


def test_a_preset_says_whether_light_goes_through():
    """Glass is transparent; reflections and rough surfaces are opaque."""
    assert parse(GLASS, "a/g", "g").transparent
    assert not parse(ROUGH, "a/r", "r").transparent
    assert not find("lecture/water").transparent
    assert find("liquids/water").transparent


def test_presets_of_every_model_give_the_model_of_the_reference():
    """With the numbers that they hold, and the kind."""
    assert parse(GLASS, "a/g", "g").reference() == Glass(0.1, 1.5, (1.0, 1.0, 1.0))
    assert parse(GLASS.replace("m =", 'kind = "thin"\nm ='), "a/g", "g").reference().thin
    assert parse(ROUGH, "a/r", "r").reference() == OrenNayar((0.5, 0.5, 0.5), 0.3)
    assert parse(ROUGH.replace("sigma", 'kind = "qualitative"\nsigma'), "a/r", "r").reference().qualitative


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GLASS.replace("eta = 1.5", "eta = 99"), "eta must be between 0.1 and 10, got 99"),
        (GLASS.replace("eta = 1.5\n", ""), '"eta" is missing; add eta = 1.5'),
        (GLASS.replace("m = 0.1", "m = nan"), "m must be between"),
        (GLASS.replace("m = 0.1", "sigma = 0.1"), 'unknown key "sigma"'),
        (
            GLASS.replace("m = 0.1", 'kind = "thick"\nm = 0.1'),
            'kind of glass must be one of interface, thin, got "thick"',
        ),
        (GLASS + "[fresnel]\neta = 1.5\n", "model glass takes no"),
        (GLASS.replace("m = 0.1", "tint = [1, 2, 1]\nm = 0.1"), "tint must be between 0 and 1, got 2"),
        (ROUGH.replace("[0.5, 0.5, 0.5]", "1.0"), "albedo must be between 0 and 0.95, got 1"),
        (ROUGH.replace("sigma = 0.3", "sigma = 2"), "sigma must be between 0 and 1.5708, got 2"),
        (ROUGH.replace("sigma = 0.3\n", ""), '"sigma" is missing; add sigma = 0.3'),
        (ROUGH.replace("albedo = [0.5, 0.5, 0.5]\n", ""), '"albedo" is missing'),
    ],
)
def test_bad_glass_and_bad_rough_surfaces_are_one_line(text, message):
    """What, where, and how to mend it."""
    with pytest.raises(PresetError, match=re.escape(message)) as error:
        parse(text, "a/b", "a/b.toml")
    assert str(error.value).startswith("a/b.toml: ")
    assert "\n" not in str(error.value)


FIRST_OF_KIND = {(preset.model, preset.kind): preset for preset in reversed(all_presets().values())}


@pytest.mark.parametrize("family", sorted({preset.family for preset in all_presets().values()}))
def test_no_preset_sends_back_more_than_arrives(family):
    """What is reflected and what passes through: the first of each kind at more views, and at other slopes."""
    for preset in (preset for preset in all_presets().values() if preset.family == family):
        is_first = preset in FIRST_OF_KIND.values()
        wo = spherical(np.radians([0.0, 40.0, 70.0, 85.0, 89.9] if is_first else [0.0, 85.0]))
        slopes = (0.0, 0.1, 1.0) if is_first and "m" in preset.parameters else ()
        for changed in [preset, *(preset.with_parameters(m=m) for m in slopes)]:
            sent = albedo(changed.reference(), wo)
            assert sent.shape == (len(wo), 3)
            assert np.all(sent > 0.0), preset.id
            assert np.max(sent) <= 1.0 + 1e-6, preset.id  # to which the albedo is good


@pytest.mark.parametrize("kind", ["full", "qualitative"])
def test_the_whitest_rough_surface_sends_back_no_more_than_arrives(kind):
    """At the highest albedo that a preset may have, at every sigma and view."""
    wo = spherical(np.radians([0.0, 30.0, 60.0, 75.0, 85.0, 89.0, 89.9]))
    for sigma in (0.0, 0.1, 0.2, 0.3, 0.45, 0.7, 1.0, np.pi / 2):
        preset = parse(ROUGH.replace("sigma", f'kind = "{kind}"\nsigma'), "a/r", "r")
        white = preset.with_parameters(albedo=parameter("albedo").high, sigma=sigma).reference()
        assert np.max(albedo(white, wo)) <= 1.0


def test_all_presets_are_read_in_little_more_than_their_toml_takes():
    """At most three times as long: 0.3 s where nothing else runs would be ten times. The least of five of each."""

    def least(work):
        seconds = []
        for _ in range(5):
            start = time.perf_counter()
            work()
            seconds.append(time.perf_counter() - start)
        return min(seconds)

    def toml_alone():
        for path in FOLDER.glob("*/*.toml"):
            tomllib.loads(path.read_text(encoding="utf-8"))

    assert least(lambda: load_folder(FOLDER)) < 3.0 * least(toml_alone)


def test_every_preset_that_ships_says_how_it_is_known():
    """In a word each, for the panel; looks say "by eye", and a word that is none is refused."""
    assert all(preset.evidence for preset in presets.shipped().values())
    assert presets.find("metals/copper").evidence == "Color measured, roughness by eye"
    assert presets.find("wood/oak_raw").evidence == "Color and roughness by eye"
    eyed = [one for one in presets.shipped().values() if one.source["trust"].startswith("nothing is measured")]
    assert {one.evidence for one in eyed} == {"Color and roughness by eye"}
    text = 'name = "A"\nmodel = "cook_torrance"\nm = 0.1\n[fresnel]\neta = 1.5\n[source]\ndata = "here"\n'
    assert presets.parse(text, "a/a", "a").evidence == ""
    with pytest.raises(presets.PresetError, match="colour must be one of measured, computed, quoted, by eye"):
        presets.parse(text + 'colour = "guessed"\n', "a/a", "a")
