# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show a body that scatters light below its coat."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .nodes import LOBE, Peer, principled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ....addon.library.presets import Preset

LOCAL = False
UNIVERSAL = {"s": 1.0, "coupled": 1.0, "body": 1.0}


def cycles(preset: Preset) -> Iterator[Peer]:
    of: dict[str, Any] = preset.parameters
    yield principled(
        f"{LOBE}; the same scattering below it",
        Base_Color=of["reflectance"],
        Subsurface_Weight=1.0,
        Subsurface_Radius=of["mean_free_path"],
        Subsurface_Scale=1.0,
        IOR=of["eta"],
        Roughness=of["m"] ** 0.5,
    )


def mitsuba(_preset: Preset) -> None:
    return None
