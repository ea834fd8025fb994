# SPDX-License-Identifier: GPL-3.0-or-later
"""A report whose figures are known in closed form: bias b, noise c / sqrt(N), times a + d N."""

import numpy as np

SEEDS, PIXELS = 4, 500
COUNTS = tuple(2**k for k in range(2, 13))
START = 0.05
#        bias, noise of one sample, seconds of a sample
MODELS = {
    "fit": (0.012, 0.3, 1.2e-3),
    "closure": (0.05, 0.3, 1.0e-3),
    "hybrid": (0.004, 1.0, 1.6e-3),
    "corrected": (0.0, 0.3, 1.5e-3),
    "mirror": (0.0, 2.0, 0.8e-3),
}
PEERS = {
    "Metallic BSDF": ("cycles", 0.06, 0.28, 1.0e-3, "Smith's G"),
    "Principled BSDF": ("cycles", 0.2, 0.3, 1.1e-3, "GGX in place of Beckmann's D"),
    "roughconductor": ("mitsuba", 0.06, 0.4, 0.7e-3, "Smith's G"),
}


def contender(bias, noise, per_sample, counts=COUNTS, **words):
    n = np.array(counts, float)
    spread = noise / np.sqrt(n)
    bias2 = np.full(len(n), bias**2)
    # As report/statistics.py has it, with the same variance v in every pixel: 2 (v / S)^2 + 4 b^2 v / S over P.
    doubt = np.sqrt((2 * (spread**2 / SEEDS) ** 2 + 4 * bias2 * spread**2 / SEEDS) / PIXELS)
    seconds = START + per_sample * n
    return {
        "estimator": "", "backend": "", "peer": "", "differs": "", **words,
        "rmse": np.sqrt(bias2 + spread**2).tolist(), "bias2": bias2.tolist(), "bias2_error": doubt.tolist(),
        "noise": spread.tolist(), "flip": (0.1 * np.sqrt(bias2 + spread**2)).tolist(),
        "wall": (seconds / 2).tolist(), "cpu": seconds.tolist(),
    }  # fmt: skip


def accuracy(scene, subject, *, counts=COUNTS, harder=1.0, lamps=True):
    """harder: the factor of every noise."""
    contenders = {}
    for backend, slower in (("nodes", 1.0), ("osl", 1.3)):
        for name, (bias, noise, per_sample) in MODELS.items():
            if lamps or name != "corrected":
                contenders[f"{name}, {backend}"] = contender(
                    bias, noise * harder, per_sample * slower, counts, estimator=name, backend=backend
                )
    for name, (peer, bias, noise, per_sample, differs) in PEERS.items():
        contenders[name] = contender(bias, noise * harder, per_sample, counts, peer=peer, differs=differs)
    return {
        "scene": scene, "subject": subject, "preset": "lecture/copper", "model": "cook_torrance", "m": 0.3,
        "size": 32, "seeds": SEEDS, "truth": "known in closed form", "samples": list(counts),
        "contenders": contenders, "auto": ["corrected" if lamps else "fit"] * len(counts), "pictures": None,
    }  # fmt: skip


def case(what, value, *, passed=True, limit="", z=0.5):
    return {
        "what": what, "value": value, "finite": True, "lowest": 0.0, "highest": 0.9, "z": z, "limit": limit,
        "passed": passed,
    }  # fmt: skip


def left_out(time, *, difference=1e-7):
    return {
        "preset": "lecture/copper", "scene": "softbox", "backend": "nodes", "dropped": ["time", "transmission"],
        "nodes": [40, 400], "instructions": [120, 2000], "time": time, "spread": [0.95 * time, 1.05 * time],
        "first": 2.0 * time, "memory_mb": [300, 320], "difference": difference, "bar": 1e-6,
    }  # fmt: skip


def cells(counts=COUNTS):
    pairs = [(scene, subject) for subject in ("copper", "plaster") for scene in ("furnace", "environment", "softbox", "sun")]
    return {
        **{
            f"accuracy/{scene}/{subject}": accuracy(
                scene, subject, counts=counts, harder=1.0 + index, lamps=scene in {"softbox", "sun"}
            )
            for index, (scene, subject) in enumerate([*pairs, ("checker", "frosted")])
        },
        "stability/slope": {"cases": [case("m", m, limit="clamped to 1e-4 .. 1" if m < 1e-4 else "") for m in (1e-6, 1e-4, 0.1, 1.0)]},
        "stability/far": {"cases": [case("metres", 1e3), case("metres", 1e5, passed=False, z=40.0)]},
        "left_out/metal": left_out(2.0),
        "left_out/plaster": left_out(3.0),
        "left_out/glass": left_out(1.5),
    }  # fmt: skip


def report(blenders=("5.2.3",), counts=COUNTS):
    return {
        "format": 1, "machine": {"system": "linux", "processor": "x86_64", "cores": 2, "memory_gb": 8},
        "runs": {blender: {"vgroove": "0.1.0", "quick": False, "cells": cells(counts)} for blender in blenders},
    }  # fmt: skip
