# SPDX-License-Identifier: GPL-3.0-or-later
"""How a preset becomes a material: backend, estimator, and the lights that it evaluates itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...nodegroups import versions
from ..library.errors import InputError
from ..models import MODELS
from ..models.estimators import ALL, EVERY_LIGHT, NATIVE
from ..reference.hybrid import BOUNDS, DEFAULT_BOUND
from . import lamps as lamp_binding

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import Scene

    from .course import Play
    from .lamps import Light

BACKENDS = ("nodes", "osl")


def most_lights(estimator: str, model: str) -> int:
    """How many lights may be bound: eight, or as many as fit on Cycles' stack of 255 floats.

    A material that outgrows it renders black. Measured with room for an artist's own nodes; in 4.5, which stores more
    on it, without: test_stack.py.
    """
    spec = MODELS[model]
    fewer = spec.most_lights if versions.LEAN_STACK else spec.most_lights_4_5
    return fewer.get(estimator, lamp_binding.LIMIT)


def binds(estimator: str, lamp_size: float, model: str = "cook_torrance") -> bool:
    """Whether a material by ``estimator`` evaluates the formula itself at a lamp of this size.

    ``mirror`` and ``hybrid`` do so where it is 0, as their random rays cannot hit such a lamp; glass never does.
    """
    if MODELS[model].transparent:
        return False
    return estimator in EVERY_LIGHT or (estimator not in NATIVE and lamp_size == 0.0)


def lamps_to_bind(scene: Scene, estimator: str, model: str = "cook_torrance") -> tuple[Light, ...]:
    """The strongest lights that the material evaluates itself, as ``binds`` says for their size."""
    if estimator in NATIVE or MODELS[model].transparent:
        return ()
    return bindable(lamp_binding.rig_lights(scene), estimator, model)


def bindable(lights: Sequence[Light], estimator: str, model: str) -> tuple[Light, ...]:
    """Those of ``lights``, a scene's rig, that the material evaluates itself."""
    return tuple(one for one in lights if binds(estimator, lamp_binding.size(one.item), model))[
        : most_lights(estimator, model)
    ]


class MaterialError(InputError):
    """A material that cannot be built or changed as asked."""


@dataclass(frozen=True)
class Choice:
    """How a preset becomes a material.

    lamps: those that are evaluated by the formula: all of ``direct`` and ``corrected``, and beside ``mirror`` and
    ``hybrid`` those of zero size, which no ray can hit. shadows: whether these lamps cast any.
    bound: how much of the directional albedo ``hybrid`` may have wrong.
    disperses: whether clear bodies bend each colour by their Abbe number, where it is known and Cycles can (5.3).
    bounces: whether light that bounces within the grooves of a metal is added, which the formula leaves out.
    play: how the course of a preset that changes is played; without it the material stands still, at the start.
    """

    backend: str = "nodes"
    estimator: str = "fit"
    lamps: tuple[Light, ...] = ()
    shadows: bool = True
    bound: float = DEFAULT_BOUND
    disperses: bool = False
    bounces: bool = False
    play: Play | None = None

    def __post_init__(self) -> None:
        for what, value, known in (("backend", self.backend, BACKENDS), ("estimator", self.estimator, ALL)):
            if value not in known:
                message = f'unknown {what} "{value}"; use one of {", ".join(known)}'
                raise MaterialError(message)
        if self.lamps and self.estimator in NATIVE:
            message = f'"{self.estimator}" sees every lamp by itself; leave lamps empty'
            raise MaterialError(message)
        if len(self.lamps) > lamp_binding.LIMIT:
            most = f"at most {lamp_binding.LIMIT} lamps, got {len(self.lamps)}; bind the strongest"
            message = f'"{self.estimator}" binds {most}'
            raise MaterialError(message)
        low, high = BOUNDS
        if not low <= self.bound <= high:
            message = f"bound must be between {low:g} and {high:g} of the reflected light, got {self.bound:g}"
            raise MaterialError(message)
        for one in self.lamps:
            if refused := lamp_binding.refusal(one):
                raise MaterialError(refused)
            if not one.number:
                message = f"{one.name} has no place in the scene's rig; take lamps from lamps_to_bind"
                raise MaterialError(message)
