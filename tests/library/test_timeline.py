# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets that change over time: their files, their moments, and what is refused."""

import re

import numpy as np
import pytest

from vgroove.addon.library import writing as preset_files
from vgroove.addon.library.checks import PresetError
from vgroove.addon.library.presets import all_presets, find, parse, shipped
from vgroove.addon.reference import place_keys

CHANGING = {preset.id: preset for preset in shipped().values() if preset.time}
TEXT = """name = "Test"
model = "sum"
d = 0.5
s = 0.5
albedo = [0.8, 0.2, 0.1]
sigma = 0.3
m = 0.1
[fresnel]
f0 = [0.9, 0.6, 0.5]
[source]
data = "test"
[time]
unit = "h"
range = [1.0, 11.0]
kind = "authored"
[time.m]
law = "keys"
times = [6.0, 11.0]
values = [0.4, 0.2]
[time.albedo]
law = "exponential"
end = 0.5
rate = 0.4
[time.sigma]
law = "polynomial"
coefficients = [0.1, -0.01]
"""


def read(text=TEXT):
    return parse(text, "test/test", "x.toml")


def test_there_are_presets_for_every_stage_of_trust():
    """At least twelve, each with a source, marked measured, fitted or authored."""
    assert len(CHANGING) >= 12
    assert {preset.time.kind for preset in CHANGING.values()} == {"measured", "fitted", "authored"}
    for preset in CHANGING.values():
        assert preset.time.kind in preset.source["trust"] or preset.time.kind == "fitted", preset.id
        assert "time" in preset.tags
        if "Sun" in preset.source["data"]:  # their text could not be read
            assert "not verified" in preset.source["data"]


def test_a_preset_is_what_its_laws_say_at_any_time():
    """From its own numbers at the start; slopes go geometrically, colours straight in linear light."""
    preset = read()
    assert preset.at(1.0).parameters == preset.parameters
    assert preset.at(3.5).m == pytest.approx(0.2, abs=1e-12)
    assert preset.at(6.0).m == pytest.approx(0.4, abs=1e-12)
    assert preset.at(8.5).m == pytest.approx(0.4**0.5 * 0.2**0.5, abs=1e-12)
    expected = 0.5 + (np.array([0.8, 0.2, 0.1]) - 0.5) * np.exp(-0.4 * 2.0)
    np.testing.assert_allclose(preset.at(3.0).parameters["albedo"], expected, atol=1e-12)
    assert preset.at(4.0).parameters["sigma"] == pytest.approx(0.3 + 0.1 * 3.0 - 0.01 * 9.0, abs=1e-12)
    assert preset.at(-5.0) == preset.at(1.0)
    assert preset.at(50.0) == preset.at(11.0)
    assert preset.at(3.0).time is None


def test_rusting_iron_is_its_table():
    """To the digits of the measured means, with F = 1."""
    preset = find("time_varying/rusting_iron")
    at = preset.at(0.25).parameters
    np.testing.assert_allclose(np.array(at["albedo"]) * at["d"], [0.11809, 0.08809, 0.06673], atol=1e-6)
    assert at["s"] == pytest.approx(0.05986, abs=1e-6)
    assert at["m"] == pytest.approx(0.15281, abs=1e-6)
    assert preset.parameters["f0"] == (1.0, 1.0, 1.0)


@pytest.mark.parametrize("identity", CHANGING)
def test_every_course_holds_together(identity):
    """At any time a model that the reference takes: weights that share the light, colours and slopes in range."""
    preset = CHANGING[identity]
    for time in np.linspace(preset.time.start, preset.time.end, 101):
        preset.at(float(time)).reference()
    course = preset.trajectory()
    for name in course.laws:
        assert np.ptp(course.value(name, np.linspace(course.start, course.end, 101)), axis=0).max() > 0.0, name


@pytest.mark.parametrize("interpolation", ["linear", "shape"])
@pytest.mark.parametrize("identity", CHANGING)
def test_the_keys_of_every_preset_stay_within_a_thousandth(identity, interpolation):
    """Of each parameter's range; the straight ones in 60 keys at most."""
    course = CHANGING[identity].trajectory()
    t = course.start + (course.end - course.start) * np.concatenate(
        [np.linspace(0, 1, 5001), np.geomspace(1e-9, 1, 5001)]
    )
    for name in course.laws:
        keys = place_keys(course, name, 1e-3, interpolation)
        law = course.value(name, t)
        assert np.abs(keys(t) - law).max() <= 1e-3 * np.ptp(law, axis=0).max() * (1.0 + 1e-9)
        assert 2 <= keys.times.size <= 60


def test_a_changing_preset_is_written_and_read_back():
    """Also those that ship."""
    for preset in [read(), *CHANGING.values()]:
        again = parse(preset_files.dumps(preset), preset.id, "again.toml")
        assert again == preset


def test_what_is_given_a_value_no_longer_changes():
    """And where nothing is left to change, the preset stands still."""
    preset = read()
    held = preset.with_parameters(m=0.1)
    assert set(held.time.laws) == {"albedo", "sigma"}
    assert held.at(6.0).m == 0.1
    assert preset.with_parameters(m=0.2, albedo=0.5, sigma=0.0).time is None


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('unit = "h"', 'unit = "fortnights"', "[time]: unit must be one of s, min, h, days"),
        ('unit = "h"', "", '[time]: "unit" is missing; add unit = "days"'),
        ('kind = "authored"', 'kind = "guess"', "[time]: kind must be one of measured, fitted, authored, got 'guess'"),
        ("range = [1.0, 11.0]", "range = [11.0, 1.0]", "[time]: range must be two times, the later one last"),
        ("range = [1.0, 11.0]", "range = [1.0, inf]", "range must be between -1e+09 and 1e+09, got inf"),
        ("range = [1.0, 11.0]", "range = 3", "range must be a list, got 3"),
        ("[time.m]", "[time.n]", '[time]: unknown key "n"'),
        ("[time.sigma]", "[time.sgma]", 'unknown key "sgma"; did you mean "sigma"?'),
        ('law = "keys"', 'law = "wave"', "[time]: m: law must be one of exponential, reciprocal, logistic"),
        ('law = "keys"', "", "m: law must be one of"),
        ("times = [6.0, 11.0]", "times = [6.0, 12.0]", "times must be one for each value, after 1 and up to 11"),
        ("times = [6.0, 11.0]", "times = [11.0, 6.0]", "times must ascend"),
        ("times = [6.0, 11.0]", "times = [6.0]", "times must be one for each value"),
        ("values = [0.4, 0.2]", "values = [0.4, 0.0]", "a slope cannot become 0; use 0.0001 or more"),
        ("values = [0.4, 0.2]", "values = [0.4, 20.0]", "m must be between 0.0001 and 10"),
        ("values = [0.4, 0.2]", "values = []", "values must be 1 to 256, got 0"),
        ("values = [0.4, 0.2]", 'values = [0.4, "x"]', "m must be a number, got 'x'"),
        ("m = 0.1", "m = 0.0", "m is 0, a smooth interface, which cannot change"),
        ("rate = 0.4", "rate = -1.0", "rates must be greater than 0, got -1"),
        ("rate = 0.4", "", '"rate" is missing; law "exponential" needs end, rate'),
        ("rate = 0.4", "rates = [1.0, 2.0]\nshares = [0.5, 0.6]", "shares must be one for each of 2 rates"),
        ("rate = 0.4", "rate = 0.4\nsped = 3", 'unknown key "sped"'),
        ("end = 0.5", "end = [0.5, 0.5]", "albedo must be one number or three (R, G, B)"),
        ("end = 0.5", "end = 2.0", "albedo must be between 0 and 0.95, got 2"),
        ("coefficients = [0.1, -0.01]", "coefficients = [nan]", "coefficients must be between"),
        (TEXT[TEXT.index("[time.sigma]") :], '[time.s]\nlaw = "power"\nend = 0.9\nexponent = 1',
         "at time 1.3125: d + s must be at most 1, or more light would leave than arrives"),
    ],
    ids=str,
)  # fmt: skip
def test_a_course_that_does_not_hold_is_one_line(old, new, complaint):
    """What, where, and how to mend it."""
    assert old in TEXT
    with pytest.raises(PresetError, match=re.escape(complaint)) as caught:
        read(TEXT.replace(old, new, 1))
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith("x.toml: ")


def test_a_table_of_time_without_laws_is_refused():
    text = TEXT[: TEXT.index("[time.m]")]
    with pytest.raises(PresetError, match=r"nothing changes; add a table such as \[time.d\]"):
        read(text)


def test_what_stands_still_has_no_moments():
    with pytest.raises(PresetError, match="does not change over time"):
        find("lecture/copper").trajectory()
    assert all(preset.time is None for preset in all_presets().values() if preset.family != "time_varying")
