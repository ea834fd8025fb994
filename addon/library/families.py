# SPDX-License-Identifier: GPL-3.0-or-later
"""The families that artists choose from, by what a material is; folders of presets go by model and source.

Imports no bpy.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .preset import Preset

TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))["families"]
TITLES = tuple(family["title"] for family in TABLE)
LABORATORY = "Laboratory"
ROUGH = 0.2  # slope m from which a tenth of what a metal's facets mirror may bounce on, and not near grazing alone
SPECIAL = TITLES.index("Over Time")  # from here on not what a search is mostly about


def of(preset: Preset) -> str:
    """The title of a preset's family."""
    return title(preset.id)


def gets_bounces(preset: Preset) -> bool:
    """Whether artists get light that bounces within its grooves unless they say no: of rough metals, as materials.

    The Laboratory's presets stand for their papers, which count one bounce.
    """
    return preset.can_bounce and preset.m >= ROUGH and of(preset) != LABORATORY


def number(identity: str) -> int:
    """The place of the family of a preset's id: a user's own come first, the laboratory last."""
    return TITLES.index(title(identity)) if title(identity) in TITLES else -1


def title(identity: str) -> str:
    """The title of the family of a preset's id; of a user's own folder its name."""
    return _family(identity)["title"]


@cache
def _family(identity: str) -> dict[str, str]:
    folder = identity.partition("/")[0]
    by_id = (family for family in TABLE if identity in family.get("presets", ()))
    by_folder = (family for family in TABLE if folder in family["folders"])
    return next(by_id, None) or next(by_folder, None) or {"title": folder.replace("_", " ").title()}
