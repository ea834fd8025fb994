# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``corrected`` of Blinn-Phong: Phong's builders with Blinn's lobe."""

from .phong_corrected import REVISION, build, build_osl

__all__ = ["NAME", "REVISION", "build", "build_osl"]

NAME = "VGroove Blinn-Phong Corrected"
