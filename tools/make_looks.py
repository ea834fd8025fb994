# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets that are chosen by eye (tools/data/looks.csv): one TOML file a material.

python tools/make_looks.py            says which presets differ from what the table gives; exit 1 if any does
python tools/make_looks.py --write    writes them
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np
from make_presets import head_on, identity_of, linear, main, text_of, tint_of
from optical_constants import table

if TYPE_CHECKING:
    from collections.abc import Iterator


HEAD = "# Made by tools/make_looks.py"
COAT, FLAKES = 0.5, 0.35  # shares of a car paint's lobes; its base has the rest
ROUGHER = 2.0  # a slope still suits a look that is half as large, or twice
SOURCE = {"data": "chosen by eye", "trust": "nothing is measured: colour and roughness are looks"}


def looks() -> Iterator[tuple[str, str]]:
    """Id and text of each."""
    for row in table("looks"):
        yield identity_of(row["family"], row["name"]), _text(row)


def _text(row: dict[str, str]) -> str:
    colour, form = np.round(linear(row["colour"]), 4), row["form"]
    values: dict[str, object] = {"name": row["name"], "tags": list(dict.fromkeys(row["tags"].split()))}
    tables: dict[str, dict[str, object]] = {"source": dict(SOURCE)}
    if row["eta"]:
        eta = float(row["eta"])
        tables = {"fresnel": {"eta": eta}, "source": dict(SOURCE), "verified": head_on(eta)}
        tables["source"]["trust"] = "nothing is measured: colour and roughness are looks, eta is a usual index"
    if form == "rough":
        values |= {"model": "oren_nayar", "albedo": colour, "sigma": float(row["sigma"])}
    elif form == "coated":
        values |= {"model": "sum", "coupled": True, "d": 1.0, "s": 1.0, "albedo": colour, "sigma": float(row["sigma"])}
    elif form == "body":
        values |= {"model": "translucent", "reflectance": colour, "mean_free_path": [float(row["mean_free_path"])] * 3}
    elif form == "flakes":
        return _car_paint(row)
    elif form == "clear":
        values |= {"model": "glass", "eta": eta, "m": float(row["m"]), "m_range": [0.0, 0.5]}
        values |= {} if row["colour"] == "ffffff" else {"tint": tint_of(row["colour"])}
        tables = {"source": tables["source"], "verified": head_on(eta)}
        return _made(values, tables)
    else:
        values["model"] = "cook_torrance"
        tables = {"fresnel": {"f0": colour}, "source": dict(SOURCE), "verified": {"f0": colour}}
    if row["m"]:
        m = float(row["m"])
        values |= {"m": m, "m_range": [m / ROUGHER, min(m * ROUGHER, 1.0)]}
    return _made(values, tables)


def _car_paint(row: dict[str, str]) -> str:
    """A dark base, flakes, and half a clear coat, as bright head-on as a whole one: all shares add up to 1."""
    colour = linear(row["colour"])
    flakes = np.round(colour / colour.max() * colour.max() ** 0.5, 4)  # a deep colour's flakes are brighter than it
    eta = float(row["eta"])
    coat = {"s": COAT, "m": 0.02, "f0": [((eta - 1.0) / (eta + 1.0)) ** 2 / COAT] * 3, "f82_tint": [1.0] * 3}
    lobe = {"s": FLAKES, "m": float(row["m"]), "f0": flakes, "f82_tint": [1.0] * 3}
    values = {"name": row["name"], "model": "car_paint", "tags": list(dict.fromkeys(row["tags"].split()))}
    values |= {"albedo": np.round((1.0 - COAT - FLAKES) * colour, 4), "sigma": 0.0}
    text = text_of(values, lobes=[coat, lobe], source=dict(SOURCE))
    return text.replace("# Made by tools/make_presets.py", HEAD)


def _made(values: dict[str, object], tables: dict[str, dict[str, object]]) -> str:
    return text_of(values, **tables).replace("# Made by tools/make_presets.py", HEAD)


if __name__ == "__main__":
    sys.exit(main(looks, "make_looks.py"))
