# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct`` of Blinn-Phong: Phong's builders with Blinn's lobe."""

from .phong_direct import REVISION, build, build_osl

__all__ = ["NAME", "REVISION", "build", "build_osl"]

NAME = "VGroove Blinn-Phong Direct"
