# SPDX-License-Identifier: GPL-3.0-or-later
"""The conditions on a specular part under which light reaches the layers below it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import fresnel

if TYPE_CHECKING:
    from .spec import Form

HIGHEST_F0, HIGHEST_ETA = 0.25, 3.0  # limits of the fit of the specular albedo in the shaders, and of its tests


def flaw(what: str, form: Form) -> str:
    """Why ``what`` ("a coupled sum") cannot have this specular part: no light passes, or how much is unknown; or ""."""
    numbers = form.parameters
    if fresnel.KINDS[form.kind].is_metal:
        return f"{what} needs eta or f0: no light passes a metal to what lies below"
    if form.kind == "schlick" and len(set(numbers["f0"])) > 1:
        return f"{what} needs an f0 without colour, got {list(numbers['f0'])}; give one number"
    if form.kind == "schlick" and max(numbers["f0"]) > HIGHEST_F0:
        return f"{what} needs f0 of at most {HIGHEST_F0:g} (an index of 3), got {max(numbers['f0']):g}"
    if form.kind == "dielectric" and not 1.0 <= numbers["eta"] <= HIGHEST_ETA:
        return f"{what} needs eta from 1 to {HIGHEST_ETA:g}, got {numbers['eta']:g}"
    if numbers["m"] > 1.0:
        return f"{what} needs m of at most 1, got {numbers['m']:g}"
    return ""
