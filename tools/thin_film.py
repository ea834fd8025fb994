# SPDX-License-Identifier: GPL-3.0-or-later
"""What an absorbing film on a metal reflects, by interference: the colours of heat-tinted steel.

python tools/thin_film.py            prints linear Rec.709 of magnetite on iron for a row of thicknesses
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from optical_constants import AT, WAVELENGTHS, Constants, constants, weights

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def film_reflectance(film: Constants, metal: Constants, nm: ArrayLike, cosine: float) -> NDArray[np.float64]:
    """RGB, (..., 3), in air for a film of thickness ``nm`` (...), unpolarised; outside 0..1 where Rec.709 ends.

    r = (r01 + r12 e) / (1 + r01 r12 e), e = exp(-2 i b), b = 2 pi N1 cos(theta_1) d / wavelength, with Fresnel's r of
    both interfaces for N = n - i k. Source: Born & Wolf, Principles of Optics, 7.6 and 14.4.
    """
    n1, n2 = film.n - 1j * film.k, metal.n - 1j * metal.k
    sine2 = 1.0 - cosine**2
    cos1, cos2 = np.sqrt(1.0 - sine2 / n1**2), np.sqrt(1.0 - sine2 / n2**2)
    phase = np.exp(-4j * np.pi * n1 * cos1 * np.asarray(nm, float)[..., None] / WAVELENGTHS)

    def reflected(a: NDArray[np.complex128], b: NDArray[np.complex128], c: NDArray[np.complex128]) -> NDArray:
        """|r|^2 of three media by their admittances."""
        r01, r12 = (a - b) / (a + b), (b - c) / (b + c)
        return np.abs((r01 + r12 * phase) / (1.0 + r01 * r12 * phase)) ** 2

    s = reflected(np.complex128(cosine), n1 * cos1, n2 * cos2)
    p = reflected(np.complex128(1.0 / cosine), n1 / cos1, n2 / cos2)
    return 0.5 * (s + p) @ weights()


def main() -> None:
    film, metal = constants()["magnetite Fe3O4"], constants()["iron"]
    print(f"{'nm':>4}  {'head-on':26}  at 82 degrees")
    for nm in range(0, 161, 10):
        print(f"{nm:4}  " + "  ".join(" ".join(f"{c:8.4f}" for c in film_reflectance(film, metal, nm, a)) for a in AT))


if __name__ == "__main__":
    main()
