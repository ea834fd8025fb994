# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets of family time_varying that are computed or measured; the others there are written by hand.

python tools/make_time_presets.py            says which differ from what the tables give; exit 1 if any does
python tools/make_time_presets.py --write    writes them
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import make_presets
import numpy as np
from optical_constants import constants, table
from thin_film import film_reflectance

from vgroove.addon.reference import Dielectric, Trajectory, place_keys, schlick
from vgroove.addon.reference.fresnel import F82_COSINE
from vgroove.addon.reference.quadrature import gauss_legendre

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

FAMILY = "time_varying"
WATER = 1.333
D_RUST = 0.79  # the diffuse share; with the largest Ks of the table, .202, below 1
FILM_NM, FILM_MINUTES = 90.0, 60.0
# Name, notes, albedo dry, sigma dry, hours, (middle and rate of the albedo's S), tags
DRYING: dict[str, tuple[str, str, tuple[float, float, float], float, float, tuple[float, float], list[str]]] = {
    "drying_concrete": (
        "Drying Concrete", "Stains dry from their rim: drive Offset by the distance from it.",
        (0.38, 0.37, 0.345), 0.45, 12.0, (6.0, 1.0), ["concrete", "stone"],
    ),
    "drying_wood": (
        "Drying Wood", "Drive Rate by the grain: early wood dries before late wood.",
        (0.48, 0.33, 0.19), 0.3, 8.0, (3.5, 1.6), ["wood"],
    ),
    "drying_fabric": (
        "Drying Fabric", "The water's gloss is gone within minutes, the dark of it only after hours.",
        (0.22, 0.33, 0.52), 0.4, 4.0, (2.0, 3.5), ["cloth"],
    ),
    "drying_watercolour": (
        "Drying Watercolour", "A wash loses its gloss, then pales. Drive Offset by how much water lies where.",
        (0.62, 0.3, 0.16), 0.2, 0.6, (0.25, 30.0), ["paint"],
    ),
}  # fmt: skip


def every_preset() -> Iterator[tuple[str, str]]:
    """Id and text of each."""
    yield rusting_iron()
    yield heat_tinted_steel()
    for name in DRYING:
        yield drying(name)


def text_of(values: dict[str, object], **tables: dict[str, object]) -> str:
    return make_presets.text_of(values, **tables).replace("make_presets.py", "make_time_presets.py", 1)


def rusting_iron() -> tuple[str, str]:
    """The mean of a measured surface, its 21 samples as keys. F is 1 in the fit: Ks holds the reflectance."""
    rows = [{key: float(value) for key, value in row.items()} for row in table("rusting_iron")]
    Kd = np.array([[row[f"Kd_{channel}"] for channel in "rgb"] for row in rows]) / D_RUST
    Ks, m = (np.array([row[key] for row in rows]) for key in ("Ks", "roughness"))
    times = [row["t"] for row in rows[1:]]
    values = {
        "name": "Rusting Iron", "model": "sum", "tags": ["metal", "iron", "rust", "measured", "time"],
        "notes": "Shine is lost first, red peaks at a quarter, then it darkens. "
        "For rust that spreads, drive Offset by a texture.",
        "d": D_RUST, "s": Ks[0], "albedo": Kd[0], "sigma": 0.0, "m": m[0],
    }  # fmt: skip
    source = {
        "data": "Gu, Tu, Ramamoorthi, Belhumeur, Matusik & Nayar 2006, Time-varying surface appearance, SIGGRAPH: "
        "sample tvBTF45, cast iron; cubics over time per pixel by Meister, Pospisil, Sato & Bittner 2021, Computers "
        "and Graphics 97; their mean over 460 x 460 pixels",
        "trust": "measured; colours are the camera's, taken for Rec.709; the fit's roughness is taken for Beckmann's "
        "m, which it is near for narrow lobes; Lambertian, F = 1; time is a share of the whole",
    }
    time = {"unit": "share", "range": [0.0, 1.0], "kind": "measured"}
    laws = {
        f"time.{name}": {"law": "keys", "times": times, "values": of[1:]}
        for name, of in (("albedo", Kd), ("s", Ks), ("m", m))
    }
    return f"{FAMILY}/rusting_iron", text_of(values, fresnel={"f0": [1.0] * 3}, source=source, time=time, **laws)


@dataclass(frozen=True)
class Tint:
    """F0 and F82 tint (n, 6) of magnetite that has grown on iron for t minutes, thickness by the parabolic law."""

    def __call__(self, t: ArrayLike) -> NDArray[np.float64]:
        film, metal = constants()["magnetite Fe3O4"], constants()["iron"]
        nm = FILM_NM * np.sqrt(np.asarray(t, float) / FILM_MINUTES)
        f0, edge = (np.clip(film_reflectance(film, metal, nm, cosine), 0.0, 1.0) for cosine in (1.0, F82_COSINE))
        return np.concatenate([f0, np.minimum(edge / schlick(F82_COSINE, f0), 1.0)], axis=-1)

    def events(self) -> NDArray[np.float64]:
        return FILM_MINUTES * np.exp2(np.arange(-16.0, 1.0))


def heat_tinted_steel() -> tuple[str, str]:
    """Keys of the computed colours within .1 % of their range."""
    keys = place_keys(Trajectory({"tint": Tint()}, 0.0, FILM_MINUTES), "tint")
    f0, tint = keys.values[:, :3], keys.values[:, 3:]
    film, metal = constants()["magnetite Fe3O4"], constants()["iron"]
    values = {
        "name": "Heat-Tinted Steel", "model": "cook_torrance", "tags": ["metal", "steel", "film", "time"],
        "notes": f"An oxide film that grows to {FILM_NM:g} nm: straw, brown, purple, blue. "
        "For bands, drive Offset by the distance from the heat.",
        "m": 0.12,
    }  # fmt: skip
    source = {
        "data": f"interference in a film of magnetite on iron, computed (tools/thin_film.py) from n and k of "
        f"{film.author_year} ({film.page}) and {metal.author_year} ({metal.page}), by refractiveindex.info",
        "licence": "CC0-1.0",
        "trust": "n and k measured; colours computed head-on and at 82 degrees, clipped to Rec.709; that the film is "
        "magnetite alone, its thickness and the time are chosen; growth by the parabolic law; m is a look",
    }
    time = {"unit": "min", "range": [0.0, FILM_MINUTES], "kind": "fitted"}
    laws = {
        f"time.{name}": {"law": "keys", "times": keys.times[1:], "values": of[1:]}
        for name, of in (("f0", f0), ("f82_tint", tint))
    }
    fresnel = {"f0": f0[0], "f82_tint": tint[0]}
    return f"{FAMILY}/heat_tinted_steel", text_of(values, fresnel=fresnel, source=source, time=time, **laws)


def wet(albedo: tuple[float, float, float]) -> NDArray[np.float64]:
    """Albedo of the coupled diffuse part under a film of water: (1 - Fi) a / (1 - Fi a), Fi inside, of diffuse light.

    Light that the ground scatters is partly turned back by the film, again and again; what comes out at last is the
    geometric series' sum. Fi = 1 - (1 - Fe) / eta^2, Fe of diffuse light from without (energy and reciprocity).
    The idea is Ångström's, 1925; what the film mirrors outside is the coupled specular part.
    """
    x, weight = gauss_legendre(64)
    cosine = np.asarray(x)
    Fe = 2.0 * np.sum(weight * cosine * Dielectric(WATER)(cosine)[..., 0])
    Fi = 1.0 - (1.0 - Fe) / WATER**2
    return (1.0 - Fi) * np.array(albedo) / (1.0 - Fi * np.array(albedo))


def drying(material: str) -> tuple[str, str]:
    """A rough ground under a film of water that thins out early, while the ground stays dark until its pores dry."""
    name, notes, dry, sigma, hours, (middle, rate), tags = DRYING[material]
    values = {
        "name": name, "model": "sum", "tags": [*tags, "water", "drying", "time"], "notes": notes, "coupled": True,
        "d": 1.0, "s": 1.0, "albedo": wet(dry), "sigma": 0.5 * sigma, "m": 0.06,
    }  # fmt: skip
    source = {
        "data": "albedo wet from dry by reflection inside a film of water of index 1.333, after Ångström 1925, The "
        "albedo of various surfaces of ground (tools/make_time_presets.py); the S-shaped rise and the early loss of "
        "gloss are the forms remembered of Sun et al. 2007, not verified",
        "trust": "authored: dry colour, roughness and times are by eye; the ratio of wet to dry is computed",
    }
    time = {"unit": "h", "range": [0.0, hours], "kind": "authored"}
    laws = {
        "s": {"law": "exponential", "end": 0.0, "rates": [240.0 / hours, 6.0 / hours], "shares": [0.6, 0.4]},
        "m": {"law": "reciprocal", "end": 0.5, "rate": 6.0 / hours},
        "albedo": {"law": "logistic", "end": list(dry), "rate": rate, "middle": middle},
        "sigma": {"law": "logistic", "end": sigma, "rate": rate, "middle": middle},
    }
    tables = {f"time.{key}": law for key, law in laws.items()}
    return f"{FAMILY}/{material}", text_of(values, fresnel={"eta": WATER}, source=source, time=time, **tables)


if __name__ == "__main__":
    sys.exit(make_presets.main(every_preset, "make_time_presets.py"))
