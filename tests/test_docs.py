# SPDX-License-Identifier: GPL-3.0-or-later
"""Documents: examples run, links and paths exist, and every figure comes from the report."""

import doctest
import re
import textwrap
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vgroove.addon.blender import material
from vgroove.addon.library import parsing, presets
from vgroove.lab.bench import figures
from vgroove.lab.bench.record import ReportError
from vgroove.lab.report import documents, published, summary

ROOT = Path(__file__).parent.parent
PAGES = ["README.md", "CONTRIBUTING.md", *sorted(str(p.relative_to(ROOT)) for p in (ROOT / "docs").rglob("*.md"))]


def test_the_examples_in_the_readme_give_what_they_show():
    failed, tried = doctest.testfile(str(ROOT / "README.md"), module_relative=False)
    assert tried >= 4
    assert failed == 0


@pytest.mark.parametrize("page", PAGES)
def test_links_and_pictures_are_there(page):
    path = ROOT / page
    for target in re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8")):
        assert (path.parent / target).is_file(), target


FOLDERS = "addon|batch|cli|docs|headless|lab|nodegroups|osl|presets|tests|tools|viewer"
PATH = re.compile(rf"(?<![\w./-])(?:{FOLDERS})/[\w./*-]*[\w*/]|(?<=`)[\w*-]+/[\w./*-]+\.(?:py|osl|h|toml|csv|md)(?=`)")


@pytest.mark.parametrize("page", [*PAGES, "CHANGELOG.md"])
def test_every_path_names_what_is_in_the_tree(page):
    """In prose, backquotes and commands. Words in capitals stand for any name: presets/FAMILY/MATERIAL.toml.

    A path on a line of its own names the file that the page shows next.
    """
    text = (ROOT / page).read_text(encoding="utf-8")
    for path in PATH.findall(re.sub(r"^`[\w/.]+`$", "", text, flags=re.MULTILINE)):
        assert any(ROOT.glob(re.sub(r"[A-Z]{3,}", "*", path))), path


@pytest.mark.blender
def test_the_script_in_the_readme_builds_its_material(blender):
    """As in Blender, which loads the package under another name (tests/test_package.py)."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    (script,) = (block for block in blocks if "bl_ext" in block)
    blender.ops.mesh.primitive_cube_add()
    exec(script.replace("bl_ext.user_default.vgroove", "vgroove"), {})  # noqa: S102
    made = blender.context.object.active_material
    assert material.preset_of(made).id == "metals/copper"
    assert material.values_of(made)["m"] == pytest.approx(0.2)


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md"])
def test_every_make_target_that_is_named_exists(page):
    targets = set(re.findall(r"^([a-z0-9.-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE))
    named = set(
        re.findall(r"(?:^    |`)make ([a-z0-9.-]+)", (ROOT / page).read_text(encoding="utf-8"), flags=re.MULTILINE)
    )
    assert named
    assert named <= targets


# Figures that no report measures: page, the words around the figure, where it comes from.
GIVEN = {
    "README.md": {"about 350 MB": "the size of Blender's wheel"},
    "docs/batch.md": {
        "noise of 2 %": "an example of what is asked for",
        "at most 1 MB": "a limit of batch.job",
    },
    "docs/colour.md": {
        "less than 0.4 %": "a bar of tests/blender/test_colour_space.py",
        "at most 0.008": "a bar of tests/blender/test_colour_space.py",
        "at most 0.25": "a bar of tests/blender/test_colour_space.py",
    },
    "docs/estimators.md": {
        "within 0.5 %; in": "what tests/blender/test_bounces.py holds it to",
        "within 0.8 % by": "the same",
        "takes 1.5 times": "of CPU time, once, on Blender 5.2",
        "within 0.5 % of the reflected light": "the default bound of hybrid",
        "from 0.1 to 5 %": "the range of that bound",
        "albedo of Fit is within 1.5 % of": "a bar of tests/choose/test_advice.py",
        "up to 0.01 on average": "a bar of tests/choose/test_advice.py",
        "slope m up to 0.075": "advice.SHARPEST, as in Cycles",
        "| −5.5 % | −2.5 % | +5 % | +32 % |": "what tests/blender/test_bump.py measures",
        "| −6 % | −4.5 % | −0.5 % | +17 % |": "what tests/blender/test_bump.py measures",
        "is 30 % too bright": "what tests/blender/test_bump.py measures",
        "within 0.5 % of the peak": "a bar of tests/blender/test_eevee.py",
        "the generator 1.0 %": "what EEVEE shows of merl_fits/gold_metallic_paint3_merl in the stage of test_eevee.py",
        "sheet of steel 1.2 %": "what tests/blender/test_eevee.py measures, which allows 1.6 %",
        "| 1.3 % | 1.8 % | 4.8 % | 5.6 % |": "what tools/eevee.py measures",
        "| 0.2 % | 0.2 % | 11.1 % | 11.7 % |": "what tools/eevee.py measures",
        "| 0.3 % | 1.4 % | 9.3 % | 12.3 % |": "what tools/eevee.py measures",
        "| 6.7 % | 11.4 % | 4.8 % | 6.0 % |": "what tools/eevee.py measures",
        "| 2.3 % | 2.9 % | 11.5 % | 11.7 % |": "what tools/eevee.py measures",
        "| 0.6 % | 0.6 % | 3.2 % | 3.7 % |": "what tools/eevee.py measures",
        "| 2.4 % | 2.4 % | 11.5 % | 11.5 % |": "what tools/eevee.py measures",
        "| 1.7 % | 3.3 % | 9.1 % | 10.1 % |": "what tools/eevee.py measures",
        "| 3.9 % | 7.6 % | 4.1 % | 5.7 % |": "what tools/eevee.py measures",
        "| | | 26.0 % | 93.8 % |": "what tools/eevee.py measures",
    },
    "docs/glass.md": {"R + T = 1 to 1e-4": "a bar of tests/models/test_glass.py"},
    "docs/models/sum.md": {"at most 0.25": "addon/models/coat.HIGHEST_F0"},
    "docs/models/translucent.md": {"at most 0.25": "addon/models/coat.HIGHEST_F0"},
    "docs/oren_nayar.md": {
        "0.1 to 5 %": "the bounds that there are",
        "0.5 % unless changed": "the bound that hybrid is built with",
        "that of the model to 0.6 %": "a bar of tests/reference/test_oren_nayar.py",
    },
    "docs/presets.md": {
        "come within 1e-3": "a rule",
        "every channel to 1e-3": "a bar of tests/tools/test_make_presets.py",
        "within 0.003": "what the presets say, by tools/optical_constants.py",
    },
    "docs/testing.md": {
        "under 1e-11": "a bar of tests/reference/test_scatmech.py",
        "under 1e-12": "a bar of tests/reference/test_mpmath.py",
        "above 1e-300": "where that bar holds",
        "rounds to 6e-8": "half a unit in float32's last place, 2^-24",
        "1e-5 of a cosine": "6e-8 over the cosine of 89.7 degrees",
        "within 0.035": "advice.native_fresnel_error",
        "within 0.01": "advice.native_fresnel_error",
        "held to 10 %": "a bar",
        "m = 0.4 was 6 %": "a goal that was missed",
        "below 1 % of the picture": "what tests/reference/test_fit.py holds it to",
        "over 1 % of the picture": "the same",
        "at most 4 %": "a bar",
        "8.5 % for m <= 1": "a bar",
        "within 1 % and": "a bar",
        "albedo to 0.5 %": "what the fit is held to",
        "1 % error in D": "what must be seen",
        "two-sided 1 % level": "a level of tests",
        "99.75 %": "of a normal variable, within the limit",
        "resolves 1 %": "what must be seen",
        "red on 1 %": "what must be seen",
        "reference 1 % brighter": "what must be seen",
        "and 1 % darker": "what must be seen",
        "8 % darker": "what must be seen",
        "weight with 1 %": "what must be seen",
    },
    "docs/time.md": {
        "(0.1 % unless": "the tolerance",
        "within 1e-4 frames": "Blender's",
        "nearer than 1e-3": "what is written",
        "under 1e-12": "a bar of tests/reference/test_trajectory.py",
        "resolve 1 %": "what must be seen",
        "that is 1 % late": "what must be seen",
    },
}
FIGURE = re.compile(
    r"\d[\d.,]*(?:e-?\d+)? ?(?:%|×|times\b|per cent|ms\b|s\b|[kM]B\b)|\d(?:\.\d+)?e-\d+"
    r"|(?:within|up\sto|at\smost|gave)\s\d+\.\d+"
)
NOT_PROSE = re.compile(r"```.*?```|^    .*?$|`[^`\n]*`|\]\([^)]*\)", re.DOTALL | re.MULTILINE)


@pytest.fixture(scope="module")
def reported():
    return published.read(ROOT / published.FILE)


def test_every_figure_in_readme_and_docs_comes_from_the_report(reported):
    """What stands between marks is what the report's numbers give; and what is a figure stands between marks."""
    marked = set()
    for page in PAGES:
        if page == "docs/report.md":
            continue
        text = (ROOT / page).read_text(encoding="utf-8")
        assert documents.rewritten(text, reported) == text, f"{page}: make documents"
        marked |= {match[1] for match in documents.MARKED.finditer(text)}
        prose = NOT_PROSE.sub("", documents.MARKED.sub("", text))
        for words in GIVEN.get(page, {}):
            assert words in prose, (page, words)
            prose = prose.replace(words, "")
        assert FIGURE.findall(prose) == [], page
    assert marked == documents.FIGURES.keys()


def test_the_report_in_docs_is_a_summary_of_its_numbers(reported):
    """Of a few pages, with a plot of each kind for each Blender; the numbers are a small file."""
    text = (ROOT / "docs" / summary.FILE).read_text(encoding="utf-8")
    assert text == summary.markdown(reported)
    assert len(text.encode()) < 30_000
    assert {path.stem for path in (ROOT / "docs" / "plots").glob("*.png")} == {
        f"{kind}-{blender}" for kind in summary.PLOTS for blender in reported.runs
    }
    assert (ROOT / published.FILE).stat().st_size < published.LONGEST_FILE
    assert published.to_json(reported) == (ROOT / published.FILE).read_text(encoding="utf-8")


def test_the_report_in_docs_is_whole_and_of_the_same_code_on_every_blender(reported):
    """Else figures of different programs would stand beside each other. Quick ones have fewer measurements."""
    published.require_one_program(reported)
    assert not any(run.lacks for run in reported.runs.values())
    run = reported.default
    fewer = replace(run, keys=run.keys | {"picks": []})
    published.require_one_program(replace(reported, runs=reported.runs | {"9.9.9": replace(fewer, quick=True)}))
    for other in (replace(run, code={}), replace(run, code={}, quick=True), fewer):
        with pytest.raises(ReportError, match=r"Blender 9.9.9 and .* different"):
            published.require_one_program(replace(reported, runs=reported.runs | {"9.9.9": other}))
    with pytest.raises(ReportError, match="measure it in full"):
        published.require_one_program(replace(reported, runs={"5.2.3": replace(run, quick=True)}))


@pytest.mark.parametrize("name", ["errata", "oren_nayar", "fit"])
def test_what_is_computed_is_computed_again(name, reported):
    """Of what needs no render: to the last digit that is shown, and more."""
    for title, table in figures.measure(name).items():
        kept = reported.default.tables[name][title]
        assert kept.columns == table.columns
        np.testing.assert_allclose(kept.rows, table.rows, rtol=1e-7, atol=1e-9)


def test_what_is_no_figure_of_a_report_is_said(reported):
    mark = "<!-- report {} -->old<!-- /report -->"
    with pytest.raises(ReportError, match=r"there is no figure nothing; there are .*fit\.gentle"):
        documents.rewritten(mark.format("nothing"), reported)
    with pytest.raises(ReportError, match=r"has not measured fit\.rough"):
        documents.rewritten(mark.format("fit.rough"), replace(reported, runs={}))
    new = documents.rewritten(f"within {mark.format('fit.rough')}, never {mark.format('fit.gentle')}", reported)
    assert re.fullmatch(r"within <!-- report fit.rough -->[\d.]+ %<!-- /report -->, never .*", new)
    assert "old" not in new


def test_the_preset_that_is_shown_as_an_example_holds():
    """And so does the one at the top of the module."""
    (shown,) = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "presets.md").read_text(encoding="utf-8"), re.DOTALL)
    (other,) = re.findall(r"no bpy\.\n\n(.*?)\n\nOther models", parsing.__doc__, re.DOTALL)
    assert presets.parse(shown, "mine/old_bronze", "example").tags == ("metal", "alloy")
    assert presets.parse(textwrap.dedent(other), "mine/copper", "example").m_range == (0.02, 0.5)


def test_the_readme_says_how_many_presets_there_are():
    assert f"\n{len(presets.shipped())} presets" in (ROOT / "README.md").read_text(encoding="utf-8")
