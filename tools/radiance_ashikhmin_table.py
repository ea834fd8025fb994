# SPDX-License-Identifier: GPL-3.0-or-later
"""Write tests/data/radiance_ashikhmin.csv: values of Ashikhmin & Shirley's highlight computed by Radiance, not by us.

Radiance's own Ashikhmin.cal is loaded once for each material, with the constants that it says are to be changed. What
is chosen here are directions alone: half vectors within a few deviations of the lobe. Run by:

    uv run --with pyradiance==1.3.1 python tools/radiance_ashikhmin_table.py
"""

from __future__ import annotations

import math
import platform
import random
import re
import tempfile
from importlib.metadata import version
from pathlib import Path

import pyradiance

TABLE = Path(__file__).resolve().parents[1] / "tests" / "data" / "radiance_ashikhmin.csv"
COMMAND = "uv run --with pyradiance==1.3.1 python tools/radiance_ashikhmin_table.py"
EXPONENTS = ((1.0, 1.0), (10.0, 10.0), (5.0, 80.0), (100.0, 10.0), (1000.0, 1000.0), (20.0, 2000.0), (8000.0, 100.0))
F0 = (0.0, 0.05, 0.5, 1.0)
EACH = 8  # rows of each material
# Radiance divides by 1 - hz^2 of rounded numbers: a facet that leans by t costs n t^2/2 times 1e-16 / t^2 of the value
LEAST = 0.02  # of a facet's slope
COLUMNS = ("ix", "iy", "iz", "ox", "oy", "oz", "n_u", "n_v", "f0", "f")


def load(folder: Path, **constants: float) -> None:
    """Radiance's file with these constants, under a name of its own: a name is loaded once."""
    text = (Path(pyradiance.__file__).parent / "lib" / "Ashikhmin.cal").read_text(encoding="utf-8")
    for name, value in constants.items():
        text, found = re.subn(rf"(?m)^{name} : .*;$", f"{name} : {value!r};", text)
        assert found == 1, name
    path = folder / f"{len(list(folder.iterdir()))}.cal"
    path.write_text(text, encoding="utf-8")
    pyradiance.loadfunc(str(path))


def unit(*v: float) -> tuple[float, ...]:
    """v, scaled to length 1."""
    length = math.hypot(*v)
    return tuple(part / length for part in v)


def directions(rng: random.Random, n_u: float, n_v: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """wi and wo, both above the surface, about a half vector in the lobe."""
    while True:
        theta, phi = math.radians(rng.choice((5, 30, 60, 75, 85))), rng.uniform(0.0, math.tau)
        wi = unit(math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))
        p, q = (rng.gauss(0.0, 1.5) / math.sqrt(n + 1.0) for n in (n_u, n_v))
        h = unit(p, q, 1.0)
        vh = sum(a * b for a, b in zip(wi, h, strict=True))
        wo = unit(*(2.0 * vh * b - a for a, b in zip(wi, h, strict=True)))
        if math.hypot(p, q) > LEAST and wo[2] > 0.02:
            return wi, wo


def main() -> None:
    """Write the table and say how long it is."""
    pyradiance.initfunc()
    rng, rows = random.Random(2000), []
    with tempfile.TemporaryDirectory() as folder:
        for n_u, n_v in EXPONENTS:
            for f0 in F0:
                load(Path(folder), rho_d=0.0, rho_s=1.0, f0=f0, nu=n_u, nv=n_v)
                for _ in range(EACH):
                    wi, wo = directions(rng, n_u, n_v)
                    value = pyradiance.eval(f"ashikhmin({','.join(map(repr, (*wi, *wo)))})")
                    rows.append((*wi, *wo, n_u, n_v, f0, value))
    head = f"""\
# SPDX-License-Identifier: GPL-3.0-or-later
# Ashikhmin & Shirley's highlight with Schlick's F from an independent program: Ashikhmin.cal of Radiance, through
# pyradiance {version("pyradiance")} on Python {platform.python_version()}. Made by: {COMMAND}
#
# ix, iy, iz, ox, oy, oz: unit vectors to the light and to the viewer, tangent x, normal z.
# n_u, n_v, f0: exponents along x and y, reflectance head-on. f: BRDF in 1/sr, without the cosine. {len(rows)} rows.
"""
    lines = [",".join(COLUMNS), *(",".join(map(repr, row)) for row in rows)]
    TABLE.write_text(head + "\n".join(lines) + "\n", encoding="utf-8", newline="\n")
    print(f"{len(rows)} rows written")


if __name__ == "__main__":
    main()
