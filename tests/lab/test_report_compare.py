# SPDX-License-Identifier: GPL-3.0-or-later
"""Two reports compared: what is better or worse."""

import numpy as np
import pytest

from vgroove.lab.report import compare

from .reports import COUNTS, accuracy, contested, report, runs

pytestmark = pytest.mark.once


def changed(change, cells=None):
    """What compare says of a report against itself after ``change``: {(where, who, what): worse}."""
    before, after = report(cells=cells), report(cells=cells)
    change(after["runs"]["5.2.3"]["cells"])
    found, _ = compare.changes(runs(before), runs(after))
    return {(one.where, one.who, one.what): one.worse for one in found}


def test_a_report_is_no_better_than_itself():
    assert changed(lambda _cells: None) == {}


@pytest.mark.parametrize(("errors", "expected"), [(1.0, {}), (9.0, True), (-9.0, False)])
def test_an_error_counts_as_changed_beyond_its_noise(errors, expected):
    """One standard error is none; nine are, up or down."""

    def change(cells):
        one = cells["accuracy/softbox/copper"]["contenders"]["mirror, nodes"]
        before = contested(accuracy()).curves["mirror, nodes"]  # without bias: its noise is its error
        one["noise"] = (before.rmse + errors * np.sqrt(2.0) * before.rmse_error).tolist()

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

    where = ("softbox, copper", "corrected, nodes")
    assert changed(change) == {(*where, "bias"): True, (*where, "error at 4096 samples"): True}


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


def test_a_time_must_change_by_more_than_the_seeds_scatter():
    """A third longer, where 3 counts of 4 seeds scatter by a fifth: 2 sqrt(pi/2 / 4 / 3) / 5 is .14 in a log.

    Its four standard errors or so are more than log 1.3 = .26; those of a scatter of a twentieth are not.
    """

    def change(cells):
        cells["accuracy/softbox/copper"]["contenders"]["fit, nodes"]["cpu"] = [
            1.3 * one for one in cells["accuracy/softbox/copper"]["contenders"]["fit, nodes"]["cpu"]
        ]

    for spread, said in ((0.2, False), (0.05, True)):
        cells = report()["runs"]["5.2.3"]["cells"]
        for one in cells["accuracy/softbox/copper"]["contenders"].values():
            one["cpu_spread"] = [spread] * len(COUNTS)
        assert bool(changed(change, cells)) is said


def test_a_regression_is_not_hidden_by_an_improvement():
    def change(cells):
        one = cells["accuracy/softbox/copper"]["contenders"]["mirror, nodes"]
        one["noise"] = (np.array(one["noise"]) * np.linspace(0.2, 1.6, len(COUNTS))).tolist()

    where = ("softbox, copper", "mirror, nodes")
    assert changed(change) == {(*where, "error at 4096 samples"): True, (*where, "error at 4 samples"): False}


def test_an_error_that_is_not_resolved_is_not_compared():
    def change(cells):
        one = cells["accuracy/softbox/copper"]["contenders"]["mirror, nodes"]
        one["noise"][0], one["bias2"][-1] = 1e-9, 4.0
        one["resolved"] = [False, *[True] * (len(COUNTS) - 2), False]

    assert changed(change) == {}


def test_peers_are_not_judged():
    def change(cells):
        for one in cells["accuracy/softbox/copper"]["contenders"].values():
            if one["peer"] == "mitsuba":
                one["cpu"], one["noise"] = [9.0 * t for t in one["cpu"]], [9.0 * e for e in one["noise"]]

    assert changed(change) == {}


def test_what_is_gone_is_worse_and_what_is_new_is_neither():
    """Except between a quick and a full report, which measures more on purpose. A missing part is one line."""

    def change(cells):
        del cells["accuracy/softbox/copper"]["contenders"]["corrected, nodes"]
        del cells["stability/far"], cells["left_out/glass"]
        del cells["stability/slope"][0]
        cells["accuracy/sun/copper"] = accuracy("sun")

    assert changed(change) == {
        ("softbox, copper", "corrected, nodes", "measured"): True,
        ("slope", "m 1e-06", "measured"): True,
        ("far", "", "measured"): True,
        ("left out", "glass, lamps, corrected, nodes", "measured"): True,
        ("half-degree sun, copper", "", "measured"): None,
    }
    before, after = report(), report()
    change(after["runs"]["5.2.3"]["cells"])
    after["runs"]["5.2.3"]["quick"] = True
    assert compare.changes(runs(before), runs(after))[0] == []
    both, one = runs(report(("4.5.15", "5.2.3"))), runs(report(("5.2.3",)))
    assert [(c.blender, c.what, c.after, c.worse) for c in compare.changes(both, [*one, one[0]])[0]] == [
        ("4.5.15", "measured", "no", True)
    ]


def test_what_automatic_picks_is_compared():
    """mirror in place of corrected: poor where that was close to the best."""
    before, after = report(), report()
    after["runs"]["5.2.3"]["cells"]["picks/softbox/copper"]["estimators"] = ["mirror"] * len(COUNTS)
    found, _ = compare.changes(runs(before), runs(after))
    close = [[pick.close for pick in runs(of)[0].contests[0].picks] for of in (before, after)]
    worse = [old and not new for old, new in zip(*close, strict=True)]
    assert sum(worse) >= 2
    assert [one.what for one in found if one.worse] == [
        f"error over the best at {count} samples" for count, bad in zip(COUNTS, worse, strict=True) if bad
    ]


def test_cases_and_savings_are_compared():
    def change(cells):
        cells["stability/slope"][1]["passed"] = False
        cells["stability/far"][0]["passed"] = True
        cells["left_out/metal"][0]["slowdown"] = 1.5
        cells["left_out/glass"][0]["same"] = False

    assert changed(change) == {
        ("slope", "m 1", "case"): True,
        ("far", "metres 100000", "case"): False,
        ("left out", "metal, lamps, corrected, nodes", "saving"): True,
        ("left out", "glass, lamps, corrected, nodes", "picture"): True,
    }


def test_the_size_of_a_material_is_compared():
    """Nodes and instructions are exact, and told beyond a fourth."""

    def change(cells):
        metal, glass = (cells[f"left_out/{name}"] for name in ("metal", "glass"))
        metal[0]["nodes"][0] = 51
        glass[0]["nodes"][0] = 49

    assert changed(change) == {("left out", "metal, lamps, corrected, nodes", "nodes"): True}
