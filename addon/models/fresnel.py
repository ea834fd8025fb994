# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of Fresnel term: the parameters of each, and the reference's class for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..reference import F82, Conductor, Dielectric, Fresnel, Schlick
from .spec import Parameter

if TYPE_CHECKING:
    from collections.abc import Callable

    from .spec import Form

F0 = Parameter(
    "f0", "Base Color", "F0: reflectance at normal incidence", (0.04, 0.04, 0.04), 0.0, 1.0, socket="Color",
    symbol="F0",
)  # fmt: skip
F82_TINT = Parameter(
    "f82_tint", "Edge Tint", "Multiplies Schlick's formula at 82 degrees, near grazing; white changes nothing",
    (1.0, 1.0, 1.0), 0.0, 1.0, socket="Color", symbol="F82 Tint",
)  # fmt: skip
ETA = Parameter(
    "eta", "IOR", "Refractive index, inside over outside", 1.5, 0.1, 10.0, example="eta = 1.5",
)  # fmt: skip
N = Parameter(
    "n", "IOR", "Refractive index n for R, G and B", (0.27, 0.68, 1.32), 0.0, 20.0, socket="Vector", symbol="n",
)  # fmt: skip
K = Parameter(
    "k", "Extinction", "Extinction coefficient k for R, G and B", (3.61, 2.62, 2.29), 0.0, 20.0, socket="Vector",
    symbol="k",
)  # fmt: skip


@dataclass(frozen=True)
class Kind:
    """A Fresnel term. is_metal: no light passes to the layers below. says: where its numbers come from, in words."""

    label: str
    parameters: tuple[Parameter, ...]
    make: Callable[..., Fresnel]
    says: str
    is_metal: bool = False


KINDS = {
    "schlick": Kind("Schlick", (F0,), Schlick, "Schlick's formula from F0"),
    "dielectric": Kind("Dielectric", (ETA,), Dielectric, "exact, from the index of refraction"),
    "conductor": Kind("Conductor", (N, K), Conductor, "exact, from n and k", is_metal=True),
    "f82": Kind("F82", (F0, F82_TINT), F82, "Schlick's formula from F0, with a tint at 82 degrees", is_metal=True),
}
LABELS = {name: kind.label for name, kind in KINDS.items()}


def reference(form: Form) -> Fresnel:
    """F of the reference; KeyError of a form without a Fresnel term."""
    kind = KINDS[form.kind]
    numbers: dict[str, Any] = dict(form.parameters)
    return kind.make(*(numbers[one.name] for one in kind.parameters))
