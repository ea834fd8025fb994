# SPDX-License-Identifier: GPL-3.0-or-later
"""How we know: check/ compares Cycles with NumPy, bench/ measures, report/ tells."""
