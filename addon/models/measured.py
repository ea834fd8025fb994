# SPDX-License-Identifier: GPL-3.0-or-later
"""A measured table: no formula, but what was measured, interpolated. Isotropic surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import principled
from .spec import Form, MeasuredTable, Model

if TYPE_CHECKING:
    from collections.abc import Callable

GREY = (0.5, 0.5, 0.5)  # of a table that cannot be read, for lists and viewports
READERS: list[Callable[[MeasuredTable], Any]] = []  # addon/measured puts its own here when it is imported


def _reference(form: Form, _parts: object) -> Any:
    if form.table is None or not READERS:
        message = "measured tables are read by vgroove.addon.measured; import it first"
        raise ValueError(message)
    return READERS[-1](form.table)


def _closure(form: Form) -> tuple[tuple[float, ...], tuple[float, ...], float]:
    """RGB of the diffuse part and of the lobe, and its slope; grey where the file cannot be read."""
    try:
        found: tuple[tuple[float, ...], tuple[float, ...], float] = _reference(form, {}).closure
    except ValueError:  # every InputError is one
        return GREY, (0.0, 0.0, 0.0), 1.0
    return found


def _solid(form: Form) -> tuple[float, ...]:
    diffuse, lobe, _ = _closure(form)
    return tuple(min(1.0, a + b) for a, b in zip(diffuse, lobe, strict=True))


def _principled(form: Form) -> principled.Inputs:
    """A mixture of a diffuse part and a metal, by their brightness."""
    diffuse, lobe, m = _closure(form)
    share = sum(lobe) / max(sum(diffuse) + sum(lobe), 1e-9)
    color = principled.rgb(_solid(form))
    return {**principled.NO_SPECULAR, "Base Color": color, "Metallic": share, "Roughness": min(1.0, m**0.5)}


MODEL = Model(
    name="measured",
    label="Measured",
    opening="Measured: ",
    parameters=(),
    kinds={"half": "", "float": "32 Bit"},
    table=MeasuredTable("", ""),
    estimators=("closure", "mirror", "direct"),
    reference=_reference,
    solid=_solid,
    principled=_principled,
    is_diffuse=True,
    mirrors=False,
)
