# SPDX-License-Identifier: GPL-3.0-or-later
"""The error that pictures tell of their mean is the error that it has."""

import numpy as np
import pytest

from vgroove.batch.mean import Mean

PIXELS = (100, 100, 3)


def test_the_error_of_normal_pictures_is_theirs():
    """Of pictures of different numbers of samples, whose noise of one sample is half of what they show.

    With B - 1 = 2 degrees of freedom in each of 30,000 values the estimated variance is good to sqrt(2 / 60000) and its
    root to half of that, .3 %; the true root mean square to 1 / sqrt(60000). Four standard deviations of both: 2 %.
    """
    draw = np.random.default_rng(1)
    mean = Mean()
    for samples in (16, 16, 400):
        mean.add(2.0 + draw.normal(0.0, 1.0 / np.sqrt(samples), PIXELS), samples)
    assert mean.samples == 432
    assert mean.error == pytest.approx(0.5 / np.sqrt(432), rel=0.02)
    true = np.sqrt(np.mean((mean.picture - 2.0) ** 2)) / 2.0
    assert mean.error == pytest.approx(true, rel=0.02)


def test_of_one_picture_it_is_not_known():
    """Of none that differ it is 0, and black but for noise inf."""
    mean = Mean()
    mean.add(np.ones(PIXELS, np.float32), 4)
    assert np.isnan(mean.error)
    mean.add(np.ones(PIXELS, np.float32), 4)
    assert mean.error == 0.0
    black = Mean()
    black.add(np.full(PIXELS, 1.0), 4)
    black.add(np.full(PIXELS, -1.0), 4)
    assert black.error == np.inf
