# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report measures: error against run time, picks, stability, what was left out, everyday scenes."""
