# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets that come from tables of published figures (tools/data): one TOML file a material.

python tools/make_presets.py            says which presets differ from what the tables give; exit 1 if any does
python tools/make_presets.py --write    writes them
"""

from __future__ import annotations

import argparse
import re
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
from optical_constants import (
    ABSORBING,
    AT,
    Constants,
    abbe_of,
    absorption,
    constants,
    effective,
    reflectance,
    table,
    targets,
)  # fmt: skip

from vgroove.addon.library import writing as preset_files
from vgroove.addon.library.presets import FOLDER
from vgroove.addon.library.writing import toml
from vgroove.addon.reference import Conductor, Dielectric, schlick
from vgroove.addon.reference.fresnel import F82_COSINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from numpy.typing import NDArray

LOOK, LOOKS = "m is a look", "m and anisotropy are looks"
M_METAL, RANGE_METAL = 0.15, (0.0, 0.6)
M_PLASTIC, RANGE_PLASTIC = 0.15, (0.0, 0.5)
# m of a finish, and slopes that still look like it: all chosen by eye
FINISHES = {
    "polished": (0.02, (0.0, 0.05)),
    "satin": (0.15, (0.1, 0.2)),
    "brushed": (0.25, (0.2, 0.35)),
    "sandblasted": (0.5, (0.35, 0.8)),
}
FINISHED = ["aluminium", "brass", "chromium", "copper", "gold", "iron", "nickel", "silver", "titanium"]
FINISHED += ["stainless steel", "purple gold AuAl2"]
# m, anisotropy and slopes that suit, by eye: of grooves along the UV map's u axis, and of those around the Z axis
GROOVED = {
    "hair-line": (0.18, 0.85, (0.1, 0.3)),
    "ground": (0.25, 0.6, (0.15, 0.4)),
    "rolled": (0.08, 0.7, (0.04, 0.15)),
}
TURNED = {"turned": (0.1, 0.9, (0.05, 0.2)), "spun": (0.15, 0.8, (0.1, 0.25))}
ALONG = 0.25  # turns: the rougher direction is across the grooves
TAGS = {
    "metals": ["metal"],
    "metals_by_source": ["metal"],
    "alloys": ["metal", "alloy"],
    "semiconductors": ["semiconductor"],
    "glasses": ["transparent", "glass"],
    "crystals": ["transparent", "crystal"],
    "gems": ["transparent", "gem"],
    "liquids": ["transparent", "liquid"],
    "plastics": ["transparent", "plastic"],
}
MORE_TAGS = {  # of materials whose name has the word
    "film": ["film"],
    "soot": ["carbon", "black"],
    "graphite": ["carbon"],
    "carbon": ["carbon"],
    "diamond": ["carbon"],
    "Fe2O3": ["mineral"],
    "Fe3O4": ["mineral"],
    "MoS2": ["mineral"],
    "nitride": ["ceramic"],
    "carbide": ["ceramic"],
    "steel": ["steel"],
    "gold": ["gold"],
    "water": ["water"],
    "ice": ["water"],
    "silk": ["fibre"],
    "rubber": ["rubber"],
    "oil": ["oil"],
}
NOTES = {
    "blood (whole)": "The index alone: blood looks red by what scatters and absorbs in it, which glass leaves out.",
    "silk (Bombyx mori)": "The index of the fibre's substance, not of cloth.",
    "cellulose": "The index of the fibre's substance, not of paper.",
    "liquid argon 90 K": "At 90 K, where it is liquid.",
    "polyimide (Kapton)": "Absorption is known from 480 nm on and held below: the strong one of violet is missing.",
    "oleic acid": "Measured on droplets; the bulk liquid is usually given 0.01 less.",
}
PRINCIPAL = "One of two principal indices of a crystal that splits light; unpolarised light sees about their mean."
NEAR_EDGE = {"rutile", "zincite ZnO", "tausonite SrTiO3"}  # of absorption
HEAD = preset_files.HEAD + "# Made by tools/make_presets.py\n"


def rgb(row: dict[str, str], key: str) -> NDArray[np.float64]:
    return np.array([float(row[f"{key}_{channel}"]) for channel in "rgb"])


# How colour and roughness are known, by how the sentence on trust begins.
EVIDENCE = {
    "nothing is measured": ("by eye", "by eye"),
    "authored": ("by eye", "by eye"),
    "n and k are measured": ("measured", "by eye"),
    "n and k measured; colours computed": ("computed", "by eye"),
    "n and k are calculated": ("computed", "by eye"),
    "f0 and f82_tint follow from n and k, which are measured": ("measured", "by eye"),
    "f0 and f82_tint follow from n and k, which are calculated": ("computed", "by eye"),
    "f0 as the lecture prints it": ("quoted", "by eye"),
    "eta is quoted, not traced to a measurement; colour": ("by eye", "by eye"),
    "eta is quoted": ("quoted", "by eye"),
    "eta is measured; colour": ("by eye", "by eye"),
    "eta, at 587.6 nm, is measured; absorption is left out": ("by eye", "by eye"),
    "eta": ("measured", "by eye"),
    "the two indices are measured": ("measured", "by eye"),
    "colours, r and m are fits to measurements": ("measured", "measured"),
    "scattering and absorption are measured": ("measured", "by eye"),
    "measured": ("measured", "measured"),
}


def evidence_of(trust: str) -> dict[str, object]:
    """The first entry of EVIDENCE that fits."""
    return next(dict(zip(("colour", "roughness"), known, strict=True)) for how, known in EVIDENCE.items()
                if trust.startswith(how))  # fmt: skip


def text_of(values: dict[str, object], **tables: dict[str, object] | list[dict[str, object]]) -> str:
    """A preset's file: numbers to six digits."""
    source = tables["source"]
    assert isinstance(source, dict)
    tables["source"] = source | evidence_of(str(source["trust"]))
    return HEAD + toml(rounded(values), **{name: rounded(content) for name, content in tables.items()})


def rounded(of: Any) -> Any:
    if isinstance(of, dict):
        return {key: rounded(value) for key, value in of.items()}
    if isinstance(of, (list, tuple, np.ndarray)):
        return [rounded(value) for value in of]
    return of if isinstance(of, (str, bool)) else float(f"{float(of):.6g}")


def identity_of(family: str, material: str) -> str:
    return f"{family}/" + re.sub(r"[^a-z0-9]+", "_", material.lower()).strip("_")


def title(material: str) -> str:
    """Words of small letters get a capital; n-butanol and the like stay."""
    return re.sub(r"(?<![\w-])([a-z])([a-z]+)(?!\w)", lambda word: word[1].upper() + word[2], material, flags=re.ASCII)


def described(family: str, material: str, model: str, extra: tuple[str, ...] = ()) -> dict[str, object]:
    """What opens each file: name, model, tags, notes."""
    tags = [*TAGS[family], *extra]
    tags += [tag for word, more in MORE_TAGS.items() if word in re.split(r"[^A-Za-z0-9]+", material) for tag in more]
    notes = notes_of(material)
    opening = {"name": title(material), "model": model, "tags": list(dict.fromkeys(tags))}
    return opening | ({"notes": notes} if notes else {})


def notes_of(material: str) -> str:
    """What is to be known of a material, a sentence after the other."""
    ordinary = material.removesuffix(" (extraordinary)")
    sentences = {
        PRINCIPAL: f"{ordinary} (extraordinary)" in constants(),
        "The absorption edge is near: blue is uncertain.": ordinary in NEAR_EDGE,
        "Effective values of a layer of particles, not of a polished solid.": material.startswith("soot "),
        NOTES.get(material, ""): material in NOTES,
    }
    return " ".join(sentence for sentence, true in sentences.items() if true)


def cited(material: Constants, trust: str) -> dict[str, object]:
    reference = material.reference.rstrip(".")
    beyond = f"; up to {material.extrapolated:.0%} of a channel lies beyond the page's wavelengths"
    return {
        "data": f"{material.author_year}: {reference}; by refractiveindex.info, {material.page}",
        "licence": "CC0-1.0",
        "trust": trust + beyond * (material.extrapolated >= 0.005),
    }


def metals() -> Iterator[tuple[str, str]]:
    """Id and text of all that light does not pass: n and k; the Schlick form with a tint; the usual finishes."""
    for material in constants().values():
        if material.family in ABSORBING:
            yield conductor(material, material.family, material.material, M_METAL, RANGE_METAL)
        if material.family in {"metals", "alloys"}:
            yield schlick_form(material)
    for name in FINISHED:
        for finish, (m, m_range) in FINISHES.items():
            yield conductor(constants()[name], "finished_metals", f"{name}, {finish}", m, m_range)
    for name in FINISHED[:-1]:
        for finish, (m, anisotropy, m_range) in (GROOVED | TURNED).items():
            grooves: dict[str, object] = {"radial": finish in TURNED, "anisotropy": anisotropy, "rotation": ALONG}
            yield conductor(constants()[name], "finished_metals", f"{name}, {finish}", m, m_range, grooves)


def conductor(
    material: Constants, family: str, name: str, m: float, m_range: tuple[float, float],
    grooves: dict[str, object] | None = None,
) -> tuple[str, str]:  # fmt: skip
    n, k = effective(material)
    trust = f"n and k are {material.method}; {missed(material)}; {LOOKS if grooves else LOOK}"
    tagged = "metals" if family == "finished_metals" else family
    finish = name.removeprefix(material.material).strip(", ")
    tags = (finish, "brushed") if grooves else (finish,) if finish else ()
    values = described(tagged, material.material, "anisotropic" if grooves else "cook_torrance", tags)
    values |= {"name": title(name), "m": m, "m_range": m_range} | (grooves or {})
    verified = {"f0": Conductor(n, k)(1.0)}
    tables = {"fresnel": {"n": n, "k": k}, "source": cited(material, trust), "verified": verified}
    return identity_of(family, name), text_of(values, **tables)


def missed(material: Constants) -> str:
    """How a channel's n and k stand to the spectrum: in reflectance head-on and at 82 degrees."""
    n, k = effective(material)
    aims = targets(material)
    bright = [c for c, *both in zip(("red", "green", "blue"), *aims, strict=True) if max(both) > 1.0]
    far = max(np.abs(Conductor(n, k)(cos) - aim)[aim <= 1.0].max() for cos, aim in zip(AT, aims, strict=True))
    text = "a channel's reflect as the spectrum does head-on and at 82 degrees"
    if bright:
        return f"{text}, but for {' and '.join(bright)}, clipped: the colour lies outside Rec.709"
    return text if far <= 1e-4 else f"{text}, within {far:.1g}: no n and k have both"


def schlick_form(material: Constants) -> tuple[str, str]:
    """F0 and F82, clipped to what the form takes."""
    f0 = reflectance(material, 1.0)
    tint = reflectance(material, F82_COSINE) / schlick(F82_COSINE, np.minimum(f0, 1.0))
    clipped = "; clipped to 1 where the formula or Rec.709 would pass it" * bool(max(*f0, *tint) > 1.0)
    f0, tint = np.minimum(f0, 1.0), np.minimum(tint, 1.0)
    trust = f"f0 and f82_tint follow from n and k, which are {material.method}{clipped}; {LOOK}"
    values = described(material.family, material.material, "cook_torrance", ("schlick",))
    values |= {"name": f"{title(material.material)}, Schlick", "m": M_METAL, "m_range": RANGE_METAL}
    tables = {"fresnel": {"f0": f0, "f82_tint": tint}, "source": cited(material, trust), "verified": {"f0": f0}}
    return identity_of("metals_schlick", f"{material.material} schlick"), text_of(values, **tables)


def transparent() -> Iterator[tuple[str, str]]:
    """Id and text of glasses, crystals, gems, liquids and plastics that have a spectral page."""
    for material in constants().values():
        if material.family in ABSORBING:
            continue
        colours = absorption(material)
        passes = "no absorption: what passes is not tinted" if colours is None else "absorption is measured"
        if material.absorbs and colours is None:
            passes = "absorption is left out: that of a film, or too weak to be seen"
        trust = f"eta, at 587.6 nm, is {material.method}; {passes}; m = 0 is an ideal polish"
        values = described(material.family, material.material, "glass") | {"m": 0.0, "m_range": (0.0, 0.5)}
        eta = float(f"{material.n_d:.6g}")  # as the file holds it
        values |= {"eta": eta} | ({} if colours is None else {"absorption": colours})
        values |= {"abbe": material.abbe} if material.abbe else {}
        yield (
            identity_of(material.family, material.material),
            text_of(values, source=cited(material, trust), verified=head_on(eta)),
        )


def single_indices() -> Iterator[tuple[str, str]]:
    """Id and text of those that have an index and no more; opaque ones are white under it, clear ones tinted by eye."""
    tints = {row["material"]: row["colour"] for row in table("tints")}
    for row in table("scalar_indices"):
        n, low, high = (float(row[key]) for key in ("n", "n_low", "n_high"))
        spread = f", the middle of {low:g} to {high:g}" * (low < high)
        source = {"data": f"index near 589 nm{spread}: {row['source']}"}
        if row["body"] == "clear":
            colour = tints.get(row["material"])
            passes = "colour is by eye" if colour else "no absorption: what passes is not tinted"
            trust = f"eta is quoted, not traced to a measurement; {passes}; m = 0 is an ideal polish"
            values = described(row["family"], row["material"], "glass") | {"m": 0.0, "m_range": (0.0, 0.5), "eta": n}
            values |= {"tint": tint_of(colour)} if colour else {}
            if row["dispersion"]:
                values["abbe"] = float(f"{abbe_of(n, float(row['dispersion'])):.2g}")
                trust += (
                    "; abbe follows by Cauchy's formula from the dispersion between 686.7 and 430.8 nm that is quoted"
                )
            tables = {"source": source | {"trust": trust}, "verified": head_on(n)}
        else:
            trust = f"eta is quoted, not traced to a measurement; colour is chosen; {LOOK}"
            values = described(row["family"], row["material"], "sum") | {"coupled": True, "d": 1.0, "s": 1.0}
            values |= {
                "tags": ["plastic"],
                "albedo": [0.85] * 3,
                "sigma": 0.0,
                "m": M_PLASTIC,
                "m_range": RANGE_PLASTIC,
            }
            tables = {"fresnel": {"eta": n}, "source": source | {"trust": trust}, "verified": head_on(n)}
        yield identity_of(row["family"], row["material"]), text_of(values, **tables)


def linear(hexadecimal: str) -> NDArray[np.float64]:
    """Linear Rec.709 of an sRGB colour. Source: IEC 61966-2-1."""
    coded = np.array([int(hexadecimal[at : at + 2], 16) for at in (0, 2, 4)]) / 255.0
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def tint_of(colour: str) -> NDArray[np.float64]:
    """The tint of one surface of a body that shows ``colour`` (sRGB): light passes two, in any size."""
    return np.round(np.sqrt(linear(colour)), 4)


def car_paints() -> Iterator[tuple[str, str]]:
    """Id and text of each. A lobe ks F(r) is s F82 with s the largest of ks: alike head-on and at 82 degrees."""
    source = {
        "data": "Günther, Chen, Goesele, Wald & Seidel 2005, Efficient Acquisition and Realistic Rendering of Car "
        "Paint, VMV (probable origin); figures as in LuxCoreRender, carpaint.cpp",
        "licence": "Apache-2.0",
        "trust": "colours, r and m are fits to measurements; that they are of this paper, and of lobes scaled "
        "F D G / (4 n.l n.v), is not verified; beyond 82 degrees from a facet's normal a lobe turns white",
    }
    for row in table("car_paint"):
        lobes: list[dict[str, object]] = []
        for k in (1, 2, 3):
            ks, r = rgb(row, f"ks{k}"), float(row[f"r{k}"])
            s = float(ks.max())
            if s == 0.0:
                continue
            f0 = r * ks / s
            tint = ks / s * schlick(F82_COSINE, r) / schlick(F82_COSINE, f0)
            lobes.append({"s": s, "m": float(row[f"m{k}"]), "f0": f0, "f82_tint": np.minimum(tint, 1.0)})
        values = {"name": row["name"], "model": "car_paint", "tags": ["car paint", "paint"]}
        yield (
            f"car_paints/{row['id']}",
            text_of(values | {"albedo": rgb(row, "kd"), "sigma": 0.0}, lobes=lobes, source=source),
        )


def translucent() -> Iterator[tuple[str, str]]:
    """Id and text of each, after Jensen et al. 2001."""
    source = {
        "data": "Jensen, Marschner, Levoy & Hanrahan 2001, A Practical Model for Subsurface Light Transport, SIGGRAPH, "
        "measured parameters; figures as in pbrt-v4, media.cpp",
        "licence": "Apache-2.0",
        "trust": "scattering and absorption are measured; reflectance and mean_free_path follow from them "
        "(tools/make_presets.py); m is a look",
    }
    for row in table("jensen2001"):
        scattering, absorption = rgb(row, "scattering"), rgb(row, "absorption")
        eta, m = float(row["eta"]), float(row["m"])
        values = {"name": row["name"], "model": "translucent", "tags": ["translucent", "subsurface"]}
        values |= {
            "reflectance": dipole_reflectance(scattering, absorption, eta),
            "mean_free_path": 1e-3 / (scattering + absorption),
            "m": m,
            "m_range": [m / 2, m * 2],
        }
        yield f"translucent/{row['id']}", text_of(values, fresnel={"eta": eta}, source=source, verified=head_on(eta))


def dipole_reflectance(
    scattering: NDArray[np.float64], absorption: NDArray[np.float64], eta: float
) -> NDArray[np.float64]:
    """Diffuse reflectance of a half-space from reduced scattering and absorption in equal units.

    R = a/2 (1 + exp(-4/3 A s)) exp(-s), s = sqrt(3 (1 - a)), a the reduced albedo, A = (1 + Fdr) / (1 - Fdr).
    Source: Jensen et al. 2001, section 2.3 and eq. 15 (integrated over the surface).
    """
    a = scattering / (scattering + absorption)
    Fdr = -1.440 / eta**2 + 0.710 / eta + 0.668 + 0.0636 * eta
    s = np.sqrt(3.0 * (1.0 - a))
    return a / 2.0 * (1.0 + np.exp(-4.0 / 3.0 * (1.0 + Fdr) / (1.0 - Fdr) * s)) * np.exp(-s)


def head_on(eta: float) -> dict[str, object]:
    return {"f0": np.asarray(Dielectric(eta)(1.0))}


def every_preset() -> Iterator[tuple[str, str]]:
    for family in (metals, transparent, single_indices, car_paints, translucent):
        yield from family()


def main(presets: Callable[[], Iterable[tuple[str, str]]] = every_preset, tool: str = "make_presets.py") -> int:
    """Compare or write what ``presets`` gives; 1 where something differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the presets")
    write = parser.parse_args().write
    differ = []
    for identity, text in presets():
        path = FOLDER / f"{identity}.toml"
        if write:
            path.parent.mkdir(exist_ok=True)  # a new family
            path.write_text(text, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != text:
            differ.append(identity)
    for identity in differ:
        print(f"presets/{identity}.toml differs from the tables; run tools/{tool} --write")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
