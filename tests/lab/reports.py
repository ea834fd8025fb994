# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports whose figures are known in closed form: bias b, noise c / sqrt(N), times a + d N."""

import json

import numpy as np

from vgroove import cli
from vgroove.lab.bench import record
from vgroove.lab.report import claims, findings, published, tables

SEEDS, PIXELS = 4, 500
COUNTS = tuple(2**k for k in range(2, 13))
START = 0.05
#        bias, noise of one sample, seconds of a sample
MODELS = {
    "fit": (0.012, 0.3, 1.2e-3),
    "closure": (0.05, 0.3, 1.0e-3),
    "corrected": (0.0, 0.3, 1.5e-3),
    "mirror": (0.0, 2.0, 0.8e-3),
}


def contender(bias, noise, per_sample, start=START, counts=COUNTS, **words):
    n = np.array(counts, float)
    spread = noise / np.sqrt(n)
    bias2 = np.full(len(n), bias**2)
    # As report/statistics.py has it, with the same variance v in every pixel: 2 (v / S)^2 + 4 b^2 v / S over P.
    doubt = np.sqrt((2 * (spread**2 / SEEDS) ** 2 + 4 * bias2 * spread**2 / SEEDS) / PIXELS)
    seconds = start + per_sample * n
    return {
        "estimator": "", "backend": "", "peer": "", "differs": "", **words,
        "bias2": bias2.tolist(), "bias2_error": doubt.tolist(), "cpu_spread": [0.0] * len(n),
        "resolved": [True] * len(n), "seeds": [SEEDS] * len(n),
        "noise": spread.tolist(),
        "cpu": seconds.tolist(),
    }  # fmt: skip


def accuracy(scene="softbox", subject="copper", counts=COUNTS):
    contenders = {
        f"{name}, {backend}": contender(
            bias, noise, per_sample * slower, counts=counts, estimator=name, backend=backend
        )
        for backend, slower in (("nodes", 1.0), ("osl", 1.3))
        for name, (bias, noise, per_sample) in MODELS.items()
    }
    contenders["Metallic BSDF"] = contender(0.06, 0.28, 1e-3, counts=counts, peer="cycles", differs="Smith's G")
    contenders["roughconductor"] = contender(0.0, 1e-3, 1e-4, counts=counts, peer="mitsuba", differs="Smith's G")
    return {
        "scene": scene, "subject": subject, "model": "cook_torrance", "roughness": {"m": 0.3},
        "size": 32, "seeds": [SEEDS] * len(counts), "truth": "known in closed form", "samples": list(counts),
        "independent": scene in ("softbox", "furnace"), "contenders": contenders,
        "auto": ["corrected"] * len(counts),
    }  # fmt: skip


def case(what, value, *, passed=True, **more):
    usual = {"setup": "", "lowest": 0.0, "highest": 0.9, "z": 0.5}
    return {"what": what, "value": value, "passed": passed} | usual | more


def left_out(time, *, same=True, **more):
    part = {"what": "time", "why": "it is static", "nodes": 93, "same": True}
    setup = {
        "case": "", "preset": "lecture/copper", "scene": "lamps", "backend": "nodes", "estimator": "corrected",
        "nodes": [40, 400], "slowdown": time, "spread": [0.95 * time, 1.05 * time], "same": same,
        "omitted": [part, part | {"what": "transmission"}],
    }  # fmt: skip
    return [setup | more]


def report(blenders=("5.2.3",), cells=None):
    cells = cells or {
        "accuracy/softbox/copper": accuracy(),
        "stability/slope": [
            case("m", 1e-6, limit="held to 1e-4"), case("m", 1.0), case("shot", {}), case("shot", {"where": 1e3})
        ],
        "stability/far": [case("metres", 1e5, passed=False)],
        "left_out/metal": left_out(2.0),
        "left_out/plaster": left_out(3.0),
        "left_out/glass": left_out(1.5),
    }  # fmt: skip
    cells = dict(cells)
    for key, cell in list(cells.items()):
        part, _, what = key.partition("/")
        if part in {"stability", "left_out"} and isinstance(cell, list):
            cells[key] = [{"group": what, **one} if part == "stability" else one | {"case": what} for one in cell]
        if part == "accuracy" and "auto" in cell:
            cells.setdefault(f"picks/{what}", {"estimators": cell["auto"]})
    content = {
        "format": record.FORMAT, "machine": {"system": "linux", "processor": "x86_64", "cores": 2, "memory_gb": 8},
        "runs": {
            blender: {"vgroove": "0.1.0", "versions": {}, "quick": False, "code": {}, "cells": cells}
            for blender in blenders
        },
    }  # fmt: skip
    return json.loads(json.dumps(content))  # no part is another's


def measured(time):
    """A cell as its part measures it."""
    return record.CODEC.structure(left_out(time), record.PARTS["left_out"])


def runs(content):
    return findings.runs(record.structured(content))


def only(cells):
    """The run of a report of these cells."""
    return runs(report(cells=cells))[0]


def contested(cell):
    return only({"accuracy/a/b": cell}).contests[0]


def vgroove(*arguments):
    return cli.run(lambda: cli.app(["report", *map(str, arguments)], standalone_mode=False))


def curve(bias, noise, per_sample, counts=COUNTS, **changes):
    cell = accuracy(counts=counts) | {"contenders": {"x": contender(bias, noise, per_sample, counts=counts, **changes)}}
    return contested(cell).curves["x"]


SAME_IN = "{} of {} cases match the universal material; {} also match with each component put back"


def claimed(cells):
    """Of a report of these cells: {the claim's first words: (what was found, whether it holds)}."""
    return {" ".join(one.claim.split()[:3]): (one.found, one.holds) for one in claims.of(only(cells))}


def with_mirror(scene="softbox", **figures):
    cell = accuracy(scene)
    cell["contenders"]["mirror, nodes"] |= {key: np.asarray(values).tolist() for key, values in figures.items()}
    return cell


def section(run, title):
    figures = published._run(run, first=True)
    return next(one for one in tables.sections(run, figures) if one.title == title)
