# SPDX-License-Identifier: GPL-3.0-or-later
"""Slopes and directions at which several tests evaluate the models: tables, and strategies for hypothesis."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

UP = np.array([0.0, 0.0, 1.0])
ANGLES = np.deg2rad([0, 10, 30, 45, 60, 70, 80, 85, 88, 89, 89.9, 89.99])
SLOPES = [1e-6, 1e-3, 0.02, 0.1, 0.3, 0.6, 1.0, 3.0, 10.0]

# The same examples in every run; a few are enough where each is a whole array of directions.
thorough = settings(
    max_examples=60, deadline=None, derandomize=True, database=None, suppress_health_check=[HealthCheck.too_slow]
)
slopes = st.floats(np.log(1e-6), np.log(10.0)).map(np.exp).map(lambda m: min(max(float(m), 1e-6), 10.0))
# Tangent, the smallest numbers, both sides of the 1e-50 that counts as tangent, grazing, and below the surface.
special = st.sampled_from([0.0, -0.0, 5e-324, 1e-160, 1e-50, 2e-50, 1e-20, 1e-8, 1e-4, 1.0, -5e-324, -1e-8, -0.3, -1.0])
heights = st.one_of(special, st.floats(0.0, 1.0), st.floats(0.0, 1e-3))
# The azimuths that make one direction the mirror image of the other, and any.
azimuths = st.one_of(st.sampled_from([0.0, np.pi / 2, np.pi, 3 * np.pi / 2]), st.floats(0.0, 2 * np.pi))


def at_height(z, phi=0.0):
    """The unit vector of height ``z`` above the surface."""
    z, phi = np.broadcast_arrays(np.asarray(z, dtype=float), phi)
    radius = np.sqrt((1 - z) * (1 + z))
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), z], axis=-1)


directions = st.builds(at_height, heights, azimuths)
upper = st.builds(at_height, st.floats(1e-3, 1.0), st.floats(0.0, 2 * np.pi))
bundles = st.lists(directions, min_size=12, max_size=12).map(np.stack)
