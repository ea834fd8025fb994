# SPDX-License-Identifier: GPL-3.0-or-later
"""Batch renders: a job file makes tasks, and each task makes one still. ``job`` plans, ``task`` renders."""
