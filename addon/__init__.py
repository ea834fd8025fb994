# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in Python but the node groups; the folder names are the architecture (docs/architecture.md)."""
