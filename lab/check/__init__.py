# SPDX-License-Identifier: GPL-3.0-or-later
"""Every model by every estimator and backend: Cycles against NumPy."""
