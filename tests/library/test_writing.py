# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the user's own: a folder that VGROOVE_PRESETS names, saving, and whatever else may lie there."""

import os
import subprocess
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgroove.addon.library import checks as preset_checks
from vgroove.addon.library import presets
from vgroove.addon.library import writing as preset_files
from vgroove.addon.library.presets import PresetError, all_presets, find, parse

COPPER = find("lecture/copper")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The user's folder, empty."""
    monkeypatch.setenv(presets.USER_FOLDER, str(tmp_path))
    presets.reread()
    yield tmp_path
    presets.reread()


def named(text="My Copper", **changes):
    return preset_files.dumps(COPPER.with_parameters(**changes)).replace('"Copper"', f'"{text}"')


def test_a_preset_written_is_read_back_as_it_was():
    for preset in all_presets().values():
        assert parse(preset_files.dumps(preset), preset.id, "x") == preset


def test_presets_of_the_user_are_found_beside_those_that_ship(folder):
    """Right in the folder, or in a family's; and what does not hold is named, when asked for by name too."""
    (folder / "Cloth").mkdir()
    (folder / "my_copper.toml").write_text(named(m=0.5), encoding="utf-8")
    (folder / "Cloth" / "café.toml").write_text(named("Café"), encoding="utf-8")
    (folder / "bad.toml").write_text(named(m=0.5).replace("m = 0.5", "m = -1"), encoding="utf-8")
    assert find("mine/my_copper").m == find("my_copper").m == 0.5
    assert find("Cloth/café").name == "Café"
    assert find("lecture/copper") == COPPER
    (error,) = presets.load_errors()
    assert "m must be between 0.0001 and 10 (or 0, a smooth interface), got -1" in str(error)
    with pytest.raises(PresetError, match="m must be between"):
        find("bad")


def test_presets_of_the_user_do_not_stand_in_for_others(folder):
    """Two of one id, also where only case tells them apart, would make a render depend on the machine."""
    (folder / "Lecture").mkdir()
    (folder / "Lecture" / "COPPER.toml").write_text(named(m=0.5), encoding="utf-8")
    (error,) = presets.load_errors()
    assert "there is a preset lecture/copper already; rename the file" in str(error)
    assert find("copper") == COPPER


def test_the_folder_may_be_below_ones_home(folder, monkeypatch):
    (folder / "own").mkdir()
    (folder / "own" / "my_copper.toml").write_text(named(m=0.5), encoding="utf-8")
    monkeypatch.setenv("HOME", str(folder))
    monkeypatch.setenv(presets.USER_FOLDER, "~/own")
    assert find("mine/my_copper").m == 0.5


def test_a_folder_that_is_not_there_is_said(folder, monkeypatch):
    monkeypatch.setenv(presets.USER_FOLDER, str(folder / "nowhere"))
    (error,) = presets.load_errors()
    assert "nowhere is no folder" in str(error)
    assert find("copper") == COPPER


@pytest.mark.parametrize(
    ("name", "file"),
    [
        ("My Copper", "my_copper"),
        ("../../etc/passwd", "etc_passwd"),
        ("C:\\\\con", "c_con"),
        ("Grün  ☃", "grün"),
        ("...", "preset"),
    ],
)
def test_saved_presets_stay_in_the_folder(folder, name, file):
    """Whatever the name, under a plain one; and never over another."""
    preset = parse(named(name, m=0.4), "mine/x", "x")
    saved = preset_files.save(preset, folder)
    assert saved.id == f"mine/{file}"
    assert find(saved.id) == saved
    assert [path.name for path in folder.rglob("*")] == [f"{file}.toml"]
    with pytest.raises(PresetError, match="already; give this one another name"):
        preset_files.save(preset, folder)


def test_a_changed_preset_keeps_what_is_still_true_of_it(folder):
    """Not the slopes that suit it where m is not among them, nor the reflectance of other constants."""
    satin = find("finished_metals/copper_satin")
    assert satin.with_parameters(m=0.12).m_range == satin.m_range
    changed = satin.with_parameters(m=0.5, k=4.0)
    assert changed.m_range is None
    assert changed.verified == {}
    assert preset_files.save(changed, folder).parameters == changed.parameters
    assert satin.with_parameters(m=satin.m) is satin


def test_a_preset_file_is_taken_in(folder, tmp_path_factory):
    """By its name; a file that does not hold is refused and leaves nothing."""
    given_file = tmp_path_factory.mktemp("given") / "x.toml"
    given_file.write_text(named("Roof"), encoding="utf-8")
    assert preset_files.import_file(given_file, folder).id == "mine/roof"
    given_file.write_text("name = 3", encoding="utf-8")
    with pytest.raises(PresetError, match="name must be a text"):
        preset_files.import_file(given_file, folder)
    assert [path.name for path in folder.iterdir()] == ["roof.toml"]
    with pytest.raises(PresetError, match="name must be a text"):
        preset_files.import_file(given_file, folder / "new")
    assert not (folder / "new").exists()
    given_file.write_text(named("Roof"), encoding="utf-8")
    assert (
        preset_files.import_file(given_file, folder / "new").id == "mine/roof"
    )  # the folder is made when it is needed


# Malformed files

NASTY = [
    "nan",
    "inf",
    "-inf",
    "-1",
    "1e300",
    "9" * 400,
    "9" * 5000,
    '"text"',
    "true",
    "[]",
    "[[[]]]",
    "{}",
    "1979-05-27",
]
NASTY += [
    "[1, 2]",
    '["a", "b", "c"]',
    "[nan, 0.1, 0.1]",
    "{ a = 1 }",
    "[0.1, 0.2, 0.3, 0.4]",
    "'\\u0000'",
    '"\\u0007\\n"',
]
DEEP = "[" * 5000 + "]" * 5000
WHOLE = [preset_files.dumps(find(name)) for name in ("lecture/copper", "metals/gold", "liquids/water", "diffuse/clay")]
WHOLE += [preset_files.dumps(find(name)) for name in ("plastics/red_plastic", "car_paints/blue", "translucent/cream")]
KEYS = sorted({line.split(" = ")[0] for text in WHOLE for line in text.splitlines() if " = " in line})


def hand_made():
    """Every key of a preset with every value that it should not have, and texts that are no preset at all."""
    texts = ["", "\x00", "\ufeff" + WHOLE[0], "= 1", "name", "[[[", "name = 'x'", f"a = {DEEP}", "é = 1", '"\\n" = 1']
    texts += [
        WHOLE[0].replace("[fresnel]", f"[fresnel.{'.'.join('a' * 3000)}]"),
        WHOLE[0] * 2,
        WHOLE[0] + "#" * 200_000,
    ]
    texts += [WHOLE[0].replace('"Copper"', f'"{name}"') for name in ("", " ", "x" * 61, "\\u001b[31m", "a\\nb")]
    texts += [f'{WHOLE[0]}"{key}" = 1\n' for key in ("../x", "\\u0000", "x" * 10_000, "__class__")]
    for text in WHOLE:
        for line in text.splitlines():
            if " = " in line:
                texts.append(text.replace(f"\n{line}\n", "\n", 1))
                texts += [text.replace(line, f"{line.split(' = ')[0]} = {bad}", 1) for bad in (*NASTY, DEEP)]
    return texts


def assert_one_clear_line(text):
    """Either it is a preset that reads back, or one printable line says where and what."""
    try:
        held = parse(text, "a/b", "a/b.toml")
    except PresetError as error:
        line = str(error)
        assert line.startswith("a/b.toml: ")
        assert line.isprintable()
        assert len(line) <= preset_checks.LONGEST_MESSAGE
        return False
    assert parse(preset_files.dumps(held), "a/b", "a/b.toml") == held
    return True


def test_malformed_presets_made_by_hand_are_one_clear_line():
    """Well over 200, and nearly none of them passes: a date as a note, an empty list of tags."""
    texts = hand_made()
    refused = [text for text in texts if not assert_one_clear_line(text)]
    assert len(refused) > 200
    assert len(refused) > 0.8 * len(texts)


@settings(max_examples=400, deadline=None)
@given(st.data())
def test_malformed_presets_made_at_random_are_one_clear_line(data):
    """Lines dropped, doubled, cut, given other values."""
    lines = data.draw(st.sampled_from(WHOLE)).splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        index = data.draw(st.integers(0, len(lines) - 1))
        key = lines[index].split(" = ")[0]
        change = data.draw(st.sampled_from(["drop", "double", "cut", "value", "key", "text"]))
        lines[index : index + 1] = {
            "drop": [],
            "double": [lines[index]] * 2,
            "cut": [lines[index][: data.draw(st.integers(0, len(lines[index])))]],
            "value": [f"{key} = {data.draw(st.sampled_from([*NASTY, DEEP]) | st.floats().map(repr))}"],
            "key": [f"{data.draw(st.sampled_from(KEYS))} = {data.draw(st.sampled_from(NASTY))}"],
            "text": [data.draw(st.text(max_size=40))],
        }[change]
        lines = lines or [""]
    assert_one_clear_line("\n".join(lines))


def test_a_folder_of_malformed_presets_is_listed_without_them(folder):
    """By the command: one line each, the rest listed, exit code 0, no file changed or added."""
    (folder / "good.toml").write_text(named(), encoding="utf-8")
    for index, text in enumerate(hand_made()[:250]):
        (folder / f"bad_{index}.toml").write_text(text, encoding="utf-8")
    (folder / "latin.toml").write_bytes(named().encode().replace(b"My", b"\xff"))
    (folder / "no name \n.toml").write_text(named(), encoding="utf-8")
    (folder / "folder.toml").mkdir()
    (folder / "gone.toml").symlink_to(folder / "nothing")
    before = {path: path.lstat().st_mtime_ns for path in folder.rglob("*")}
    command = [
        sys.executable,
        "-c",
        "import sys; from vgroove.cli import main; sys.argv[1:] = ['presets', 'good', '--json']; main()",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | {"TERM": "dumb"})
    assert done.returncode == 0
    assert '"mine/good"' in done.stdout
    lines = done.stderr.splitlines()
    assert len(lines) > 200
    assert all(line.startswith("vgroove: preset skipped: ") for line in lines)
    assert {path: path.lstat().st_mtime_ns for path in folder.rglob("*")} == before
