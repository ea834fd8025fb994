# SPDX-License-Identifier: GPL-3.0-or-later
"""What the page and report.md show."""

import re
from html.parser import HTMLParser

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
    claimed,
    left_out,
    only,
    report,
    runs,
    section,
)

pytestmark = pytest.mark.once


def test_what_was_left_out_is_shown_case_by_case():
    found = section(only({"left_out/metal": left_out(2.0), "left_out/clay": left_out(3.0)}), "Materials as built")
    metal = dict(zip(found.columns, found.rows[0], strict=True))
    expected = {"preset": "lecture/copper", "slowdown": "2", "spread": "1.9 / 2.1", "nodes": "40 / 400", "same": "yes"}
    assert metal.items() >= expected.items()
    assert "instructions" in found.columns
    assert "omitted" not in found.columns
    assert "slowdown: the universal material's render time" in found.caption


def test_what_was_not_put_back_is_shown_but_not_measured():
    """A setup without a list has no row."""
    cells = {f"left_out/{name}": left_out(2.0) for name in ("a", "b", "c")}
    cells["left_out/b"][0]["omitted"] = []
    cells["left_out/c"][0]["omitted"] = [{"what": "time", "why": "not now"}, {"what": "body", "why": "it is hollow"}]
    found = only(cells)
    assert section(found, "Components left out").rows == [
        ["a, lamps, corrected, nodes", "time", "it is static", "93", "yes"],
        ["a, lamps, corrected, nodes", "transmission", "it is static", "93", "yes"],
        ["c, lamps, corrected, nodes", "time", "not now", "", ""],
        ["c, lamps, corrected, nodes", "body", "it is hollow", "", ""],
    ]
    assert claimed(cells)["Omitted components do"] == (SAME_IN.format(3, 3, 1), True)


def test_extreme_cases_are_shown_by_what_is_not_as_usual():
    """Those that failed first; fields that no case has are left out."""
    found = section(runs(report())[0], "Extreme cases")
    assert [row[:3] for row in found.rows] == [
        ["far", "metres 100000", "no"],
        ["slope", "m 1e-06", "yes"],
        ["slope", "m 1", "yes"],
        ["slope", "shot as usual", "yes"],
        ["slope", "shot where 1000", "yes"],
    ]
    assert found.wrong == 1
    assert found.columns == ["group", "case", "passed", "lowest", "highest", "z", "limit"]


def test_contenders_are_shown_by_their_figures():
    """A peer's row says how it differs; the caption explains each figure, from its type's docstring."""
    found = section(only({"accuracy/softbox/copper": accuracy()}), "Contenders")
    assert found.columns[:4] == ["scene, subject", "contender", "differs", "bias"]
    assert [row[2] for row in found.rows if row[1] == "Metallic BSDF"] == ["Smith's G"]
    assert [row[3] for row in found.rows if row[1] == "closure, nodes"] == ["0.05"]
    assert found.caption.startswith("A contender in a scene. bias: at the most samples")


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
    written = draw.draw(record.structured(content), tmp_path)
    assert written == [tmp_path / "report.html", tmp_path / "report.md", tmp_path / "plots"]
    names = {f"{kind}-{blender}" for kind in ("error", "noise") for blender in content["runs"]}
    assert {path.name for path in (tmp_path / "plots").iterdir()} == {f"{name}.png" for name in names}
    assert all(path.stat().st_size < 400_000 for path in (tmp_path / "plots").iterdir())

    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    shown = [attributes for tag, attributes in Page(text).tags if tag == "img"]
    assert len(shown) == len(names)
    assert all(one["alt"] and one["src"].startswith("data:image/png;base64,") for one in shown)
    assert not re.search(r"(src|href)=.(?!data:|#)", text)
    assert not re.search(r"\{[{%]", text)
    told = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"plots/(.*?)\.png", told)) == sorted(names)
    assert text.index("Blender 5.2.3") < text.index("Blender 4.5.15")
    for words in (told, re.sub(r"base64,[^\"]*|<p class=.soft.>.*?</p>", "", text, flags=re.DOTALL)):
        assert not re.search(r"\b(nan|inf|None)\b", words)
        assert "−0.50" in words
        assert "5 %" in words
    assert "1 are not as they should be" in text
    assert len(told) < 30_000

    seen = image.imread(tmp_path / "plots" / "error-5.2.3.png")[..., :3].reshape(-1, 3)
    for name in MODELS:  # the legend tells them by their colours, which fewer shades keep to 2 of 255
        assert np.abs(seen - to_rgb(plots.COLOURS[name])).max(axis=1).min() < 2.5 / 255

    for name, drawn in plots.draw(runs(content)[0]).items():
        assert drawn == (tmp_path / name).read_bytes()
