# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/errata.md: the corrected formulas are right, as printed they are not."""

import pytest

from vgroove.lab.bench.figures import errata


def test_the_corrected_column_is_right_and_the_printed_one_is_not():
    """The corrected D integrates to 1 and the corrected F head-on is ((eta - 1)/(eta + 1))^2; as printed neither."""
    tables = errata.tables()
    for _, printed, _, corrected in tables["area"].rows:
        assert corrected == pytest.approx(1.0, abs=1e-12)
        assert printed == pytest.approx(0.785398, abs=1e-6)  # pi/4
    for _, exact, wrong_g, wrong_sign, corrected in tables["head_on"].rows:
        assert corrected == pytest.approx(exact, abs=1e-12)
        assert abs(wrong_g - exact) > 0.01
        assert abs(wrong_sign - exact) > 0.01
    assert len(tables["oblique"].rows) == 5
