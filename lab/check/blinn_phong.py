# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Blinn-Phong, as for Phong."""

from __future__ import annotations

from functools import partial

from . import phong

plan = partial(phong.plan, "blinn_phong")
