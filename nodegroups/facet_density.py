# SPDX-License-Identifier: GPL-3.0-or-later
"""D of any distribution of facets, and facets drawn by it: ``facet_distribution`` of the reference.

Formulas are nodes. Points, and the bins that facets are drawn from, are texels of a small packed image of floats.
"""

from __future__ import annotations

import hashlib
import json
from functools import partial
from math import pi
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..addon.reference.facet_distribution import BINS, POINTS, SQRT_6, Distribution, Term
from . import REVISION_KEY, ensure
from ._tree import Tree, Value, dot, exp, less, log, maximum, output, scale, select, sqrt, vector
from .polynomial import horner

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._tree import Number

NAME = ".VGroove Facet Density"
BINS_NAME, POINTS_NAME = "VGroove Facet Bins", "VGroove Facet Points"
REVISION = 2
HEADER = "facet_distribution.h"
LOWEST_COSINE = 1e-4  # 1/cos^4 must not overflow


def digest(of: Distribution) -> str:
    """A short name of its own for each distribution."""
    text = json.dumps([(term.kind, term.numbers, share) for term, share in zip(of.terms, of.shares, strict=True)])
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def density(tree: Tree, of: Distribution, sin2: Value, cos: Value) -> Value:
    """D in 1/sr through the nested group, from sin^2 and cos of the angle between facet and normal."""
    group = ensure(f"{NAME} {digest(of)}", REVISION, partial(build, of=of))
    return Value(tree, tree.group(group, Sin2=sin2, Cos=cos).outputs["D"])


def sin2_and_cos(h: Value, N: Value) -> tuple[Value, Value]:
    """Of the angle between two unit vectors; sin^2 by components, as 1 - cos^2 would cancel in float32."""
    cos = dot(N, h)
    aside = h - scale(N, cos)
    return dot(aside, aside), cos


def build(tree: Tree, of: Distribution) -> None:
    sin2 = tree.input_float("Sin2", 0.0, low=0.0, high=1.0, tip="sin^2 between facet and normal")
    cos = tree.input_float("Cos", 1.0, low=-1.0, high=1.0, tip="Its cosine")
    c = maximum(cos, LOWEST_COSINE)
    D: Number = 0
    for share, term in zip(of.shares, of.terms, strict=True):
        with tree.frame(term.kind):
            D = D + _term(tree, term, share * term.scale, sin2, c)
    tree.output_float("D", D * tree.math("GREATER_THAN", cos, 0.0), tip="Facet density in 1/sr")


def _term(tree: Tree, of: Term, scaled: float, sin2: Value, c: Value) -> Value:
    if of.kind == POINTS:
        last = len(of.numbers) - 1
        angle = tree.math("ARCTAN2", sqrt(sin2), c)
        place = sqrt(angle * (2.0 / pi)) * float(last)
        k = tree.math("MINIMUM", tree.math("FLOOR", place), last - 1.0)
        image = _image(POINTS_NAME, np.array([[[number * scaled] * 3 + [1.0] for number in of.numbers]]))
        low, high = (_texel(tree, image, (k + (0.5 + step)) * (1.0 / (last + 1))).rgb[0] for step in (0, 1))
        return low + (place - k) * (high - low)
    if of.kind == "abc":
        B, C = of.numbers
        return scaled * exp(-C * _log1p(B * sin2 / (1.0 + c)))
    (m,), cos2 = of.numbers, c * c
    if of.kind == "ggx":
        return scaled / (cos2 + sin2 / m**2) ** 2
    tan2 = sin2 / cos2
    if of.kind == "beckmann":
        return scaled * exp(-(tan2 / m**2)) / (cos2 * cos2)
    return scaled * exp(sqrt(tan2) * (-SQRT_6 / m)) / (cos2 * cos2)


def _log1p(x: Value) -> Value:
    """log(1 + x), by a series where 1 + x would round: y = x / (2 + x)."""
    y = x / (2.0 + x)
    series = y * horner((2.0, 2.0 / 3.0, 0.4), y * y)
    return select(less(x, 0.1), series, log(1.0 + x))


def drawn(tree: Tree, of: Distribution, u: Value) -> tuple[Value, Value]:
    """``Distribution.draw``: sin^2 of a facet for u in [0, 1], and the D by which it is drawn."""
    edges = of.bins
    low, width = edges[:-1], np.diff(edges)
    pixels = np.stack([low, width, 1.0 / (pi * BINS * width), np.ones(BINS)], axis=-1)[None]
    with tree.frame("A bin, and a place in it"):
        place = u * float(BINS)
        k = tree.math("MINIMUM", tree.math("FLOOR", place), BINS - 1.0)
        texel = _texel(tree, _image(BINS_NAME, pixels), (k + 0.5) * (1.0 / BINS))
        start, wide, D = texel.rgb
        return tree.math("MULTIPLY_ADD", place - k, wide, start), D


def _texel(tree: Tree, image: bpy.types.Image, place: Value) -> Value:
    """Not interpolated, as EEVEE would blur it by mipmaps where ``place`` differs from pixel to pixel."""
    at = vector(place, 0.5, 0.0)
    node = tree.node("ShaderNodeTexImage", image=image, interpolation="Closest", extension="EXTEND", Vector=at)
    return Value(tree, output(node, "Color"))


def _image(name: str, pixels: NDArray[np.float64]) -> bpy.types.Image:
    """A packed image of these pixels (rows, columns, 4); one for the same pixels in a .blend."""
    held = np.ascontiguousarray(pixels, dtype=np.float32)
    title = f"{name} {hashlib.sha256(held.tobytes()).hexdigest()[:12]}"
    for image in bpy.data.images:
        if image.name.split(".")[0] == title and image.get(REVISION_KEY) == REVISION and image.library is None:
            return image
    height, width, _ = held.shape
    image = bpy.data.images.new(title, width, height, alpha=True, float_buffer=True, is_data=True)
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(held.ravel())
    image.update()
    image.pack()
    image[REVISION_KEY] = REVISION
    return image


# OSL


def header(of: Distribution) -> str:
    """``facet_density(sin2, cos)`` and ``drawn_facet(u, D)``, with this distribution's numbers."""
    lines, parts = [], []
    for index, (share, term) in enumerate(zip(of.shares, of.terms, strict=True)):
        scaled = f"{share * term.scale:.9g}"
        if term.kind == POINTS:
            count = len(term.numbers)
            lines.append(f"float points_{index}(float x)\n{{\n    float D[{count}] = {_array(term.numbers)};")
            lines.append(f"    float place = x * {count - 1};\n    int k = min(int(place), {count - 2});")
            lines.append("    return mix(D[k], D[k + 1], place - k);\n}\n")
            parts.append(f"{scaled} * points_{index}(sqrt(atan2(sqrt(sin2), c) * {2.0 / pi:.9g}))")
        elif term.kind == "abc":
            B, C = term.numbers
            parts.append(f"{scaled} * exp(-{C:.9g} * log_one_more({B:.9g} * sin2 / (1 + c)))")
        elif term.kind == "ggx":
            parts.append(f"{scaled} / pow(c * c + sin2 / {term.numbers[0] ** 2:.9g}, 2)")
        elif term.kind == "beckmann":
            parts.append(f"{scaled} * exp(-sin2 / (c * c * {term.numbers[0] ** 2:.9g})) / (c * c * c * c)")
        else:
            parts.append(f"{scaled} * exp(sqrt(sin2) / c * {-SQRT_6 / term.numbers[0]:.9g}) / (c * c * c * c)")
    body = "\n        + ".join(parts)
    lines.append(
        f"float facet_density(float sin2, float cosine)\n{{\n    float c = max(cosine, {LOWEST_COSINE});\n"
        f"    if (cosine <= 0) return 0;\n    return {body};\n}}\n"
    )
    lines.append(
        f"float drawn_sin2(float u, output float D)\n{{\n    float edges[{BINS + 1}] = {_array(of.bins)};\n"
        f"    float place = u * {BINS};\n    int k = min(int(place), {BINS - 1});\n"
        "    float width = edges[k + 1] - edges[k];\n"
        f"    D = 1 / ({pi * BINS:.9g} * width);\n    return edges[k] + (place - k) * width;\n}}\n"
    )
    return "\n".join(lines)


def _array(numbers: object) -> str:
    return "{" + ", ".join(f"{number:.9g}" for number in np.asarray(numbers)) + "}"
