# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a facet is drawn for each sample as the V-groove shows it, then mirrors and refracts.

Unbiased: the weights F G2 / G1 and (1 - F) G2t / G1 are what is left once the facet's density is divided out.
Source: Heitz & d'Eon 2014, V-cavity model; ``visible_facet`` and ``Glass.sample`` of the reference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import glass
from ._tree import Tree, Value, clamp, dot, maximum, minimum, scale, sqrt
from .shading_normal import specular_normal
from .visible_facet import visible_facet

if TYPE_CHECKING:
    from bpy.types import NodeSocket

NAME = "VGroove Glass Mirror"
REVISION = 6


def build(tree: Tree, *, thin: bool = False, smooth: bool = False, disperses: bool = False) -> None:
    """``thin``: a sheet, whose facets are panes. ``smooth``: m = 0, without Slope m and random numbers.

    ``disperses``: by an Abbe number, where it is smooth.
    """
    if smooth and disperses:
        shader = glass.dispersive_interface(tree, glass.smooth_inputs(tree), 0.0)
    elif smooth:
        shader = glass.smooth_interface(tree, glass.smooth_inputs(tree), thin=thin)
    else:
        shader = facet(tree, glass.rough_inputs(tree), thin=thin)
    tree.output_shader("BSDF", shader, tip="To the material's Surface")


def build_osl(tree: Tree, *, thin: bool = False, smooth: bool = False) -> None:
    inputs = glass.smooth_inputs(tree) if smooth else glass.rough_inputs(tree)
    tree.output_shader("BSDF", glass.script(tree, "mirror", inputs, thin=thin), tip="To the material's Surface")


def facet(tree: Tree, inputs: glass.RoughInputs, *, thin: bool) -> NodeSocket:
    """A mirror and a refraction about one random facet."""
    N = specular_normal(tree, inputs.normal)
    wo = tree.geometry("Incoming")
    h = visible_facet(tree, N, wo, inputs.m)
    eta = inputs.eta if thin else glass.index_ahead(tree, inputs.eta)
    with tree.frame("Weight F G2 / G1 of what is mirrored"):
        vh = clamp(dot(wo, h))
        wi = scale(h, 2.0 * vh) - wo
        nh, no, ni = dot(N, h), maximum(dot(N, wo), 0.0), maximum(dot(N, wi), 0.0)
        G1 = minimum(2.0 * nh * no / vh, 1.0)
        G2 = minimum(2.0 * nh * ni / vh, G1)
        F = glass.reflectance(tree, vh, eta, thin=thin)
        R = F * (G2 / G1)
    T = 1.0 - F if thin else (1.0 - F) * _share_below(tree, eta, vh, nh, no, G1)
    return glass.split(tree, h, R, T, inputs, thin=thin)


def _share_below(tree: Tree, eta: Value, vh: Value, nh: Value, no: Value, G1: Value) -> Value:
    """G2t / G1, from g = eta |l.h| and eta |n.l| = n.v + (g - v.h) (n.h)."""
    with tree.frame("G2t / G1, G2t = max(G1(v) + G1(l) - 1, 0), of what is refracted"):
        beyond = (eta - 1.0) * (eta + 1.0)
        g = sqrt(vh * vh + beyond)  # 0 in total reflection, where 1 - F is 0
        down = maximum(no + nh * beyond / maximum(g + vh, 1e-7), 0.0)
        G1_below = minimum(2.0 * nh * down / maximum(g, 1e-7), 1.0)
        return maximum(G1 - (1.0 - G1_below), 0.0) / G1
