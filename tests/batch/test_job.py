# SPDX-License-Identifier: GPL-3.0-or-later
"""Job files: what they stand for, what a task's name depends on, and what is turned away in one line."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from vgroove import cli
from vgroove.addon.library.checks import LONGEST_MESSAGE, PresetError
from vgroove.addon.library.presets import find
from vgroove.addon.models import MeasuredTable
from vgroove.batch import results
from vgroove.batch.job import DEFAULTS, JobError, load, parse

VERSIONS = {"vgroove": "0.1.0", "blender": "5.2.3"}


def tasks(table, folder=Path()):
    return parse("[[render]]\n" + table, "job.toml", folder)


def test_one_preset_is_one_task():
    """With the command line's defaults."""
    (task,) = tasks('preset = "copper"')
    assert task.assignments == (("Ball", find("lecture/copper")),)
    assert (task.scene, task.backend, task.estimator, task.samples, task.seed) == ("preview", "nodes", "auto", 128, 0)
    assert task.resolution == (640, 480)
    assert task.outputs == ("exr",)


def test_lists_are_axes_of_a_grid():
    """Every combination once, the last key fastest; labels say where each stands."""
    found = tasks('preset = ["copper", "gold"]\nset.m = [0.1, 0.2, 0.3]\nseed = [0, 1]\nresolution = "64x48"')
    assert len(found) == 12
    assert [(task.assignments[0][1].id, task.assignments[0][1].m, task.seed) for task in found[:3]] == [
        ("lecture/copper", 0.1, 0), ("lecture/copper", 0.1, 1), ("lecture/copper", 0.2, 0)
    ]  # fmt: skip
    assert found[-1].label == f"{find('gold').id}, m 0.3, seed 1"
    assert len({task.identity(VERSIONS) for task in found}) == 12


def test_a_colour_is_one_value_and_a_list_of_colours_an_axis():
    """As a preset file writes it."""
    (task,) = tasks('preset = "copper"\nset.f0 = [0.9, 0.6, 0.5]')
    assert task.assignments[0][1].parameters["f0"] == (0.9, 0.6, 0.5)
    found = tasks('preset = "copper"\nset.f0 = [[0.9, 0.6, 0.5], [0.5, 0.5, 0.5]]')
    assert [task.assignments[0][1].parameters["f0"] for task in found] == [(0.9, 0.6, 0.5), (0.5, 0.5, 0.5)]


def test_tables_add_up_and_what_is_twice_there_is_once():
    """Two tables that overlap."""
    text = '[[render]]\npreset = "copper"\nseed = [0, 1]\n[[render]]\npreset = ["copper", "gold"]\nseed = 1\n'
    assert len(parse(text, "job.toml", Path())) == 3


def test_times_and_frames_show_moments_of_a_course():
    """Each task has a material that stands still; a frame is as far through the course as through the frames."""
    iron = find("rusting_iron")
    moments = [task.assignments[0][1] for task in tasks('preset = "rusting_iron"\ntime = [0.0, 0.25, 1.0]')]
    frames = [task.assignments[0][1] for task in tasks('preset = "rusting_iron"\nframes = "1-5"')]
    assert all(one.time is None for one in moments + frames)
    for one, time in zip(moments, (0.0, 0.25, 1.0), strict=True):
        assert one.parameters == iron.at(time).parameters
    assert frames[0].parameters == moments[0].parameters
    assert frames[1].parameters == moments[1].parameters
    assert frames[-1].parameters == moments[-1].parameters
    (start,) = tasks('preset = "rusting_iron"')
    assert start.assignments[0][1].parameters == iron.parameters


def test_presets_that_stand_still_do_not_mind_the_time_of_others():
    """They are rendered once, as their tasks are the same."""
    assert len(tasks('preset = ["copper", "rusting_iron"]\ntime = [0.0, 1.0]')) == 3


def test_a_scene_is_named_by_its_content(tmp_path):
    """The same bytes under another name are the same task, other bytes another; the scene lies beside the job."""
    for name, content in (("a", b"one"), ("b", b"one"), ("c", b"two")):
        (tmp_path / f"{name}.blend").write_bytes(content)
    table = 'preset = "copper"\nobject = "Gate"\nassign = {{Floor = "gold"}}\nscene = "{}.blend"'
    (tmp_path / "job.toml").write_text("[[render]]\n" + table.format("a"))
    (of_file,) = load(tmp_path / "job.toml")
    a, b, c = (tasks(table.format(name), tmp_path)[0] for name in "abc")
    assert [name for name, _ in a.assignments] == ["Floor", "Gate"]
    assert of_file.identity(VERSIONS) == a.identity(VERSIONS) == b.identity(VERSIONS) != c.identity(VERSIONS)
    assert tasks('scene = "a.blend"', tmp_path)[0].assignments == ()


def test_the_job_of_the_documentation_holds(tmp_path):
    """12 stills, 48 frames and 8 of a scene."""
    text = (Path(__file__).parents[2] / "docs" / "batch.md").read_text(encoding="utf-8")
    (tmp_path / "hall.blend").write_bytes(b"")
    (job,) = re.findall(r"```toml\n(.*?)```", text, flags=re.DOTALL)
    assert len(parse(job, "docs/batch.md", tmp_path)) == 12 + 48 + 8
    keys, columns = (text.partition(head)[2].partition("\n\n")[0] for head in ("| key |", "| column |"))
    assert set(re.findall(r"^\| `(\w+)", keys, flags=re.MULTILINE)) | {"resolution"} == set(DEFAULTS)
    assert set(re.findall(r"`(\w+)`(?=[^|]*\|[^|]*\|$)", columns, flags=re.MULTILINE)) == set(results.HEAD)


def test_a_task_of_two_tables_has_the_outputs_of_both():
    """And is one task."""
    table = '[[render]]\npreset = "copper"\noutput = '
    (task,) = parse(table + '"exr"\n' + table + '["png", "exr"]\n', "job.toml", Path())
    assert task.outputs == ("exr", "png")


def test_one_scene_of_two_names_is_refused(tmp_path):
    """Their textures may differ, which would be one still."""
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "hall.blend").write_bytes(b"1")
    with pytest.raises(JobError, match="are the same file, and would be one still; name one of them"):
        tasks('scene = ["a/hall.blend", "b/hall.blend"]', tmp_path)


def test_an_object_gets_one_preset(tmp_path):
    """Not one by preset and another by assign."""
    (tmp_path / "a.blend").write_bytes(b"")
    with pytest.raises(JobError, match='"Gate" is the object of preset and in assign too'):
        tasks('preset = "copper"\nobject = "Gate"\nassign = {Gate = "gold"}\nscene = "a.blend"', tmp_path)


def test_a_task_is_named_by_all_that_decides_its_pixels_and_nothing_else():
    """Each change of what decides them gives another name; names and sources of presets do not."""
    (task,) = tasks('preset = "copper"')
    name = task.identity(VERSIONS)
    copper = task.assignments[0][1]
    same = [
        replace(task, assignments=(("Ball", replace(copper, id="a/b", name="B", source={}, notes="n", tags=("t",))),)),
        replace(task, outputs=("png",), labels=()),
        replace(task, scene="elsewhere"),
        replace(task, frame=2),  # of the preview scene, where nothing else moves
    ]
    assert all(one.identity(VERSIONS) == name for one in same)
    other = [
        replace(task, assignments=(("Ball", copper.with_parameters(m=0.31)),)),
        replace(task, assignments=(("Ball", replace(copper, table=MeasuredTable("a.binary", "0" * 64))),)),
        replace(task, assignments=(("Ball", replace(copper, table=MeasuredTable("a.binary", "1" * 64))),)),
        replace(task, assignments=(("Gate", copper),)),
        replace(task, digest="0" * 64),
        replace(task, digest="0" * 64, frame=2),
        replace(task, backend="osl"),
        replace(task, estimator="mirror"),
        replace(task, bound=0.01),
        replace(task, samples=64),
        replace(task, samples=None, error=0.1),
        replace(task, samples=None, error=0.05),
        replace(task, seed=1),
        replace(task, resolution=(64, 64)),
    ]
    moved = replace(task, assignments=(("Ball", replace(copper, table=MeasuredTable("b.binary", "1" * 64))),))
    assert moved.identity(VERSIONS) == other[2].identity(VERSIONS)  # the same table in another place
    names = {name, task.identity(VERSIONS | {"blender": "4.5.15"}), *(one.identity(VERSIONS) for one in other)}
    assert len(names) == len(other) + 2
    assert replace(task, dispersion=True).identity(VERSIONS) == name  # copper has no Abbe number
    glass = replace(task, assignments=(("Ball", find("gems/diamond")),))
    assert replace(glass, dispersion=True).identity(VERSIONS) != glass.identity(VERSIONS)
    mirror = replace(task, estimator="mirror")  # which has no bound
    assert replace(mirror, bound=0.01).identity(VERSIONS) == mirror.identity(VERSIONS)


WRONG_VALUES = (
    "-1",
    "0",
    "1.5",
    "nan",
    "inf",
    "1e400",
    "true",
    '""',
    '"x"',
    "[]",
    "{}",
    "[[]]",
    "9" * 400,
    "2000-01-01",
)
MALFORMED = [
    *(f"preset = {value}" for value in ("-1", "true", '""', '"x"', "[]", "{}", "[[]]", '"meta/gold"', "2000-01-01")),
    *(f'preset = "copper"\nsamples = {value}' for value in WRONG_VALUES),
    *(f'preset = "copper"\nseed = {value}' for value in WRONG_VALUES if value != "0"),
    *(f'preset = "copper"\nbound = {value}' for value in WRONG_VALUES),
    *(f'preset = "copper"\ndispersion = {value}' for value in WRONG_VALUES if value != "true"),
    *(f'preset = "copper"\nerror = {value}' for value in WRONG_VALUES),
    *(f'preset = "copper"\nbackend = {value}' for value in WRONG_VALUES),
    *(f'preset = "copper"\nestimator = {value}' for value in WRONG_VALUES),
    *(f'preset = "copper"\nresolution = {value}' for value in WRONG_VALUES),
    *(f'preset = "copper"\noutput = {value}' for value in WRONG_VALUES),
    *(f'preset = "copper"\nset.m = {value}' for value in WRONG_VALUES if value not in {"0", "1.5"}),
    *(f'preset = "copper"\nset.f0 = {value}' for value in WRONG_VALUES if value != "0"),
    *(f'preset = "rusting_iron"\nframes = {value}' for value in (*WRONG_VALUES, '"5-1"', '"1"') if value != '""'),
    *(f'preset = "rusting_iron"\ntime = {value}' for value in ("nan", "inf", "true", '"x"', "{}", "[[]]")),
    *(f'preset = "copper"\nscene = {value}' for value in WRONG_VALUES),
    'preset = "copper"\nset.eta = 1.5',
    'preset = "copper"\ntime = 0.5',
    'preset = "rusting_iron"\ntime = 0.5\nframes = "1-4"',
    'preset = "copper"\nobject = "Ball"',
    'preset = "copper"\nassign = {Ball = "gold"}',
    'preset = "copper"\nassign = 1',
    'preset = "copper"\nsample = 16',
    'preset = "copper"\nsamples = 16\nerror = 0.1',
    'preset = "copper"\nset = 1',
    "",
    "set.m = 0.2",
    'preset = "copper"\nframes = "1-100000"\nseed = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]',
    'preset = "copper',
    'preset = "copper"\npreset = "gold"',
]


@pytest.mark.parametrize("table", MALFORMED)
def test_what_does_not_hold_is_one_line(table):
    """That names the file, and the table if it could be read so far."""
    with pytest.raises(PresetError, match=r"^job\.toml: ") as caught:
        tasks(table)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) <= LONGEST_MESSAGE


@pytest.mark.parametrize("table", MALFORMED[::10])
def test_the_command_ends_with_it_and_exit_code_2(table, tmp_path, capsys, monkeypatch):
    """And has written nothing. Each tenth, as the command only passes on what the test above looks at."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.toml").write_text("[[render]]\n" + table, encoding="utf-8")
    assert cli.run(lambda: cli.app(["batch", "job.toml", "-o", "out"], standalone_mode=False)) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("vgroove: job.toml: ")
    assert said.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["job.toml"]


def test_there_are_a_hundred_of_them():
    """As the promise is."""
    assert len(set(MALFORMED)) >= 100


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"", "nothing to render"), (b"render = 1", "render must be a list"), (b"render = [1]", "must be a table"),
     (b"\xff\xfe", "cannot be read"), (b"renders = []", 'did you mean "render"?'), (b"#" * 1_000_001, "larger than")],
)  # fmt: skip
def test_files_that_are_no_jobs_are_one_line(tmp_path, content, message):
    """Empty, of another form, of other bytes, too large."""
    path = tmp_path / "job.toml"
    path.write_bytes(content)
    with pytest.raises(PresetError, match=message):
        load(path)
    with pytest.raises(JobError, match="cannot be read"):
        load(tmp_path / "none.toml")
