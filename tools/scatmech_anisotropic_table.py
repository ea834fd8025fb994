# SPDX-License-Identifier: GPL-3.0-or-later
"""Write tests/data/scatmech_anisotropic.csv: anisotropic Cook-Torrance BRDF values, computed by others than us.

SCATMECH has no elliptical Gaussian. So it gives all but the distribution (its Unit_Slope_Distribution_Function is 1 for
every slope), and mpmath the density of the slopes, at 50 digits. Nothing of the code under test takes part. As for
``scatmech_table``, from a checkout with a C++ compiler:

    uv run --group scatmech python tools/scatmech_anisotropic_table.py
"""

from __future__ import annotations

import platform
import random
from itertools import product
from typing import NamedTuple

import mpmath
import scatmech_table as isotropic
from pySCATMECH.brdf import BRDF_Model

TABLE = isotropic.TABLE.with_name("scatmech_anisotropic.csv")
COMMAND = "uv run --group scatmech python tools/scatmech_anisotropic_table.py"
SLOPES = ((0.02, 0.1), (0.26, 0.05), (0.1, 0.1), (0.1, 0.4), (0.6, 0.06), (1.0, 0.3), (0.03, 1.0))
MATERIALS = ((1.5, 0.0), (2.417, 0.0), (0.29, 3.6), (1.2, 7.26))
KINDS = ("mirror", "forward", "normal light", "grazing light", "grazing view", "off plane", "off plane", "off plane")


class Row(NamedTuple):
    """One line of the table. Field names are the column names."""

    theta_i_deg: float
    phi_i_deg: float
    theta_o_deg: float
    phi_o_deg: float
    m_x: float
    m_y: float
    n: float
    k: float
    f: float


def all_but_distribution(n: float, k: float) -> BRDF_Model:
    """SCATMECH's facet model with slopes of equal density 1."""
    parameters = {
        "lambda": "1",
        "type": "0",
        "substrate": f"({n!r},{k!r})",
        "sdf": {None: "Unit_Slope_Distribution_Function"},
        "shadow": {None: "Torrance_Sparrow_Shadow_Function"},
    }
    return BRDF_Model("Shadowed_Facet_BRDF_Model", parameters)


def density(row: Row) -> float:
    """exp(-(p/m_x)^2 - (q/m_y)^2) / (pi m_x m_y) of the slopes p, q of the facet that mirrors wi to wo."""
    with mpmath.workdps(50):

        def direction(theta: float, phi: float) -> list[mpmath.mpf]:
            theta, phi = (mpmath.radians(mpmath.mpf(repr(angle))) for angle in (theta, phi))
            return [mpmath.sin(theta) * mpmath.cos(phi), mpmath.sin(theta) * mpmath.sin(phi), mpmath.cos(theta)]

        x, y, z = (a + b for a, b in zip(direction(*row[:2]), direction(*row[2:4]), strict=True))
        m_x, m_y = mpmath.mpf(repr(row.m_x)), mpmath.mpf(repr(row.m_y))
        return float(mpmath.exp(-((x / z / m_x) ** 2) - (y / z / m_y) ** 2) / (mpmath.pi * m_x * m_y))


def make_table(rng: random.Random) -> list[Row]:
    """Rows of the table: facets in the lobe of the geometric mean of both slopes, turned to any azimuth."""
    table = []
    for (m_x, m_y), (n, k) in product(SLOPES, MATERIALS):
        scatmech = all_but_distribution(n, k)
        for kind in KINDS:
            found, row = 0.0, None
            while found < 1e-30:  # far out along the narrow slope there is next to nothing
                directions, _ = isotropic.choose(rng, kind, (m_x * m_y) ** 0.5)
                turn = rng.choice((0.0, 30.0, 45.0, 90.0, 137.25, 200.5, 270.0, 341.75))
                azimuth = round((turn + directions.phi) % 360.0, 2)
                row = Row(directions.theta_i, turn, directions.theta_o, azimuth, m_x, m_y, n, k, 0.0)
                found = density(row) * isotropic.brdf(scatmech, directions)
            table.append(row._replace(f=found))
    return table


def header(rows: int) -> str:
    """Comment lines: what made the table, and how to read it."""
    return f"""\
# SPDX-License-Identifier: GPL-3.0-or-later
# Anisotropic Cook-Torrance BRDF from independent programs: Shadowed_Facet_BRDF_Model with
# Unit_Slope_Distribution_Function and Torrance_Sparrow_Shadow_Function of NIST SCATMECH {isotropic.SCATMECH}, called
# through pySCATMECH {isotropic.PYSCATMECH} on Python {platform.python_version()}, times the density of slopes by mpmath
# {mpmath.__version__} at 50 digits. Made by: {COMMAND}
#
# theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg: degrees, of wi (to the light) and wo (to the viewer).
# m_x, m_y: RMS slopes along azimuth 0 and 90; D cos^4 = exp(-(p / m_x)^2 - (q / m_y)^2) / (pi m_x m_y).
# n, k: complex index n + ik of the surface, in vacuum; F is exact and unpolarised. Chosen, not measured.
# f: BRDF in 1/sr, without the cosine. {rows} rows.
"""


def main() -> None:
    """Write the table and say how long it is."""
    table = make_table(random.Random(isotropic.SEED))
    lines = [",".join(Row._fields), *(",".join(map(repr, row)) for row in table)]
    TABLE.write_text(header(len(table)) + "\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    print(f"{len(table)} rows written")


if __name__ == "__main__":
    main()
