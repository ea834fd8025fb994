# SPDX-License-Identifier: GPL-3.0-or-later
"""Glass in Cycles against NumPy, in the manner of ``check``: rows of views, judged by bars or by Z-tests.

A white furnace gives R + T; one lit only above or only below gives R or T alone. The sun below gives the BTDF.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from .. import nodegroups
from ..nodegroups import glass_closure, glass_mirror
from . import check, gonio, headless
from .reference import CookTorrance, Dielectric, Glass, glass_btdf, smith_g
from .reference.glass import ETA_RANGE, pane
from .reference.quadrature import vgroove_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import Material
    from numpy.typing import NDArray

    from .check import Row, Setup

SLOPES = (0.1, 0.3, 0.6, 1.0)
CLOSURE_SLOPES = (0.1, 0.3, 1.0)
ETAS = (1.33, 1.5, 2.42, 1.0 / 1.5)
THETAS = (180.0, 160.0, 140.0, 100.0)  # of the sun below
SAMPLES = 1024
SMOOTH_BAR = 1e-4
MODULES = {"closure": glass_closure, "mirror": glass_mirror}


def material(
    setup: Setup, estimator: str, eta: float, m: float, *, thin: bool = False, tint: tuple[float, float, float] = (1, 1, 1)
) -> Material:
    """Glass as ``estimator`` builds it; smooth for m = 0."""
    module = MODULES[estimator]
    make = module.build_osl if setup.backend == "osl" else module.build
    name = f"{module.NAME}{' Sheet' * thin}{' Smooth' * (m == 0)}{' (OSL)' * (setup.backend == 'osl')}"
    group = nodegroups.ensure(name, module.REVISION, partial(make, thin=thin, smooth=m == 0))
    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):  # 4.5 has no tree until use_nodes is set; 5.x warns when it is. Goes with 4.5 LTS.
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeOutputMaterial")
    node.node_tree = group
    node.inputs["IOR"].default_value, node.inputs["Tint"].default_value = eta, (*tint, 1.0)
    if m > 0:
        node.inputs["Slope m"].default_value = m
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    made.cycles.use_bump_map_correction = estimator != "mirror"  # it would bend the sampled facets
    return made


def measure(made: Material, setup: Setup, geometry: gonio.Geometry, samples: int) -> NDArray[np.float64]:
    """The image of ``made``, which is removed."""
    with headless.quiet():
        image = gonio.measure(made, geometry, samples=samples, shading_osl=setup.shading_osl)
    bpy.data.materials.remove(made)
    return image.astype(np.float64)


def furnace_row(setup: Setup, eta: float, m: float, lit: str, *, inside: bool = False, thin: bool = False) -> Row:
    """``mirror`` in a white world, or in half of one: R + T, R or T; seen from ``inside`` with 1/eta.

    One sample is worth FR + (1-F)T of its facet where it finds light. In half a world it does with the share that
    Cycles gives to the closure on that side, in proportion to the weights.
    """
    geometry = gonio.Geometry(furnace=True, lit=lit, resolution=(32, 32), inside=inside)  # type: ignore[arg-type]
    column = geometry.wo()[:, :1]
    ahead = float(np.float32(1.0 / eta if inside and not thin else eta))

    def parts(F: Any, R: Any, T: Any) -> tuple[Any, Any]:
        F, T = (pane(F), 1.0) if thin else (F, T)
        return F * R, (1.0 - F) * T

    def found(F: Any, R: Any, T: Any) -> Any:
        up, down = parts(F, R, T)
        return {"all": up + down, "above": up, "below": down}[lit]

    mean = vgroove_mean(column, m, ahead, found)
    square = vgroove_mean(column, m, ahead, lambda F, R, T: found(F, R, T) * sum(parts(F, R, T)))
    mean, square = (np.broadcast_to(image, (32, 32, 3)) for image in (mean, square))
    variance = np.maximum(square - mean**2, 0.0) / SAMPLES
    made = material(setup, "mirror", eta, m, thin=thin)
    view = check.View(geometry, measure(made, setup, geometry, SAMPLES), mean, variance=variance)
    side = {"all": "R + T", "above": "R", "below": "T"}[lit]
    return check.Row(f"{'sheet' if thin else 'glass'} mirror, {side}{', inside' * inside}", setup, f"IOR {eta:.4g}", m, [view])


def smooth_row(setup: Setup, estimator: str, eta: float, *, inside: bool = False, thin: bool = False) -> Row:
    """m = 0 in a white world: nothing is lost."""
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32), inside=inside)
    made = material(setup, estimator, eta, 0.0, thin=thin)
    measured = measure(made, setup, geometry, 16)
    view = check.View(geometry, measured, np.ones_like(measured), SMOOTH_BAR, 1.0)
    return check.Row(f"{'sheet' if thin else 'glass'} {estimator}, m = 0", setup, f"IOR {eta:.4g}", 0.0, [view])


def closure_row(setup: Setup, eta: float, m: float, *, inside: bool = False) -> Row:
    """``closure`` lit by a sun below: the BTDF with Smith's G, on the hemisphere and around the refracted ray."""
    row = check.Row(f"glass closure, sun below{', inside' * inside}", setup, f"IOR {eta:.4g}", m)
    m32, ahead = float(np.float32(m)), float(np.float32(1.0 / eta if inside else eta))
    for theta_i in THETAS:
        for window in (0.0, check.WINDOW):
            geometry = gonio.Geometry(theta_i, window, eta=ahead, inside=inside)
            if ahead * np.sin(np.radians(theta_i)) >= 0.999:
                if window:
                    continue
                geometry = gonio.Geometry(theta_i, inside=inside)
            wi, wo = geometry.wi(), geometry.wo()
            G = smith_g(-wi, wo, m32)
            expected = glass_btdf(wi, wo, m32, ahead, G)[..., None] * np.ones(3)
            measured = measure(material(setup, "closure", eta, m), setup, geometry, 1)
            bar = max(2e-4, 4.0 * check.ROUNDING / m**2)
            row.views.append(check.View(geometry, measured, expected, bar, float(np.max(expected))))
    return row
