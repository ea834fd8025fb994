# SPDX-License-Identifier: GPL-3.0-or-later
"""What is true: the models in NumPy, float64, as their papers define them. Imports NumPy and nothing else.

Directions are unit vectors away from the surface, in the local frame whose z axis is the normal: ``wi`` to the
light, ``wo`` to the viewer, shape (..., 3). A BRDF value is f(wi, wo) in 1/sr, linear Rec.709 RGB, shape (..., 3),
without the cosine.
"""

from . import anisotropic_fit, cook_torrance_fit, oren_nayar_fit
from .anisotropic import Anisotropic
from .car_paint import CarPaint
from .cook_torrance import CookTorrance, Smooth, cook_torrance, visible_facet
from .directions import reflect, spherical
from .distributions import beckmann_d, smith_g, vgroove_g, vgroove_g1
from .estimators import rendered
from .fresnel import F82, Conductor, Dielectric, Fresnel, Schlick, f82, fresnel_conductor, fresnel_dielectric, schlick
from .glass import Glass, Pane, fresnel_transmittance, glass_btdf, refract
from .groove import Groove
from .keyframes import Keyframes, place_keys
from .model import Model, albedo
from .oren_nayar import Lambert, OrenNayar, oren_nayar
from .sum import Sum
from .trajectory import Exponential, Keys, Logistic, Polynomial, Power, Reciprocal, Trajectory, local_age

__all__ = [
    "F82",
    "Anisotropic",
    "CarPaint",
    "Conductor",
    "CookTorrance",
    "Dielectric",
    "Exponential",
    "Fresnel",
    "Glass",
    "Groove",
    "Keyframes",
    "Keys",
    "Lambert",
    "Logistic",
    "Model",
    "OrenNayar",
    "Pane",
    "Polynomial",
    "Power",
    "Reciprocal",
    "Schlick",
    "Smooth",
    "Sum",
    "Trajectory",
    "albedo",
    "anisotropic_fit",
    "beckmann_d",
    "cook_torrance",
    "cook_torrance_fit",
    "f82",
    "fresnel_conductor",
    "fresnel_dielectric",
    "fresnel_transmittance",
    "glass_btdf",
    "local_age",
    "oren_nayar",
    "oren_nayar_fit",
    "place_keys",
    "reflect",
    "refract",
    "rendered",
    "schlick",
    "smith_g",
    "spherical",
    "vgroove_g",
    "vgroove_g1",
    "visible_facet",
]
