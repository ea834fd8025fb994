# SPDX-License-Identifier: GPL-3.0-or-later
"""Slopes, biases, errors at a time and winners, of figures known in closed form."""

import numpy as np
import pytest
from scipy import stats

from vgroove.lab.report import published

from .reports import (
    COUNTS,
    MODELS,
    PIXELS,
    SEEDS,
    START,
    accuracy,
    claimed,
    contender,
    contested,
    curve,
    only,
    with_mirror,
)

pytestmark = pytest.mark.once


def test_slope_is_that_of_the_noise_over_the_range():
    """Its least squares are SciPy's, over 64 to 4096 samples alone.

    On a straight line, of seven counts a factor of 2 apart, its error is that of the noise, which is known to
    1 / sqrt(2 P S).
    """
    assert curve(0.05, 0.3, 1e-3).slope.value == pytest.approx(-0.5, abs=1e-12)
    one = curve(0.0, 0.3, 1e-3)
    assert one.slope.value == pytest.approx(-0.5, abs=1e-12)
    assert one.slope.error == pytest.approx(1.0 / np.sqrt(2 * PIXELS * SEEDS * 28 * np.log(2) ** 2), rel=1e-9)
    cell = accuracy()
    bent = np.array(COUNTS) ** -0.4 * np.exp(0.05 * np.random.default_rng(1).standard_normal(len(COUNTS)))
    bent[:4] = 7.0  # 4 to 32 samples
    cell["contenders"]["mirror, nodes"]["noise"] = bent.tolist()
    expected = stats.linregress(np.log(COUNTS[4:]), np.log(bent[4:]))
    found = contested(cell).curves["mirror, nodes"].slope
    assert (found.value, found.error) == pytest.approx((expected.slope, expected.stderr), rel=1e-12)
    of_two = curve(0.05, 0.3, 1e-3, counts=(16, 64, 256)).slope
    assert (of_two.value, of_two.error) == (pytest.approx(-0.5, abs=1e-12), None)
    assert curve(0.05, 0.3, 1e-3, counts=(16, 64)).slope is None
    assert curve(0.05, 0.0, 1e-3).slope is None  # without noise there is none


def test_bias_is_distinguished_from_0_by_three_standard_errors():
    cell = accuracy()
    one = cell["contenders"]["fit, nodes"]
    for factor, known in ((2.9, False), (3.1, True)):
        one["bias2"][-1] = factor * one["bias2_error"][-1]
        found = contested(cell).curves["fit, nodes"]
        assert found.biased is known
        assert found.floor == pytest.approx(np.sqrt(factor * one["bias2_error"][-1]), rel=1e-12)
        assert (published._curve(found).bias is not None) is known
    one["bias2"][-1] = -one["bias2_error"][-1]
    found = contested(cell).curves["fit, nodes"]
    assert (found.floor, found.biased) == (0.0, False)
    assert found.bias_bound == pytest.approx(np.sqrt(3.0 * one["bias2_error"][-1]), rel=1e-12)


def test_error_at_a_time_goes_on_beyond_the_last_render():
    one = curve(0.05, 0.3, 1e-3)
    for index in (0, 4, 10):
        assert one.error_at(float(one.cpu[index])) == pytest.approx(one.rmse[index], rel=1e-12)
    assert one.error_at(0.99 * one.cpu[0]) == np.inf
    assert one.error_at(4.0 * one.cpu[-1]) == pytest.approx(np.hypot(0.05, one.noise[-1] / 2.0), rel=1e-12)
    assert one.error_of(4.0 * one.samples[-1]) == pytest.approx(np.hypot(0.05, one.noise[-1] / 2.0), rel=1e-12)
    assert (one.start, one.per_sample) == pytest.approx((START, 1e-3), rel=1e-9)


def test_noise_that_falls_faster_than_by_chance_goes_on_so():
    """Or a rival with even samples would look worse than it is. What falls slower is a handful of hits."""
    for power, kept in ((-0.9, 0.9), (-0.3, 0.5)):
        curve = contested(with_mirror(noise=np.array(COUNTS) ** power, bias2=0.0 * np.array(COUNTS)))
        one = curve.curves["mirror, nodes"]
        assert one.error_of(10.0 * COUNTS[-1]) == pytest.approx(COUNTS[-1] ** power * 10.0**-kept, rel=1e-9)


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
    found = contested(cell)
    assert [win.at for win in found.wins] == [0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0]
    for win in found.wins:
        if win.at != crossing:
            assert win.winner == ("closure" if win.at < crossing else "mirror")
            mirror = np.sqrt(1e-3 / win.at)
            assert win.error == pytest.approx(min(0.1, mirror), rel=1e-6)
            expected = {"closure": max(1.0, 0.1 / mirror), "mirror": max(1.0, mirror / 0.1)}
            assert win.over == pytest.approx(expected, rel=1e-6)
    for pick, count in zip(found.picks, COUNTS, strict=True):
        ratio = max(1.0, 0.1 * np.sqrt(count))
        assert pick.ratio == pytest.approx(ratio, rel=1e-6)
        assert pick.close is bool(ratio <= 1.1)


def test_picks_are_compared_with_others_at_equal_time_of_samples():
    """What a render starts with counts for nothing: in corrected's 64 samples closure has 96, for a bias of .05."""
    found = contested(accuracy())
    assert found.judged_from == pytest.approx(2.0 * START, rel=1e-9)
    assert found.osl_over_nodes == pytest.approx(dict.fromkeys(MODELS, 1.3))
    for pick in found.picks:
        seconds = pick.samples * 1.5e-3
        best = {name: np.hypot(b, c / np.sqrt(seconds / d)) for name, (b, c, d) in MODELS.items()}
        # A chord over a factor of 2 in N lies above the curve, in log-log, by less than 4 %.
        assert (pick.estimator, pick.winner) == ("corrected", min(best, key=best.get))
        assert best["corrected"] / best[pick.winner] / pick.ratio == pytest.approx(1.0, abs=0.04)


@pytest.mark.parametrize(("pixels", "far"), [(500, True), (1, False)])
def test_a_poor_choice_is_one_that_chance_does_not_explain(pixels, far):
    """closure errs a fifth more than fit at 1024 samples. Of 500 pixels that is known to 2 %, of one to half."""
    cell = accuracy(counts=(256, 1024)) | {"auto": ["closure"] * 2}
    cell["contenders"] = {
        f"{name}, nodes": contender(0.0, noise, 1e-3, 0.0, (256, 1024), estimator=name, backend="nodes")
        for name, noise in (("closure", 0.36), ("fit", 0.3))
    }
    for one in cell["contenders"].values():
        one["bias2_error"] = (np.array(one["bias2_error"]) * np.sqrt(PIXELS / pixels)).tolist()
    (*_, pick) = contested(cell).picks
    assert (pick.winner, pick.ratio) == ("fit", pytest.approx(1.2, rel=1e-9))
    # (2 v^2 + 4 b^2 v) / S^2 / P under the root is sqrt(2 / P) v / S; times sqrt(S) over 2 v, of both.
    assert pick.doubt == pytest.approx(np.sqrt(2.0 * 0.5 / pixels / SEEDS), rel=1e-9)
    assert not pick.close
    assert pick.poor is far
    found, holds = claimed({"accuracy/a/b": cell})["Automatic is within"]
    assert holds is not far
    assert found.startswith(
        "at 0 of 2 sample counts" + ("; at" if far else ", and within the noise of the measurement at 2 more")
    )


def test_a_count_that_is_not_resolved_shows_nothing():
    """The most samples, and the fewest: no bias, no winner, no point of a slope."""
    resolved = np.ones(len(COUNTS), bool)
    resolved[[0, -1]] = False
    cell = accuracy()
    fit = cell["contenders"]["fit, nodes"] | {"resolved": resolved.tolist()}
    fit["bias2"][-1], fit["noise"][-1], fit["bias2"][0], fit["noise"][0] = 4.0, 1e-9, 0.0, 1e-9
    cell["contenders"]["fit, nodes"] = fit
    one, plain = contested(cell).curves["fit, nodes"], contested(accuracy()).curves["fit, nodes"]
    assert one.slope.value == pytest.approx(-0.5, abs=1e-12)
    assert one.floor == pytest.approx(plain.floor, rel=1e-12)
    assert not one.biased_at[-1]
    between = [0.5 * (one.cpu[index] + one.cpu[index + 1]) for index in (0, -2)]
    for seconds in (one.cpu[0], *between, one.cpu[-1], 2.0 * one.cpu[-1]):
        assert one.error_at(float(seconds)) == np.inf
    assert one.error_at(float(one.cpu[1])) == pytest.approx(one.rmse[1], rel=1e-12)
    cell["auto"] = ["fit"] * len(COUNTS)
    assert [pick.samples for pick in contested(cell).picks] == list(COUNTS[1:-1])
    fit["resolved"] = [False] * len(COUNTS)
    none = contested(cell).curves["fit, nodes"]
    assert (none.slope, none.last, none.biased, published._curve(none).bound) == (None, None, False, None)


def test_a_rival_that_is_not_resolved_is_no_factor():
    cell = accuracy()
    cell["contenders"]["mirror, nodes"]["resolved"] = [False] * len(COUNTS)
    wins = contested(cell).wins
    assert wins
    assert all(win.over.keys() == {"closure"} for win in wins)
    rare = contested(accuracy("sun"))
    assert rare.rarely_hit == {"mirror"}
    assert all("mirror" not in win.over for win in rare.wins)


def test_a_count_that_is_not_resolved_is_bridged_between_two_that_are():
    """Straight in both logarithms; beyond the last that is known nothing is."""
    cell = accuracy()
    cell["contenders"]["closure, nodes"]["resolved"] = [k not in (3, 4, len(COUNTS) - 1) for k in range(len(COUNTS))]
    curve = contested(cell).curves["closure, nodes"]
    before, after = (np.log(curve.rmse[k]) for k in (2, 5))
    assert np.log(curve.error_of(COUNTS[3])) == pytest.approx(before + (after - before) / 3, rel=1e-12)
    assert curve.error_of(COUNTS[-2]) == pytest.approx(curve.rmse[-2], rel=1e-12)
    assert curve.error_of(1.01 * COUNTS[-2]) == np.inf


def test_there_is_no_winner_where_a_rival_is_not_known():
    """closure is known at 4096 samples alone: before that it might be the best."""
    cell = accuracy()
    cell["contenders"]["closure, nodes"]["resolved"] = [False] * (len(COUNTS) - 1) + [True]
    assert contested(cell).wins == []


def test_where_setup_dominates_there_is_no_winner():
    """Of 16, 64 and 256 samples of 1 ms after 0.5 s: noise .3 / sqrt(N) and a bias of .05 or none."""
    cell = accuracy(counts=(16, 64, 256))
    cell["contenders"] = {
        f"{name}, nodes": contender(bias, 0.3, 1e-3, 0.5, (16, 64, 256), estimator=name, backend="nodes")
        for name, bias in (("closure", 0.05), ("fit", 0.0))
    }
    assert contested(cell).wins == []
    assert only({"accuracy/a/b": cell}).wins == []


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
    assert rmse.std() < contested(cell).curves["x"].rmse_error[0] < 1.29 * rmse.std()
