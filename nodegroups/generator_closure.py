# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Lambert, and Cycles' own Beckmann lobe for each of a few distributions in place of D."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .generator_fit import REVISION, build_lobes

if TYPE_CHECKING:
    from ..addon.reference.facet_distribution import Distribution
    from ._tree import Tree

__all__ = ["NAME", "REVISION", "build", "build_osl"]

NAME = "VGroove Generator Closure"


def build(tree: Tree, kind: str, of: Distribution) -> None:
    build_lobes(tree, kind, of, "closure", osl=False)


def build_osl(tree: Tree, kind: str, of: Distribution) -> None:
    build_lobes(tree, kind, of, "closure", osl=True)
