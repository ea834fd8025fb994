# SPDX-License-Identifier: GPL-3.0-or-later
"""A rough diffuse part under a brushed specular one: as ``sum``."""

from functools import partial

from ..addon.models.anisotropic_sum import MODEL
from . import anisotropic
from . import sum as plain

NAME = "VGroove Anisotropic Sum"
REVISION = 2
build = partial(plain.build, spec=MODEL)
variant = anisotropic.with_radial(plain.variant)
