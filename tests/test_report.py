# SPDX-License-Identifier: GPL-3.0-or-later
"""What is told of a report whose figures are known in closed form: bias b, noise c / sqrt(N), times a + d N."""

import base64
import importlib.util
import json
import re
import subprocess
import sys
from html.parser import HTMLParser
from io import BytesIO

import numpy as np
import pytest
from matplotlib import image
from matplotlib.colors import to_rgb
from scipy import stats

from vgroove.addon import cli
from vgroove.addon.report import compare, draw, findings, page, plots, record, run, summary
from vgroove.addon.report.record import Cell, ReportError

SEEDS, PIXELS = 4, 500
COUNTS = tuple(2**k for k in range(2, 13))
START = 0.05
#        bias, noise of one sample, seconds of a sample
MODELS = {
    "fit": (0.012, 0.3, 1.2e-3),
    "closure": (0.05, 0.3, 1.0e-3),
    "corrected": (0.0, 0.3, 1.5e-3),
    "mirror": (0.0, 2.0, 0.8e-3),
}


def contender(bias, noise, per_sample, start=START, counts=COUNTS, **words):
    n = np.array(counts, float)
    spread = noise / np.sqrt(n)
    bias2 = np.full(len(n), bias**2)
    # As report/statistics.py has it, with the same variance v in every pixel: 2 (v / S)^2 + 4 b^2 v / S over P.
    doubt = np.sqrt((2 * (spread**2 / SEEDS) ** 2 + 4 * bias2 * spread**2 / SEEDS) / PIXELS)
    seconds = start + per_sample * n
    return {
        "estimator": "", "backend": "", "peer": "", "differs": "", **words,
        "rmse": np.sqrt(bias2 + spread**2).tolist(), "bias2": bias2.tolist(), "bias2_error": doubt.tolist(),
        "noise": spread.tolist(), "flip": (0.1 * np.sqrt(bias2 + spread**2)).tolist(),
        "wall": (seconds / 2).tolist(), "cpu": seconds.tolist(),
    }  # fmt: skip


def accuracy(scene="softbox", subject="copper", counts=COUNTS):
    contenders = {
        f"{name}, {backend}": contender(
            bias, noise, per_sample * slower, counts=counts, estimator=name, backend=backend
        )
        for backend, slower in (("nodes", 1.0), ("osl", 1.3))
        for name, (bias, noise, per_sample) in MODELS.items()
    }
    contenders["Metallic BSDF"] = contender(0.06, 0.28, 1e-3, counts=counts, peer="cycles", differs="Smith's G")
    contenders["roughconductor"] = contender(0.0, 1e-3, 1e-4, counts=counts, peer="mitsuba", differs="Smith's G")
    return {
        "scene": scene, "subject": subject, "preset": "lecture/copper", "model": "cook_torrance", "m": 0.3,
        "size": 32, "seeds": [SEEDS] * len(counts), "truth": "known in closed form", "samples": list(counts),
        "contenders": contenders, "auto": ["corrected"] * len(counts), "pictures": None,
    }  # fmt: skip


def case(what, value, *, passed=True, limit=""):
    return {
        "what": what, "value": value, "finite": True, "lowest": 0.0, "highest": 0.9, "z": 0.5, "limit": limit,
        "passed": passed,
    }  # fmt: skip


def left_out(time, *, same=True, backend="nodes"):
    dropped = {"what": "time", "why": "it is static", "nodes": 93, "difference": 0.0, "same": True, "time": 1.02}
    setup = {
        "scene": "lamps", "backend": backend, "estimator": "corrected", "nodes": {"built": 40, "universal": 400},
        "instructions": {"built": 0, "universal": 0},
        "first": {"built": 0.2, "universal": 0.4, "ratio": 2.0, "rounds": [2.0]},
        "render": {"built": 1.0, "universal": time, "ratio": time, "rounds": [0.95 * time, time, 1.05 * time]},
        "difference": 1e-7, "same": same, "left_out": [dropped, dropped | {"what": "transmission", "time": 1.5}],
    }  # fmt: skip
    memory = {"scene": "lamps"} | {which: {"peak": 300 * 2**20, "over": 2**20} for which in ("built", "universal")}
    return {"preset": "lecture/copper", "setups": [setup], "memory": memory}


def report(blenders=("5.2.3",), cells=None):
    cells = cells or {
        "accuracy/softbox/copper": accuracy(),
        "stability/slope": {
            "cases": [
                case("m", 1e-6, limit="held to 1e-4"),
                case("m", 1.0),
                case("shot", {}),
                case("shot", {"where": 1e3}),
            ]
        },
        "stability/far": {"cases": [case("metres", 1e5, passed=False)]},
        "left_out/metal": left_out(2.0),
        "left_out/plaster": left_out(3.0),
        "left_out/glass": left_out(1.5),
    }
    content = {
        "format": 1, "machine": {"system": "linux", "processor": "x86_64", "cores": 2, "memory_gb": 8},
        "runs": {blender: {"vgroove": "0.1.0", "quick": False, "cells": cells} for blender in blenders},
    }  # fmt: skip
    return json.loads(json.dumps(content))  # no part is another's


def contest(cell):
    return findings.runs(report(cells={"accuracy/a/b": cell}))[0].contests[0]


def vgroove(*arguments):
    return cli._run(lambda: cli.app(["report", *map(str, arguments)], standalone_mode=False))


def curve(bias, noise, per_sample, counts=COUNTS, **changes):
    cell = accuracy(counts=counts) | {"contenders": {"x": contender(bias, noise, per_sample, counts=counts, **changes)}}
    return contest(cell).curves["x"]


def test_slope_is_that_of_the_noise_over_the_range():
    """Its least squares are SciPy's, over 64 to 4096 samples alone."""
    one = curve(0.05, 0.3, 1e-3)
    assert one.slope.value == pytest.approx(-0.5, abs=1e-12)
    assert one.slope.error == pytest.approx(0.0, abs=1e-12)
    cell = accuracy()
    bent = np.array(COUNTS) ** -0.4 * np.exp(0.05 * np.random.default_rng(1).standard_normal(len(COUNTS)))
    bent[:4] = 7.0  # 4 to 32 samples
    cell["contenders"]["mirror, nodes"]["noise"] = bent.tolist()
    expected = stats.linregress(np.log(COUNTS[4:]), np.log(bent[4:]))
    found = contest(cell).curves["mirror, nodes"].slope
    assert (found.value, found.error) == pytest.approx((expected.slope, expected.stderr), rel=1e-12)
    assert curve(0.05, 0.3, 1e-3, counts=(16, 64, 256)).slope is None
    assert curve(0.05, 0.0, 1e-3).slope is None  # without noise there is none


def test_bias_is_told_from_0_by_three_standard_errors():
    cell = accuracy()
    one = cell["contenders"]["fit, nodes"]
    for factor, told in ((2.9, False), (3.1, True)):
        one["bias2"][-1] = factor * one["bias2_error"][-1]
        found = contest(cell).curves["fit, nodes"]
        assert found.told is told
        assert found.floor == pytest.approx(np.sqrt(factor * one["bias2_error"][-1]), rel=1e-12)
        assert summary.bias(found).startswith("<") is not told
    one["bias2"][-1] = -one["bias2_error"][-1]
    found = contest(cell).curves["fit, nodes"]
    assert (found.floor, found.told) == (0.0, False)
    assert found.at_most == pytest.approx(np.sqrt(3.0 * one["bias2_error"][-1]), rel=1e-12)


def test_time_to_an_error_lies_on_the_curve():
    """At a sample count it is that render's time; between two, where the error is a power of the time, exact."""
    one = curve(0.012, 0.3, 1.2e-3)
    found = one.time_to(float(one.rmse[5]) * (1.0 + 1e-12), "wall")
    assert found.seconds == pytest.approx(one.wall[5], rel=1e-9)
    power = curve(0.0, 0.3, 1e-3, start=0.0)  # rmse = .3 sqrt(.001 / t)
    for target in findings.TARGETS:
        assert power.time_to(target, "cpu").seconds == pytest.approx(1e-3 * (0.3 / target) ** 2, rel=1e-12)
    assert summary.reached(power.time_to(0.02, "cpu")) == "0.225 s"


def test_an_error_that_is_not_reached_says_why():
    assert summary.reached(curve(0.05, 0.3, 1e-3).time_to(0.02, "cpu")) == "floor 5 %"
    slow = curve(0.0, 2.0, 1e-3)
    assert summary.reached(slow.time_to(0.01, "cpu")) == f"> {slow.cpu[-1]:.3g} s"
    assert summary.reached(curve(0.001, 0.01, 1e-3).time_to(0.02, "cpu")) == f"≤ {START + 4e-3:.3g} s"
    held_up = accuracy()
    held_up["contenders"]["fit, nodes"]["cpu"][4] = 100.0
    assert contest(held_up).curves["fit, nodes"].time_to(0.02, "cpu").seconds == pytest.approx(100.0)


def test_error_at_a_time_goes_on_beyond_the_last_render():
    one = curve(0.05, 0.3, 1e-3)
    for index in (0, 4, 10):
        assert one.error_at(float(one.cpu[index])) == pytest.approx(one.rmse[index], rel=1e-12)
    assert one.error_at(0.99 * one.cpu[0]) == np.inf
    assert one.error_at(4.0 * one.cpu[-1]) == pytest.approx(np.hypot(0.05, one.noise[-1] / 2.0), rel=1e-12)
    assert (one.start, one.per_sample) == pytest.approx((START, 1e-3), rel=1e-9)


def test_winner_changes_where_the_curves_cross():
    """Pure powers: a is .3 sqrt(.001 / t), b ten times the noise at a hundredth of a bias; they cross at one time."""
    cell = accuracy() | {"auto": ["closure"] * len(COUNTS)}
    cell["contenders"] = {
        "closure, nodes": contender(0.1, 1e-6, 1e-3, start=0.0, estimator="closure", backend="nodes"),
        "mirror, nodes": contender(0.0, 1.0, 1e-3, start=0.0, estimator="mirror", backend="nodes"),
        "mirror, osl": contender(0.0, 1e-9, 1e-3, start=0.0, estimator="mirror", backend="osl"),
        "theirs": contender(0.0, 1e-9, 1e-3, start=0.0, peer="mitsuba"),
    }
    crossing = 0.1  # where 1 / sqrt(t / .001) is .1
    found = contest(cell)
    assert [win.seconds for win in found.wins] == [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0]
    for win in found.wins:
        if win.seconds != crossing:
            assert win.winner == ("closure" if win.seconds < crossing else "mirror")
            mirror = np.sqrt(1e-3 / win.seconds)
            assert win.error == pytest.approx(min(0.1, mirror), rel=1e-6)
            expected = {"closure": max(1.0, 0.1 / mirror), "mirror": max(1.0, mirror / 0.1)}
            assert win.over == pytest.approx(expected, rel=1e-6)
    for pick, count in zip(found.picks, COUNTS, strict=True):
        ratio = max(1.0, 0.1 * np.sqrt(count))
        assert pick.ratio == pytest.approx(ratio, rel=1e-6)
        assert pick.close is bool(ratio <= 1.1)
        assert pick.by == "time"


def test_short_renders_are_held_against_each_other_at_equal_samples():
    """Until sampling takes as long as the start of the slowest, 0.05 s."""
    found = contest(accuracy())
    slowest = max(per_sample for _, _, per_sample in MODELS.values())
    assert found.judged_from == pytest.approx(2.0 * START, rel=1e-9)
    for pick in found.picks:
        assert pick.by == ("time" if slowest * pick.samples >= START else "samples")
    first = found.picks[0]
    assert (first.winner, first.ratio) == ("corrected", pytest.approx(1.0))
    assert found.osl_over_nodes == pytest.approx(dict.fromkeys(MODELS, 1.3))
    # At 64 samples corrected takes .146 s, in which closure makes about 96: less noise, for a bias of .05.
    late = next(pick for pick in found.picks if pick.samples == 64)
    assert (late.estimator, late.by) == ("corrected", "time")
    best = {name: np.hypot(b, c / np.sqrt((START + 64 * 1.5e-3 - START) / d)) for name, (b, c, d) in MODELS.items()}
    # A chord over a factor of 2 in N lies above the curve, in log-log, by less than 4 %.
    assert late.winner == min(best, key=best.get)
    assert best["corrected"] / best[late.winner] / late.ratio == pytest.approx(1.0, abs=0.04)


def test_headlines_are_those_of_the_numbers():
    lines = "\n".join(summary.headlines(findings.runs(report())[0]))
    for words in (
        "to the power of −0.50, the median of 1 scenes",
        "mirror cannot be told from 0 in 1 of 1 scenes; in 1 of these it is known to be below 1 %",
        "of 11 sample counts",
        "A sample takes 1.30 × as long as OSL",
        "One universal material takes 2.00 × as long",
        "3 cases (1.5 to 3); the pictures are the same",
        "4 of 5 extreme cases pass, 1 of them within a stated limit; failed: far: metres 100000.",
    ):
        assert words in lines
    unlike = report(cells={"left_out/metal": left_out(2.0, same=False)})
    assert "the pictures differ in metal, lamps, nodes." in "\n".join(summary.headlines(findings.runs(unlike)[0]))
    assert summary.headlines(findings.runs(report(cells={"left_out/a": left_out(2.0)}))[0])[0].startswith(
        "One universal"
    )


def test_what_was_left_out_is_told_case_by_case_and_thing_by_thing():
    found = findings.runs(report(cells={"left_out/metal": left_out(2.0), "left_out/clay": left_out(3.0)}))[0]
    metal = [
        "metal",
        "lecture/copper",
        "lamps",
        "nodes",
        "2.00 ×",
        "1.90 to 2.10",
        "2.00 ×",
        "40 / 400",
        "",
        "300 / 300",
    ]
    assert summary.left_out_rows(found)[1] == [*metal, "the same"]
    assert summary.dropped_rows(found) == [
        ["time", "2 of 2", "93", "1.02 ×", "the same"],
        ["transmission", "2 of 2", "93", "1.50 ×", "the same"],
    ]


def test_extreme_cases_are_told_by_what_of_them_is_not_as_usual():
    rows = summary.case_rows(findings.runs(report())[0])
    assert [row[:3] for row in rows] == [
        ["far", "metres", "100000"],  # failed
        ["slope", "m", "1e-06"],
        ["slope", "m", "1"],
        ["slope", "shot", "as usual"],
        ["slope", "shot", "where 1000"],
    ]


def test_a_cell_of_another_make_is_named():
    content = report()
    del content["runs"]["5.2.3"]["cells"]["accuracy/softbox/copper"]["contenders"]["fit, nodes"]["noise"]
    with pytest.raises(ReportError, match=r"accuracy/softbox/copper: not as this vgroove writes it .*'noise'"):
        findings.runs(content)


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
    written = draw.draw(content, None, tmp_path)
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
        assert "−0.50 ± 0.00" in words
        assert "floor 5 %" in words

    seen = image.imread(tmp_path / "plots" / "error-5.2.3.png")[..., :3].reshape(-1, 3)
    for name in MODELS:  # the legend tells them by their colours, which fewer shades keep to 2 of 255
        assert np.abs(seen - to_rgb(plots.COLOURS[name])).max(axis=1).min() < 2.5 / 255

    again = tmp_path / "again"
    plots_again = plots.draw(findings.runs(content)[0], again) if again.mkdir() is None else {}
    for one in plots_again.values():
        for ending in (".svg", ".png"):
            assert (again / (one.name + ending)).read_bytes() == (tmp_path / "plots" / (one.name + ending)).read_bytes()


@pytest.mark.blender
def test_pictures_are_shown_beside_16_times_what_they_differ_by(blender, tmp_path):
    """In sRGB, as they are seen; what is brighter than white is clipped, and a picture that is gone is left out."""
    from vgroove.addon import images

    reference, render = np.full((4, 4, 3), 0.2, np.float32), np.full((4, 4, 3), 0.2, np.float32)
    render[0, 0] = (0.21, 0.2, 9.0)
    images.write(tmp_path / "reference.exr", reference, {})
    images.write(tmp_path / "fit.exr", render, {})
    cell = accuracy()
    cell["pictures"] = {
        "samples": 64,
        "files": {"reference": "reference.exr", "fit, nodes": "fit.exr", "mirror, nodes": "gone.exr"},
    }
    shown = page.looks(contest(cell), tmp_path)
    assert [one.name for one in shown.swaps] == ["fit, nodes"]

    def pixel(url):
        return image.imread(BytesIO(base64.b64decode(url.partition(",")[2])))[0, 0, :3]

    look = images.srgb(np.array([0.2, 0.21]))
    np.testing.assert_allclose(pixel(shown.reference), look[0], atol=0.5 / 255)  # of 8 bits
    np.testing.assert_allclose(pixel(shown.swaps[0].render), (look[1], look[0], 1.0), atol=0.5 / 255)
    off = 16.0 * (look[1] - look[0])
    np.testing.assert_allclose(pixel(shown.swaps[0].difference), (off, 0.0, 1.0), atol=0.5 / 255)
    (tmp_path / "reference.exr").unlink()
    assert page.looks(contest(cell), tmp_path) is None


def test_rmse_error_is_how_much_it_scatters():
    """Of a report's own figures, over 4000 trials of 4 seeds.

    The mean of the square of a variance of S seeds is 1 + 2 / (S - 1) of its square, so that what statistics.error says
    is too large by up to sqrt(5 / 3) = 1.29, of which bias^2 that is held at 0 takes a part.
    """
    pixels, trials = 200, 4000
    seen = np.random.default_rng(3).standard_normal((trials, SEEDS, pixels))  # of a truth of 0
    variance = seen.var(axis=1, ddof=1)
    bias2 = np.mean((seen.sum(axis=1) ** 2 - np.sum(seen**2, axis=1)) / (SEEDS * (SEEDS - 1)), axis=1)
    rmse = np.sqrt(np.maximum(bias2, 0.0) + variance.mean(axis=1))
    cell = accuracy(counts=(1,))
    cell["contenders"] = {"x": contender(0.0, 1.0, 1e-3, counts=(1,))}
    doubt = np.sqrt(np.sum(2.0 * (variance / SEEDS) ** 2, axis=1)).mean() / pixels
    cell["contenders"]["x"]["bias2_error"] = [float(doubt)]
    assert rmse.std() < compare.rmse_error(contest(cell).curves["x"], SEEDS)[0] < 1.29 * rmse.std()


def changed(change):
    """What compare says of a report against itself after ``change``: {(where, who, what): worse}."""
    before, after = report(), report()
    change(after["runs"]["5.2.3"]["cells"])
    found, _ = compare.changes(before, after)
    return {(one.where, one.who, one.what): one.worse for one in found}


def test_a_report_is_no_better_than_itself():
    assert changed(lambda _cells: None) == {}


@pytest.mark.parametrize(("errors", "expected"), [(1.0, {}), (9.0, True), (-9.0, False)])
def test_an_error_counts_as_changed_beyond_its_noise(errors, expected):
    """One standard error is none; nine are, up or down."""

    def change(cells):
        one = cells["accuracy/softbox/copper"]["contenders"]["mirror, nodes"]
        before = contest(accuracy()).curves["mirror, nodes"]
        one["rmse"] = (before.rmse + errors * np.sqrt(2.0) * compare.rmse_error(before, SEEDS)).tolist()

    found = changed(change)
    if expected == {}:
        assert found == {}
    else:
        assert list(found.values()) == [expected]
        assert next(iter(found))[:2] == ("softbox, copper", "mirror, nodes")


def test_a_bias_that_appears_is_worse():
    def change(cells):
        one = cells["accuracy/softbox/copper"]["contenders"]["corrected, nodes"]
        one["bias2"] = (np.array(one["bias2"]) + 0.001**2 + 10.0 * np.array(one["bias2_error"])).tolist()

    assert changed(change) == {("softbox, copper", "corrected, nodes", "bias"): True}


def test_times_are_judged_over_a_peer():
    """A machine of half the speed is no change; a contender that takes a third longer is."""

    def slower(factor, only=""):
        def change(cells):
            for name, one in cells["accuracy/softbox/copper"]["contenders"].items():
                if only in name:
                    one["cpu"] = (factor * np.array(one["cpu"])).tolist()

        return change

    assert changed(slower(2.0)) == {}
    assert changed(slower(1.2, "fit, nodes")) == {}
    expected = ("softbox, copper", "fit, nodes", "time over Metallic BSDF")
    assert changed(slower(1.3, "fit, nodes")) == {expected: True}
    assert changed(slower(1 / 1.3, "fit, nodes")) == {expected: False}


def test_cases_and_savings_are_compared():
    def change(cells):
        cells["stability/slope"]["cases"][1]["passed"] = False
        cells["stability/far"]["cases"][0]["passed"] = True
        cells["left_out/metal"]["setups"][0]["render"]["ratio"] = 1.5
        cells["left_out/glass"]["setups"][0]["same"] = False

    assert changed(change) == {
        ("slope", "m 1", "case"): True,
        ("far", "metres 100000", "case"): False,
        ("left out", "metal, lamps, nodes", "saving"): True,
        ("left out", "glass, lamps, nodes", "picture"): True,
    }


@pytest.fixture
def two(tmp_path):
    for name in ("a", "b"):
        (tmp_path / f"{name}.json").write_text(json.dumps(report()))
    return tmp_path / "a.json", tmp_path / "b.json"


def test_compare_exits_1_if_something_is_worse(two, capsys):
    a, b = two
    assert vgroove("--compare", a, b) == 0
    assert "0 worse, 0 better" in capsys.readouterr().out
    content = json.loads(b.read_text())
    content["runs"]["5.2.3"]["cells"]["stability/slope"]["cases"][1]["passed"] = False
    b.write_text(json.dumps(content))
    assert vgroove("--compare", a, b) == 1
    assert "1 worse, 0 better" in capsys.readouterr().out
    assert vgroove("--compare", b, a) == 0
    content["runs"] = {"4.2.0": content["runs"]["5.2.3"], "4.3.0": content["runs"]["5.2.3"]}
    b.write_text(json.dumps(content))
    assert vgroove("--compare", a, b) == 2
    assert "no figure in common" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give -o DIR to measure, --from REPORT.json to draw anew"),
        (["--from", "none.json"], "none.json: not there"),
        (["--from", "broken.json"], "broken.json: no report"),
        (["--from", "old.json"], "old.json: is of format 0"),
        (["--from", "empty.json"], "holds no measurements yet"),
        (["--from", "a.json", "--quick"], "give one of them"),
        (["--compare", "a.json", "none.json"], "none.json: not there"),
        (["--compare", "a.json", "a.json", "-o", "there"], "leave -o, --from and --quick out"),
        (["--compare", "a.json"], "--compare"),
        (["-o", "a.json"], "cannot be made"),
        (["-o", "other"], "was measured on another machine"),
    ],
)
def test_bad_input_is_one_line(two, monkeypatch, capsys, arguments, message):
    folder = two[0].parent
    monkeypatch.chdir(folder)
    (folder / "broken.json").write_text("{")
    (folder / "old.json").write_text(json.dumps(report() | {"format": 0}))
    (folder / "empty.json").write_text(json.dumps(report() | {"runs": {}}))
    (folder / "other").mkdir()
    (folder / "other" / "report.json").write_text(json.dumps(report() | {"machine": {"cores": 0}}))
    assert vgroove(*arguments) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
    assert not (folder / "there").exists()


def test_a_report_is_drawn_without_blender(tmp_path):
    (tmp_path / "report.json").write_text(json.dumps(report(cells={"left_out/metal": left_out(2.0)})))
    code = "import sys; sys.modules['bpy'] = None; from vgroove.addon import cli; cli.main()"
    command = [sys.executable, "-P", "-c", code, "report", "--from", tmp_path / "report.json", "-o", tmp_path / "new"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "bpy is not installed, so the page has no pictures" in done.stderr
    assert "One universal material takes 2.00" in (tmp_path / "new" / page.FILE).read_text(encoding="utf-8")


@pytest.mark.parametrize("gone", ["matplotlib", "flip_evaluator", "mitsuba"])
def test_a_missing_extra_is_named_before_any_work(gone, monkeypatch, capsys, tmp_path):
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *rest: None if name == gone else find(name, *rest))
    assert vgroove("-o", tmp_path / "out") == 2
    assert f"report needs {gone}; install" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.blender
def test_an_interrupted_report_goes_on(monkeypatch, capsys, tmp_path):
    """What is measured is kept and not measured again; the page is drawn at the end."""
    done = []

    def cell(name, *, fails=False):
        def measure(folder):
            if fails and not done.count("again"):
                raise KeyboardInterrupt
            done.append(name)
            return left_out(2.0)

        return Cell(f"left_out/{name}", measure)

    monkeypatch.setattr(run, "cells", lambda *, quick: [cell("first"), cell("second", fails=True), cell("third")])
    out = tmp_path / "out"
    assert vgroove("-o", out) == cli.INTERRUPTED
    assert done == ["first"]
    assert "1 of 3 measurements are kept in" in capsys.readouterr().err
    assert not (out / page.FILE).exists()
    done.append("again")
    assert vgroove("-o", out) == 0
    assert done == ["first", "again", "second", "third"]
    assert "1 of 3 measurements are there already" in capsys.readouterr().err
    kept = findings.runs(record.read(out / record.FILE))[0].left_out
    assert [one.case for one in kept] == ["first", "second", "third"]
    before = (out / page.FILE).read_text()
    (out / page.FILE).unlink()
    assert vgroove("--from", out / record.FILE, "-o", tmp_path / "elsewhere") == 0
    assert (tmp_path / "elsewhere" / page.FILE).read_text() == before
    assert vgroove("-o", out, "--quick") == 2
    assert "holds a full report of other quick; choose another folder" in capsys.readouterr().err
