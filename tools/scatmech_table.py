# SPDX-License-Identifier: GPL-3.0-or-later
"""Write tests/data/scatmech.csv: Cook-Torrance BRDF values computed by NIST SCATMECH, not by us.

The table is an oracle, so this file evaluates nothing of the formula under test: it only picks directions, asks
SCATMECH and writes down the answer. Run from a checkout with a C++ compiler; building SCATMECH takes some minutes:

    uv run --group scatmech python tools/scatmech_table.py

Source: T. A. Germer, SCATMECH: Polarized Light Scattering C++ Class Library, NIST; code/facet.cpp and torrspar.cpp.
"""

import math
import platform
import random
from collections import Counter
from importlib.metadata import version
from itertools import product
from pathlib import Path
from typing import NamedTuple

from pySCATMECH.brdf import BRDF_Model

TABLE = Path(__file__).resolve().parents[1] / "tests" / "data" / "scatmech.csv"
COMMAND = "uv run --group scatmech python tools/scatmech_table.py"
PYSCATMECH = "0.1.10"
SCATMECH = "7.23"  # Get_SCATMECH_Version() inside that pySCATMECH, which does not pass it on to Python

SEED = 1982
SLOPES = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0)
MATERIALS = (  # n, k: water, glass, diamond; then round figures in the manner of copper, gold and aluminium
    (1.333, 0.0),
    (1.5, 0.0),
    (2.417, 0.0),
    (0.29, 3.6),
    (0.18, 3.0),
    (1.2, 7.26),
)
KINDS = (  # one row of each per slope and material
    "mirror",  # h is the normal
    "forward",  # in the plane of incidence, phi = 180
    "backward",  # in the plane of incidence, phi = 0
    "normal light",  # theta_i = 0
    "grazing light",
    "grazing view",
    "off plane",
    "off plane",
    "off plane",
)
MIRROR_ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 88.0)

PHI = {"forward": 180.0, "backward": 0.0}
GRAZING = 70.0  # degrees; smallest angle that counts as such
STEEPEST = 88.0  # degrees; largest theta_i and theta_o
FARTHEST = 4.0  # facet slopes drawn reach this many m: D there is exp(-16) of its peak
# SCATMECH turns the polarisation by dividing by sin^2 of twice the half angle, itself the acos of a cosine near 1. The
# rounding of that cosine then costs about 1e-15 / half^2: at 3 degrees 4e-13 of f, at 0.1 degrees 3e-10.
SMALLEST_HALF_ANGLE = 3.0  # degrees, between wi and h


class Directions(NamedTuple):
    """Where light and viewer are, in degrees; phi is the azimuth of wo when that of wi is 0."""

    theta_i: float
    theta_o: float
    phi: float


class Row(NamedTuple):
    """One line of the table. Field names are the column names."""

    theta_i_deg: float
    theta_o_deg: float
    phi_deg: float
    m: float
    n: float
    k: float
    f: float


def unit_vector(theta: float, phi: float) -> tuple[float, float, float]:
    """Direction of polar angle theta from the normal and azimuth phi, both in degrees."""
    theta, phi = math.radians(theta), math.radians(phi)
    return math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)


def reflected(theta_i: float, tilt: float, azimuth: float) -> Directions | None:
    """Viewer who sees light from theta_i in a facet tilted towards azimuth, or None if there is none up to STEEPEST.

    All in degrees. The angles of the viewer are rounded to 0.01, small against the narrowest lobe (1.1), so that the
    decimals in the table are exact.
    """
    wi, h = unit_vector(theta_i, 0.0), unit_vector(tilt, azimuth)
    along = sum(a * b for a, b in zip(wi, h, strict=True))
    x, y, z = (2 * along * b - a for a, b in zip(wi, h, strict=True))
    theta_o = round(math.degrees(math.atan2(math.hypot(x, y), z)), 2)
    if along <= 0 or theta_o > STEEPEST:
        return None
    return Directions(theta_i, theta_o, round(math.degrees(math.atan2(y, x)), 2) % 360)


def draw(rng: random.Random, kind: str, m: float) -> Directions | None:
    """One random pair of directions whose half vector lies in the lobe of slope m; None if the draw misses the kind."""
    if kind == "mirror":
        theta = rng.choice(MIRROR_ANGLES)
        return Directions(theta, theta, 180.0)
    tilt = math.degrees(math.atan(m * rng.uniform(0, FARTHEST)))
    low, high, azimuth = 0.0, STEEPEST, rng.uniform(0, 360)
    match kind:
        case "forward":
            azimuth = rng.choice((0.0, 180.0))
        case "backward":
            high, azimuth = min(2 * tilt, STEEPEST), 0.0
        case "normal light":
            high = 0.0
        case "grazing light" | "grazing view":
            low = GRAZING
    found = reflected(round(rng.uniform(low, high), 2), tilt, azimuth)
    if found is None or found.phi != PHI.get(kind, found.phi):
        return None
    return Directions(found.theta_o, found.theta_i, found.phi) if kind == "grazing view" else found


def is_well_conditioned(directions: Directions) -> bool:
    """Whether SCATMECH rounds to better than 1e-12, see SMALLEST_HALF_ANGLE; exactly 0 is a case of its own there."""
    theta_i, theta_o, phi = directions
    wi, wo = unit_vector(theta_i, 0.0), unit_vector(theta_o, phi)
    half = math.degrees(math.asin(min(math.dist(wi, wo) / 2, 1.0)))
    return half >= SMALLEST_HALF_ANGLE or theta_i == theta_o == 0


def model(m: float, n: float, k: float, shadow: str = "Torrance_Sparrow_Shadow_Function") -> BRDF_Model:
    """SCATMECH's facet model. Numbers go in as text: pySCATMECH cuts a Python complex to six digits."""
    parameters = {
        "lambda": "1",  # plays no part: substrate is given as n and k
        "type": "0",  # reflection
        "substrate": f"({n!r},{k!r})",
        "sdf": {None: "Gaussian_Slope_Distribution_Function", "s": repr(m)},
        "shadow": {None: shadow},
    }
    return BRDF_Model("Shadowed_Facet_BRDF_Model", parameters)


def brdf(scatmech: BRDF_Model, directions: Directions) -> float:
    """Unpolarised BRDF in 1/sr. SCATMECH's azimuth is 0 towards the mirror direction, ours there is 180."""
    theta_i, theta_o, phi = directions
    return float(scatmech.BRDF(math.radians(theta_i), math.radians(theta_o), math.radians(180 - phi)))


def g_branch(row: Row) -> str:
    """Branch of G at work, found without writing G down: by what SCATMECH gives when nothing shadows."""
    bare = model(row.m, row.n, row.k, "Unit_Shadow_Function")
    if row.f >= brdf(bare, Directions(*row[:3])) * (1 - 1e-12):
        return "neither"
    return "light" if row.theta_i_deg > row.theta_o_deg else "view"


def choose(rng: random.Random, kind: str, m: float) -> tuple[Directions, int]:
    """Directions fit for the table, and how many of that kind were dropped on the way as ill conditioned."""
    dropped = 0
    while True:
        directions = draw(rng, kind, m)
        if directions is None:
            continue
        if is_well_conditioned(directions):
            return directions, dropped
        dropped += 1


def make_table(rng: random.Random) -> tuple[list[Row], int]:
    """Rows of the table, and the number of pairs of directions dropped."""
    table, total = [], 0
    for m, (n, k) in product(SLOPES, MATERIALS):
        scatmech = model(m, n, k)
        for kind in KINDS:
            directions, dropped = choose(rng, kind, m)
            table.append(Row(*directions, m, n, k, brdf(scatmech, directions)))
            total += dropped
    return table, total


def header(table: list[Row], dropped: int) -> str:
    """Comment lines: what made the table, and how to read it."""
    branches = Counter(map(g_branch, table))
    one, light, view = (branches[branch] for branch in ("neither", "light", "view"))
    return f"""\
# SPDX-License-Identifier: GPL-3.0-or-later
# Cook-Torrance BRDF from an independent program: Shadowed_Facet_BRDF_Model with Gaussian_Slope_Distribution_Function
# and Torrance_Sparrow_Shadow_Function of NIST SCATMECH {SCATMECH}, called through pySCATMECH {PYSCATMECH} on Python
# {platform.python_version()}; both are in the public domain. Made by: {COMMAND}
#
# theta_i_deg, theta_o_deg: degrees, angle from the normal of wi (to the light) and wo (to the viewer).
# phi_deg: degrees, azimuth of wo relative to wi; 180 holds the mirror direction, 0 is towards the light.
# m: RMS slope of the facets as in D = exp(-tan^2 / m^2) / (pi m^2 cos^4); dimensionless.
# n, k: complex index n + ik of the surface, in vacuum; F is exact and unpolarised. Chosen, not measured.
# f: BRDF in 1/sr, without the cosine.
#
# The decimals of the angles are exact: unit vectors built from them in float64 give f within 1e-12 relative.
# {len(table)} rows; G is 1 in {one}, cut on the side of the light in {light} and of the viewer in {view}.
# Drawn and dropped: {dropped} pairs of directions with less than {SMALLEST_HALF_ANGLE:g} degrees (but not 0)
# between wi and h, where SCATMECH itself loses digits: it divides by sin^2 of twice that angle.
"""


def main() -> None:
    """Write the table and say what is in it."""
    if version("pySCATMECH") != PYSCATMECH:
        message = f"pySCATMECH {version('pySCATMECH')} found; the table is made with {PYSCATMECH}, from pyproject.toml"
        raise SystemExit(message)
    table, dropped = make_table(random.Random(SEED))
    lines = [",".join(Row._fields), *(",".join(map(repr, row)) for row in table)]
    TABLE.parent.mkdir(parents=True, exist_ok=True)
    TABLE.write_text(header(table, dropped) + "\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    print(f"{len(table)} rows written, {dropped} pairs of directions dropped as ill conditioned")


if __name__ == "__main__":
    main()
