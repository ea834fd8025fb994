# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure`` of Blinn-Phong: Phong's builders with Blinn's lobe."""

from .phong_closure import REVISION, build, build_osl

__all__ = ["NAME", "REVISION", "build", "build_osl"]

NAME = "VGroove Blinn-Phong Closure"
