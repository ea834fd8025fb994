# SPDX-License-Identifier: GPL-3.0-or-later
"""What a renderer with three channels needs of spectral n and k (tools/data/optical_constants.csv).

python tools/optical_constants.py            prints, for each material, reflectance head-on and at 82 degrees as linear
                                             Rec.709, and the n and k of each channel that have both

A channel of reflectance is the sum over wavelengths of weight x reflectance: CIE 1931 2 degree matching functions times
D65, every 5 nm, turned to linear Rec.709, each channel scaled so that a perfect mirror is 1. No single n and k of a
channel reflect so at every angle; those that do head-on and at 82 degrees stay near it between. n and k read off at one
wavelength a channel do not.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import colour
import numpy as np
from scipy.optimize import brentq, least_squares

from vgroove.addon.reference import fresnel_conductor

if TYPE_CHECKING:
    from numpy.typing import NDArray

DATA = Path(__file__).parent / "data"
WAVELENGTHS = np.arange(380, 781, 5)  # nm
LINE_C, LINE_F = 656.3, 486.1  # nm: Fraunhofer's, of Abbe's number
LINE_B, LINE_G = 686.7, 430.8  # of gems' dispersion
EDGE = float(np.cos(np.radians(82.0)))
AT = (1.0, EDGE)  # the cosines where reflectance is matched
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of Rec.709: ITU-R BT.709-6, item 3.2
ABSORBING = {"metals", "metals_by_source", "alloys", "semiconductors"}  # families that no light passes
SHORTEST, LONGEST = 1e-4, 100.0  # m that halve the light: below, k is a film's, near what ellipsometry can tell from 0;
# above, there is no colour that a render could show
DARKEST = 1e-4  # transmittance: a colour outside Rec.709 has channels below 0


@dataclass(frozen=True, eq=False)
class Constants:
    """n and k of a material at ``WAVELENGTHS``, k of zeros where its page gives none, and what is known of it."""

    material: str
    n: NDArray[np.float64]
    k: NDArray[np.float64]
    absorbs: bool
    family: str
    page: str
    author_year: str
    reference: str
    n_d: float
    abbe: float | None
    extrapolated: float
    method: str


def table(name: str) -> list[dict[str, str]]:
    """Rows of tools/data/NAME.csv; lines that start with # are comments."""
    text = (DATA / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


@cache
def constants() -> dict[str, Constants]:
    """All materials by name."""
    spectra: dict[tuple[str, str], NDArray[np.float64]] = {}
    for row in table("optical_constants"):
        spectra[row["material"], row["quantity"]] = np.array([float(row[str(nm)]) for nm in WAVELENGTHS])
    found = {}
    for row in table("optical_sources"):
        name, n = row["material"], spectra[row["material"], "n"]
        k = spectra.get((name, "k"))
        n_d = float(row["n_d"] or n[WAVELENGTHS == 590][0])
        found[name] = Constants(
            name,
            n,
            np.zeros_like(n) if k is None else k,
            k is not None,
            row["family"],
            row["page"],
            row["author_year"],
            row["reference"],
            n_d,
            float(row["abbe"]) if row["abbe"] else None,
            float(row["extrapolated"]),
            row["method"],
        )
    return found


@cache
def weights() -> NDArray[np.float64]:
    """Of each wavelength in linear Rec.709, (81, 3); each column sums to 1."""
    shape = colour.SpectralShape(WAVELENGTHS[0], WAVELENGTHS[-1], 5)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    light = colour.SDS_ILLUMINANTS["D65"].copy().align(shape).values
    rgb = (observer * light[:, None]) @ colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_XYZ_to_RGB.T
    return rgb / rgb.sum(axis=0)


def abbe_of(n_d: float, from_b_to_g: float) -> float:
    """The Abbe number by Cauchy's formula n = A + B / wavelength^2 from n at 430.8 nm (G) less n at 686.7 nm (B)."""
    per_c, per_f, per_b, per_g = (1.0 / nm**2 for nm in (LINE_C, LINE_F, LINE_B, LINE_G))
    return (n_d - 1.0) / (from_b_to_g * (per_f - per_c) / (per_g - per_b))


def reflectance(material: Constants, cosine: float) -> NDArray[np.float64]:
    """RGB at one angle, in air; above 1 in a channel where the colour lies outside Rec.709."""
    return fresnel_conductor(cosine, material.n, material.k) @ weights()


def effective_index(head_on: float, edge: float, greatest_k: float = 20.0) -> tuple[float, float]:
    """The n and k whose F is ``head_on`` at normal incidence and ``edge`` at 82 degrees.

    All n and k of one reflectance R head-on lie on a circle, centre (1 + R) / (1 - R) on the n axis, radius
    2 sqrt(R) / (1 - R) [from R = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)]; along it from least to greatest n the
    reflectance at 82 degrees falls. Where no point of the circle has it, or R is 1 or more, the nearest n, k to both
    by least squares, k up to ``greatest_k``.
    """

    def on_circle(turn: float) -> tuple[float, float]:
        centre, radius = (1.0 + head_on) / (1.0 - head_on), 2.0 * np.sqrt(head_on) / (1.0 - head_on)
        return centre - radius * np.cos(turn), radius * np.sin(turn)

    def miss(turn: float) -> float:
        return float(fresnel_conductor(EDGE, *on_circle(turn))) - edge

    if head_on < 1.0 and miss(0.0) * miss(np.pi) < 0.0:
        n, k = on_circle(brentq(miss, 0.0, np.pi, xtol=1e-14))
        return float(n), float(k)
    aim = np.minimum([head_on, edge], 1.0)
    start = on_circle(np.pi - 1e-3) if head_on < 0.9 else (0.1, 0.5 * greatest_k)
    found = least_squares(
        lambda index: fresnel_conductor(np.array(AT), *index) - aim,
        start,
        bounds=([1e-3, 0.0], [20.0, greatest_k]),
        xtol=1e-14,
        ftol=1e-14,
    )
    return float(found.x[0]), float(found.x[1])


@cache
def effective(material: Constants) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """n and k of each channel, to the six digits that a preset holds."""
    greatest_k = float(material.k.max()) + 1e-3
    pairs = [effective_index(*both, greatest_k) for both in zip(*targets(material), strict=True)]
    n, k = np.array([[float(f"{value:.6g}") if value > 1e-6 else 0.0 for value in pair] for pair in pairs]).T
    return n, k


def targets(material: Constants) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Reflectance head-on and at 82 degrees, RGB, unclipped."""
    head_on, edge = (reflectance(material, cosine) for cosine in AT)
    return head_on, edge


def absorption(material: Constants) -> NDArray[np.float64] | None:
    """RGB in 1/m: exp(-a d) is each channel's transmittance at the depth d that halves the luminance.

    Spectrally a = 4 pi k / wavelength (Born & Wolf 14.1); a channel's a falls with depth, as what is absorbed most is
    gone first. None where the page gives no k, or where halving takes less than 0.1 mm or more than 100 m.
    """
    spectral = 4.0 * np.pi * material.k / (WAVELENGTHS * 1e-9)

    def transmittance(depth: float) -> NDArray[np.float64]:
        return np.exp(-spectral * depth) @ weights()

    def miss(log_depth: float) -> float:
        return float(transmittance(np.exp(log_depth)) @ LUMINANCE) - 0.5

    if not material.absorbs or not miss(np.log(SHORTEST)) > 0.0 > miss(np.log(LONGEST)):
        return None
    depth = np.exp(brentq(miss, np.log(SHORTEST), np.log(LONGEST)))
    return np.maximum(-np.log(np.maximum(transmittance(depth), DARKEST)) / depth, 0.0)


def main() -> None:
    def three(values: NDArray[np.float64]) -> str:
        return " ".join(f"{value:8.4f}" for value in values)

    print(f"{'material':40} {'head-on':26}  {'at 82 degrees':26}  {'n':26}  {'k':26}  missed by")
    for name, material in constants().items():
        if material.family not in ABSORBING:
            continue
        n, k = effective(material)
        both = targets(material)
        missed = max(
            np.abs(fresnel_conductor(cosine, n, k) - np.minimum(aim, 1.0)).max()
            for cosine, aim in zip(AT, both, strict=True)
        )
        print(f"{name:40} {three(both[0])}  {three(both[1])}  {three(n)}  {three(k)}  {missed:.0e}")
    print(f"\n{'absorption, 1/m':40}")
    for name, material in constants().items():
        a = None if material.family in ABSORBING else absorption(material)
        if a is not None:
            print(f"{name:40} " + " ".join(f"{value:10.4g}" for value in a))


if __name__ == "__main__":
    main()
