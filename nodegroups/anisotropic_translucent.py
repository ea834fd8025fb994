# SPDX-License-Identifier: GPL-3.0-or-later
"""A translucent body under a brushed coat: as ``translucent``."""

from functools import partial

from ..addon.models.anisotropic_translucent import MODEL
from . import anisotropic, translucent

NAME = "VGroove Anisotropic Translucent"
REVISION = 2
build = partial(translucent.build, spec=MODEL)
variant = anisotropic.with_radial(translucent.variant)
