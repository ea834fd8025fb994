# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences of the extension. They belong to its root package, two levels up."""

from __future__ import annotations

import bpy

ROOT = __package__.removesuffix(".addon.ui")


class VGroovePreferences(bpy.types.AddonPreferences):
    """What the panel offers at first."""

    bl_idname = ROOT

    show_advice: bpy.props.BoolProperty(
        name="Show Scene Advice",
        description="List in the panel what keeps the chosen estimator from rendering as it should",
        default=True,
    )

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.prop(self, "show_advice")


CLASSES = (VGroovePreferences,)
