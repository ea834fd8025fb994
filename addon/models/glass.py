# SPDX-License-Identifier: GPL-3.0-or-later
"""A transparent interface, rough or smooth, or a thin sheet: reflection and refraction by the facets of V-grooves."""

from dataclasses import replace

from ..reference import Glass
from . import fresnel, principled
from .cook_torrance import SLOPE
from .spec import Form, Model, Parameter

TINT = Parameter(
    "tint", "Base Color", "Multiplies the transmitted light", (1.0, 1.0, 1.0), 0.0, 1.0, socket="Color", optional=True,
    symbol="Tint",
)  # fmt: skip
ABSORPTION = Parameter(
    "absorption", "Absorption", "Absorption a of red, green and blue light, 1/m; exp(-a d) is left after d metres",
    (0.0, 0.0, 0.0), 0.0, 1e5, unit="1/m", socket="Color", optional=True, in_volume=True,
)  # fmt: skip
ABBE = Parameter(
    "abbe", "Abbe Number", "(n_d - 1) / (n_F - n_C): the smaller, the wider colors spread; 0 spreads none", 0.0,
    0.0, 1000.0, optional=True, in_volume=True,
)  # fmt: skip


def _reference(form: Form, _parts: object) -> Glass:
    of = form.parameters
    return Glass(of["m"], of["eta"], of["tint"], thin=form.kind == "thin")


def _principled(form: Form) -> principled.Inputs:
    """Principled multiplies by the root of its colour at each of a body's two surfaces, and once at a thin wall."""
    thin = form.kind == "thin"
    return principled.ROUGHNESS | {
        "Base Color": principled.Feed("tint", exponent=1.0 if thin else 2.0),
        "IOR": principled.Feed("eta"),
        "Transmission Weight": 1.0,
        "Thin Wall": float(thin),
    }


MODEL = Model(
    name="glass",
    label="Glass",
    opening="Transparent ",
    parameters=(replace(SLOPE, default=0.1), fresnel.ETA, TINT, ABSORPTION, ABBE),
    kinds={"interface": "", "thin": "Thin"},
    estimators=("closure", "mirror"),
    reference=_reference,
    solid=lambda form: form.parameters["tint"],
    principled=_principled,
    transparent=True,
    sheets=frozenset({"thin"}),
    smooth_estimator="mirror",
    of_cycles=lambda _estimator, backend: backend == "osl",  # 5.3's OSL turns the IOR of back faces itself
)
