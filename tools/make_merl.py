# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets that are fits to measured materials (tools/data/merl_*.csv): one TOML file a material.

python tools/make_merl.py            says which presets differ from what the tables give; exit 1 if any does
python tools/make_merl.py --write    writes them

Left out are materials whose published amplitude would mirror more light than arrives, and those whose index is beyond
what a dielectric's Fresnel term takes here: the fits of four metals ended at the limit of 100.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np
from make_presets import identity_of, main, rgb, text_of, title
from optical_constants import table

from vgroove.addon.models.fresnel import ETA
from vgroove.addon.reference.facet_distribution import Term

if TYPE_CHECKING:
    from collections.abc import Iterator

SCALE = np.array([1.0, 1.15, 1.66])  # of MERL's channels, which the numbers of Ngan et al. leave out
HEAD = "# Made by tools/make_merl.py"
DATA = "Low et al. 2012, ABC model fitted to the MERL measurements of Matusik et al. 2003, doi:10.1145/2077341.2077350"
TRUST = "measured by photographs of a ball, then fitted; amplitudes are the fit's, of its distribution of unit area"
WARD = "Ngan et al. 2005, Ward's model fitted to the MERL measurements of Matusik et al. 2003, "
WARD += "doi:10.2312/EGWR/EGSR05/117-126"
ASHIKHMIN = WARD.replace("Ward's model", "Ashikhmin and Shirley's highlight over Lambert")
NGAN_TRUST = (
    "measured by photographs of a ball, then fitted; the scale of MERL's channels is applied to the fit's colours"
)
TAGS = {
    "paint": "paint", "fabric": "cloth", "felt": "cloth", "plastic": "plastic", "phenolic": "plastic",
    "acrylic": "plastic",
    "rubber": "rubber", "steel": "metal", "metallic": "metallic", "gold": "gold", "silver": "silver", "bronze": "metal",
    "brass": "metal", "aluminium": "metal", "nickel": "metal", "pine": "wood", "oak": "wood", "maple": "wood",
    "walnut": "wood", "cherry": "wood", "fruitwood": "wood", "marble": "stone", "jasper": "stone", "obsidian": "stone",
}  # fmt: skip


def merl() -> Iterator[tuple[str, str]]:
    """Id and text of each."""
    for row in table("merl_abc"):
        shape, eta = (float(row["B"]), float(row["C"])), float(row["ior"])
        specular = 4.0 / np.pi * rgb(row, "A") / Term("abc", shape).scale
        if specular.max() <= 1.0 and eta <= ETA.high:
            yield identity_of("merl_fits", f"{row['material']} merl"), _text(row, shape, eta, specular)
    for row in table("merl_ward"):
        yield identity_of("merl_fits", f"{row['material']} merl ward"), _ward(row)
    for row in table("merl_ashikhmin"):
        if (rgb(row, "kd") * SCALE + rgb(row, "ks") * SCALE).max() <= 1.0:
            yield identity_of("merl_fits", f"{row['material']} merl as"), _ashikhmin(row)


def _text(row: dict[str, str], shape: tuple[float, float], eta: float, specular: np.ndarray) -> str:
    values = _opening(row["material"], "(MERL fit)", "generator")
    values |= {"albedo": rgb(row, "kd"), "specular": specular, "tags": _tags(row["material"])}
    tables: dict[str, dict[str, object]] = {"fresnel": {"eta": eta}, "source": {"data": DATA, "trust": TRUST}}
    text = text_of(values, **tables, distribution=[{"abc": shape}])
    return text.replace("# Made by tools/make_presets.py", HEAD)


def _ward(row: dict[str, str]) -> str:
    values = _opening(row["material"], "(MERL fit, Ward)", "ward") | {"kind": "ward_1992"}
    values |= {"albedo": rgb(row, "kd") * SCALE, "specular": rgb(row, "ks") * SCALE, "tags": _tags(row["material"])}
    values |= {"m": float(row["alpha"]), "anisotropy": 0.0}
    text = text_of(values, source={"data": WARD, "trust": NGAN_TRUST})
    return text.replace("# Made by tools/make_presets.py", HEAD)


def _ashikhmin(row: dict[str, str]) -> str:
    values = _opening(row["material"], "(MERL fit, Ashikhmin-Shirley)", "ashikhmin_shirley") | {"kind": "lambert"}
    values |= {"albedo": rgb(row, "kd") * SCALE, "specular": np.full(3, float(row["f0"]))}
    values |= {"amplitude": rgb(row, "ks") * SCALE, "tags": _tags(row["material"])}
    values |= {"sharpness": float(row["n"]), "anisotropy": 0.0}
    text = text_of(values, source={"data": ASHIKHMIN, "trust": NGAN_TRUST})
    return text.replace("# Made by tools/make_presets.py", HEAD)


def _opening(name: str, ending: str, model: str) -> dict[str, object]:
    return {"name": f"{title(name.replace('-', ' '))} {ending}", "model": model}


def _tags(name: str) -> list[str]:
    return ["measured", *dict.fromkeys(tag for word, tag in TAGS.items() if word in name)]


if __name__ == "__main__":
    sys.exit(main(merl, "make_merl.py"))
