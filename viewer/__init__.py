# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF viewer: an interactive page of one file. JavaScript beside it draws; ``page`` puts it together.

The formulas of ``models/NAME.js`` are those of ``addon/reference/NAME.py``; tests/viewer compares them.
"""
