# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line's contract against all kinds of bad input: no traceback, no hang, one line, nothing left behind.

The commands run in this process, as Blender starts slowly. Tables hold the kinds of faults that were found once;
hypothesis looks for their neighbours.
"""

from pathlib import Path

from hypothesis import HealthCheck, settings

REPORT = Path(__file__).parents[1] / "data" / "report.json"
FUZZ = settings(
    max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
SMALL = ("--samples", "1", "--resolution", "4x4", "--estimator", "closure")
