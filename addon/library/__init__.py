# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: read, checked, searched, written, and their courses over time. Imports no bpy."""
