# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows of Blinn-Phong from Blender 5.3 on; see ``phong_eevee``."""

from .phong_eevee import REVISION, build

__all__ = ["NAME", "REVISION", "build"]
NAME = ".VGroove Blinn-Phong EEVEE"
