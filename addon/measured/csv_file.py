# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured BRDF as CSV, for spreadsheets and plots; ``read`` takes it back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..library.files import check_writable, replacing
from ..reference.directions import spherical

if TYPE_CHECKING:
    from pathlib import Path

    from .table import Table

COLUMNS = "theta_i,phi_i,theta_o,phi_o,R,G,B"  # degrees, and f in 1/sr
STEP, COARSE_STEP = 5.0, 15.0  # degrees, which give some 20000 lines of an isotropic and an anisotropic surface


def write_csv(path: Path, table: Table, step: float | None = None) -> None:
    """f at polar angles from 0 below 90 and azimuths all around, every ``step`` degrees; phi_i is 0 if isotropic."""
    isotropic = table.contents.isotropic
    step = step or (STEP if isotropic else COARSE_STEP)
    check_writable(path)
    theta, phi = np.arange(0.0, 90.0, step), np.arange(0.0, 360.0, step)
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8") as file:
        file.write(COLUMNS + "\n")
        for theta_i in theta:
            for phi_i in phi[:1] if isotropic else phi:
                theta_o, phi_o = (one.ravel() for one in np.meshgrid(theta, phi, indexing="ij"))
                wi = spherical(np.radians(theta_i), np.radians(phi_i))
                f = table.evaluate(wi, spherical(np.radians(theta_o), np.radians(phi_o)))
                light = np.full((len(f), 2), [theta_i, phi_i])
                np.savetxt(file, np.column_stack([light, theta_o, phi_o, f]), "%.9g", ",")
