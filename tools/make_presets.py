# SPDX-License-Identifier: GPL-3.0-or-later
"""The presets that come from tables of published figures (tools/data): one TOML file a material.

python tools/make_presets.py            says which presets differ from what the tables give; exit 1 if any does
python tools/make_presets.py --write    writes them
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vgroove.addon.presets import FOLDER
from vgroove.addon.reference import Dielectric, schlick
from vgroove.addon.reference.fresnel import F82_COSINE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

DATA = Path(__file__).parent / "data"
HEAD = "# SPDX-License-Identifier: GPL-3.0-or-later\n# Made by tools/make_presets.py\n"


def table(name: str) -> list[dict[str, str]]:
    """Rows of tools/data/NAME.csv; lines that start with # are comments."""
    text = (DATA / f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def rgb(row: dict[str, str], key: str) -> NDArray[np.float64]:
    return np.array([float(row[f"{key}_{channel}"]) for channel in "rgb"])


def number(value: object) -> str:
    """A TOML value: numbers to six digits."""
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(number(part) for part in value) + "]"
    text = f"{float(value):.6g}"  # type: ignore[arg-type]
    return text if any(mark in text for mark in ".en") else text + ".0"


def toml(values: dict[str, object], **tables: dict[str, object] | list[dict[str, object]]) -> str:
    """Numbers and texts at the top, then tables, and lists of tables."""
    lines = [f"{key} = {number(value)}" for key, value in values.items()]
    for name, content in tables.items():
        for one in content if isinstance(content, list) else [content]:
            lines += ["", f"[[{name}]]" if isinstance(content, list) else f"[{name}]"]
            lines += [f"{key} = {number(value)}" for key, value in one.items()]
    return HEAD + "\n".join(lines) + "\n"


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
            toml(values | {"albedo": rgb(row, "kd"), "sigma": 0.0}, lobes=lobes, source=source),
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
        yield f"translucent/{row['id']}", toml(values, fresnel={"eta": eta}, source=source, verified=head_on(eta))


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


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the presets")
    write = parser.parse_args().write
    differ = []
    for identity, text in [*car_paints(), *translucent()]:
        path = FOLDER / f"{identity}.toml"
        if write:
            path.parent.mkdir(exist_ok=True)  # a new family
            path.write_text(text, encoding="utf-8")
        elif not path.exists() or path.read_text(encoding="utf-8") != text:
            differ.append(identity)
    for identity in differ:
        print(f"presets/{identity}.toml differs from the tables; run tools/make_presets.py --write")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
