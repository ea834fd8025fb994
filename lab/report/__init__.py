# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove report``: error against run time, stability, and what was left out, as numbers, plots and one page.

``run`` measures, part by part (``PARTS``), and keeps every number in report.json; ``draw`` makes plots and pages of
that file alone, so that a report is redrawn, or held against another, without a render.
"""
