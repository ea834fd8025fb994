# SPDX-License-Identifier: GPL-3.0-or-later
"""What the page and report.md show."""

import base64
import re
from html.parser import HTMLParser
from io import BytesIO

import numpy as np
import pytest
from matplotlib import image
from matplotlib.colors import to_rgb

from vgroove.lab.bench import record
from vgroove.lab.bench.record import ReportError
from vgroove.lab.report import claims, draw, plots, summary

from .reports import (
    MODELS,
    SAME_IN,
    accuracy,
    case,
    claimed,
    contested,
    left_out,
    only,
    report,
    runs,
    section,
)

pytestmark = pytest.mark.once


def test_what_was_left_out_is_shown_case_by_case():
    found = only({"left_out/metal": left_out(2.0), "left_out/clay": left_out(3.0)})
    metal = ["metal", "lecture/copper", "lamps", "corrected", "nodes", "2.00 ×", "1.90 to 2.10", "40 / 400"]
    assert section(found, "What was left out").rows[1] == [*metal, "", "45 / 169", "the same"]


def test_what_was_not_put_back_is_shown_but_not_measured():
    """A setup without a list has no row."""
    cells = {f"left_out/{name}": left_out(2.0) for name in ("a", "b", "c")}
    cells["left_out/b"][0]["omitted"] = []
    cells["left_out/c"][0]["omitted"] = [{"what": "time", "why": "not now"}, {"what": "body", "why": "it is hollow"}]
    found = only(cells)
    assert section(found, "Components left out").rows == [
        ["a, lamps, corrected, nodes", "time", "it is static", "93", "the same"],
        ["a, lamps, corrected, nodes", "transmission", "it is static", "93", "the same"],
        ["c, lamps, corrected, nodes", "time", "not now", "", ""],
        ["c, lamps, corrected, nodes", "body", "it is hollow", "", ""],
    ]
    assert claimed(cells)["Omitted components do"] == (SAME_IN.format(3, 3, 1), True)


def test_extreme_cases_are_shown_by_what_is_not_as_usual():
    rows = section(runs(report())[0], "Extreme cases").rows
    assert [row[:3] for row in rows] == [
        ["far", "metres", "100000"],  # failed
        ["slope", "m", "1e-06"],
        ["slope", "m", "1"],
        ["slope", "shot", "as usual"],
        ["slope", "shot", "where 1000"],
    ]


def test_a_value_is_shown_as_it_is_and_as_float32_has_it():
    """Where that is another number for a reader."""
    near = case("eta", 1.0 + 1e-9, held=1.0, resolves=0.004, error=1e-7, bar=2e-7)
    usual = case("theta", 89.99999237060547, held=float(np.float32(89.99999237060547)))
    tenth = case("m", 0.1, held=float(np.float32(0.1)))
    cases = section(only({"stability/a": [near, usual, tenth]}), "Extreme cases")
    assert [row[2] for row in cases.rows] == ["1.000000001 (1 in float32)", "89.99999237", "0.1"]
    assert cases.rows[0][7:10] == ["0.004", "1e-07", "2e-07"]
    assert all(len(row) == len(cases.columns) for row in cases.rows)
    few = case("shot", {"where": 1e5}, noise=5.0, numbers=12.25, rays=9.6, again=True)
    bare = case("shot", {}, numbers=4.0)
    rows = section(only({"stability/a": [few, bare]}), "Extreme cases").rows
    at = {name: cases.columns.index(name) for name in ("noise", "numbers")}
    assert [rows[0][at["noise"]], rows[0][at["numbers"]], rows[0][-1]] == ["5", "12 (10)", "passed by another seed"]
    assert [rows[1][at["noise"]], rows[1][at["numbers"]], rows[1][-1]] == ["", "4", "passed"]


def test_long_groups_of_cases_go_on_in_a_row_of_their_own():
    cells = {"stability/a": [case("m", float(n)) for n in range(plots.IN_A_ROW + 1)]}
    (ax,) = plots.stability(only(cells)).axes
    assert [label.get_text() for label in ax.get_yticklabels()] == ["a", ""]
    assert len(ax.patches) == plots.IN_A_ROW + 1


def test_a_report_says_how_long_it_took_and_what_it_lacks():
    content = report(cells={"left_out/metal": left_out(2.0)})
    run = content["runs"]["5.2.3"]
    assert not any(line.startswith("All of this took") for line in claims.headlines(runs(content)[0]))
    run |= {"seconds": {"left_out/metal": 150.0}, "wanted": 3}
    (found,) = runs(content)
    assert claims.headlines(found)[-1] == "All of this took 2 minutes to measure."
    said = summary.title(found.blender, quick=found.quick, lacks=found.lacks)
    assert said == "Blender 5.2.3, 2 measurements missing"


def test_factors_of_a_handful_of_hits_are_not_counted():
    cells = {"accuracy/a/b": accuracy("sun"), "accuracy/c/d": accuracy()}
    said = next(line for line in claims.headlines(only(cells)) if line.startswith("At equal time"))
    assert said.endswith("; not counted where the light is rarely hit.")
    assert re.search(r"mirror's error is \S+ × the smallest, at worst \S+ × \(softbox, copper\)", said)


def test_a_cell_of_another_make_is_named():
    content = report()
    del content["runs"]["5.2.3"]["cells"]["accuracy/softbox/copper"]["contenders"]["fit, nodes"]["noise"]
    with pytest.raises(ReportError, match=r"accuracy/softbox/copper: required field missing .*fit, nodes.*\.noise"):
        runs(content)


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))


def test_a_report_is_drawn_whole_and_the_same_each_time(tmp_path):
    """Two Blenders, nothing from elsewhere, every picture with a text, figures to the byte the same."""
    content = report(("4.5.15", "5.2.3"))
    written = draw.draw(record.structured(content), None, tmp_path)
    assert written == [tmp_path / "report.html", tmp_path / "report.md", tmp_path / "plots"]
    names = {f"{kind}-{blender}" for kind in ("error", "noise", "stability", "left_out") for blender in content["runs"]}
    assert {path.name for path in (tmp_path / "plots").iterdir()} == {f"{n}.{e}" for n in names for e in ("png", "svg")}
    assert all(path.stat().st_size < 400_000 for path in (tmp_path / "plots").iterdir())

    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    shown = [attributes for tag, attributes in Page(text).tags if tag == "img"]
    assert len(shown) == len(names)
    assert all(one["alt"] and one["src"].startswith("data:image/svg+xml;base64,") for one in shown)
    assert not re.search(r"(src|href)=.(?!data:|#)", text)
    assert not re.search(r"\{[{%]", text)
    told = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"plots/(.*?)\.png", told)) == sorted(names)
    assert text.index("Blender 5.2.3") < text.index("Blender 4.5.15")
    for words in (told, re.sub(r"base64,[^\"]*", "", text)):
        assert not re.search(r"\b(nan|inf|None)\b", words)
        assert "−0.50" in words
        assert "5 %" in words
    assert "−0.50 ± 0.00" in text
    assert "floor 5 %" in text
    assert len(told) < 30_000

    seen = image.imread(tmp_path / "plots" / "error-5.2.3.png")[..., :3].reshape(-1, 3)
    for name in MODELS:  # the legend tells them by their colours, which fewer shades keep to 2 of 255
        assert np.abs(seen - to_rgb(plots.COLOURS[name])).max(axis=1).min() < 2.5 / 255

    for name, drawn in plots.draw(runs(content)[0]).items():
        assert drawn == (tmp_path / name).read_bytes()


@pytest.mark.blender
def test_pictures_are_shown_beside_16_times_what_they_differ_by(blender, tmp_path):
    """In sRGB, as they are seen; what is brighter than white is clipped, and a picture that is gone is left out."""
    from vgroove.addon.blender import images

    reference, render = np.full((4, 4, 3), 0.2, np.float32), np.full((4, 4, 3), 0.2, np.float32)
    render[0, 0] = (0.21, 0.2, 9.0)
    images.write(tmp_path / "reference.exr", reference, {})
    images.write(tmp_path / "fit.exr", render, {})
    cell = accuracy()
    cell["pictures"] = {
        "samples": 64,
        "files": {"reference": "reference.exr", "fit, nodes": "fit.exr", "mirror, nodes": "gone.exr"},
    }
    shown = draw.looks(contested(cell).cell.pictures, tmp_path)
    assert [one.name for one in shown.swaps] == ["fit, nodes"]

    def pixel(url):
        return image.imread(BytesIO(base64.b64decode(url.partition(",")[2])))[0, 0, :3]

    look = images.srgb(np.array([0.2, 0.21]))
    np.testing.assert_allclose(pixel(shown.reference), look[0], atol=0.5 / 255)  # of 8 bits
    np.testing.assert_allclose(pixel(shown.swaps[0].render), (look[1], look[0], 1.0), atol=0.5 / 255)
    off = 16.0 * (look[1] - look[0])
    np.testing.assert_allclose(pixel(shown.swaps[0].difference), (off, 0.0, 1.0), atol=0.5 / 255)
    (tmp_path / "reference.exr").unlink()
    assert draw.looks(contested(cell).cell.pictures, tmp_path) is None
