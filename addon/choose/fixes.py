# SPDX-License-Identifier: GPL-3.0-or-later
"""What the buttons of ``advice`` do: change a scene so that a problem is gone."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

from ..blender.rebuild import rebuild
from ..library.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import Material, Object, Scene

    from ..blender import facts

SUN_SIZE = radians(0.526)  # the real sun's mean angular diameter
LAMP_SIZE = 0.05  # metres: what "Give Lights a Size" gives points and spots


def set_values(owner: object, **values: object) -> None:
    for name, value in values.items():
        setattr(owner, name, value)


def give_size(pointlike: Sequence[facts.Light]) -> None:
    for one in pointlike:
        set_size([one.item], SUN_SIZE if one.item.data.type == "SUN" else LAMP_SIZE)


def set_size(items: Sequence[Object], size: float) -> None:
    for item in items:
        setattr(item.data, {"SUN": "angle", "AREA": "size"}.get(item.data.type, "shadow_soft_size"), size)


def sample_lights(unsampled: Sequence[facts.Light]) -> None:
    for one in unsampled:
        one.item.data.cycles.use_multiple_importance_sampling = True


def clear_offsets(items: Sequence[Object]) -> None:
    for item in items:
        item.shadow_terminator_shading_offset = 0.0


def rebuild_all(found: Sequence[Material], scene: Scene) -> None:
    """Rebuild all that can be rebuilt; then raise the first refusal, if there was one."""
    refused = None
    for made in found:
        try:
            rebuild(made, scene)
        except InputError as error:
            refused = refused or error
    if refused:
        raise refused
