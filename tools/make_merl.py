# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets that are fits to measured materials (tools/data/merl_abc.csv): one TOML file a material.

python tools/make_merl.py            says which presets differ from what the table gives; exit 1 if any does
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

HEAD = "# Made by tools/make_merl.py"
DATA = "Low et al. 2012, ABC model fitted to the MERL measurements of Matusik et al. 2003, doi:10.1145/2077341.2077350"
TRUST = "measured by photographs of a ball, then fitted; amplitudes are the fit's, of its distribution of unit area"
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


def _text(row: dict[str, str], shape: tuple[float, float], eta: float, specular: np.ndarray) -> str:
    name = row["material"]
    tags = ["measured", *dict.fromkeys(tag for word, tag in TAGS.items() if word in name)]
    values: dict[str, object] = {"name": f"{title(name.replace('-', ' '))} (MERL fit)", "model": "generator"}
    values |= {"albedo": rgb(row, "kd"), "specular": specular, "tags": tags}
    tables: dict[str, dict[str, object]] = {"fresnel": {"eta": eta}, "source": {"data": DATA, "trust": TRUST}}
    text = text_of(values, **tables, distribution=[{"abc": shape}])
    return text.replace("# Made by tools/make_presets.py", HEAD)


if __name__ == "__main__":
    sys.exit(main(merl, "make_merl.py"))
