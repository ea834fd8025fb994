# SPDX-License-Identifier: GPL-3.0-or-later
"""Automatic's table of bias (addon/choose/automatic.toml) from a report. Imports no bpy.

An entry is the root mean square bias of the default Blender's scenes with that kind of light, to two digits. Where no
such bias was measured, or none can be distinguished from 0, the entry stays: an estimate.
"""

from __future__ import annotations

import copy
import json
import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np

from ...addon.models import MODELS
from ..bench.scene_table import SCENES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from .published import Published

FILE = "addon/choose/automatic.toml"
HEAD = """\
# What Automatic knows of each model: the bias of ``closure`` and ``fit``, as a share of the image, by kind of light, at
# the values ``at`` of its roughness ``parameter``; and the kinds of light under which a report compared the two.
# `make documents` writes this file from a report (lab/report/automatic.py). What no report measured is an estimate.
# ``report``: the digest of the code that measured it.
"""


def read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def updated(tables: Mapping[str, Any], published: Published) -> dict[str, Any]:
    """The tables with what the default Blender measured."""
    new: dict[str, Any] = copy.deepcopy(dict(tables))
    scenes = [(SCENES[key.partition("/")[0]].light, of) for key, of in published.default.scenes.items()]
    for model, table in new["models"].items():
        for light, biases in table["bias"].items():
            for index, at in enumerate(table["at"]):
                lit = [of for kind, of in scenes if (kind, of.model) == (light, model)]
                curves = [of.curves for of in lit if of.roughness.get(table["parameter"]) == at]
                for estimator, values in biases.items():
                    measured = [of[f"{estimator}, nodes"].bias for of in curves if f"{estimator}, nodes" in of]
                    known = [bias for bias in measured if bias is not None]
                    if known:
                        values[index] = float(f"{np.sqrt(np.mean(np.square(known))):.2g}")
    new["report"] = published.default.code.get("accuracy", "")
    new["measured"] = {}
    for light, of in scenes:
        parts = {part for _, part in MODELS[of.model].parts} | {MODELS[of.model].lobe_model} - {""} or {of.model}
        if {"fit, nodes", "closure, nodes"} <= of.curves.keys() and parts <= new["models"].keys():
            lights = new["measured"].setdefault(of.model, [])
            lights += [light] * (light not in lights)
    return new


def to_toml(tables: Mapping[str, Any]) -> str:
    return HEAD + "\n".join(_lines(tables, ())) + "\n"


def _lines(table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    plain = {name: value for name, value in table.items() if not isinstance(value, dict)}
    if path and plain:
        yield ""
        yield f"[{'.'.join(path)}]"
    for name, value in plain.items():
        yield f"{name} = {json.dumps(value)}"
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _lines(value, (*path, name))
