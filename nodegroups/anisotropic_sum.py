# SPDX-License-Identifier: GPL-3.0-or-later
"""A rough diffuse part under a brushed specular one: as ``sum``."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from ..addon.models.anisotropic import RADIAL
from ..addon.models.anisotropic_sum import MODEL
from . import anisotropic
from . import sum as plain

if TYPE_CHECKING:
    import bpy

    from ..addon.models import Form

NAME = "VGroove Anisotropic Sum"
REVISION = 1
build = partial(plain.build, spec=MODEL)


def variant(
    form: Form, estimator: str, parts: dict[str, bpy.types.ShaderNodeTree]
) -> tuple[str, dict[str, Any]]:  # fmt: skip
    """What the name of a preset's group says of its form, and what its builder has to know."""
    radial = RADIAL in form.flags
    label, given = plain.variant(form, estimator, parts)
    return label + " Radial" * radial, given | {"seen": partial(anisotropic.seen, radial=radial)}
