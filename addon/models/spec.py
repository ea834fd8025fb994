# SPDX-License-Identifier: GPL-3.0-or-later
"""The description of a model: its parameters, its form, and what each layer needs to know. Imports no bpy."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from ..reference.facet_distribution import Term

Number = float | tuple[float, float, float]


@dataclass(frozen=True)
class Scale:
    """Another number that stands for a parameter in Blender. Both ways take numbers, arrays and values of nodes."""

    to_input: Callable[[Any], Any]
    of_input: Callable[[Any], Any]


PLAIN = Scale(lambda value: value, lambda value: value)


@dataclass(frozen=True)
class Parameter:
    """A parameter of a model, for files, sockets, shaders, the panel and the command line.

    name: in files and the reference. label: of its input in Blender, as Blender's own nodes call it.
    symbol: what papers call it, and older files its input; "" if that is the label.
    scale: what the input holds in place of the parameter itself. unit: as people read it; "" if it has none.
    low, high: its range, for RGB that of each channel. native_high: the limit of Cycles' own closures.
    default: of the socket; three numbers make the parameter RGB.
    socket, subtype: Blender's, for the socket.
    optional: a file may leave it out. is_roughness: it spreads the reflected light, and its keys run in ratios.
    in_volume: a property of the body, not of its surface.
    zero_is_smooth: 0, below the range, means a smooth interface.
    example: for the message that says it is missing.
    """

    name: str
    label: str
    tip: str
    default: Number
    low: float
    high: float
    unit: str = ""
    socket: Literal["Float", "Color", "Vector"] = "Float"
    subtype: str = "NONE"
    native_high: float | None = None
    optional: bool = False
    is_roughness: bool = False
    in_volume: bool = False
    zero_is_smooth: bool = False
    example: str = ""
    symbol: str = ""
    scale: Scale = PLAIN

    @property
    def is_rgb(self) -> bool:
        return isinstance(self.default, tuple)

    def storable(self, value: Number) -> Number:
        """``value`` as an input can hold it: a smooth interface is the least roughness."""
        return max(value, self.low) if self.zero_is_smooth and isinstance(value, float) else value


class Form(Protocol):
    """The form of a preset, which models decide by: kind, flags that are true, numbers by name (of lobe k as m_k).

    distribution: of its facets, where its model needs one.
    """

    @property
    def model(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def flags(self) -> tuple[str, ...]: ...
    @property
    def parameters(self) -> Mapping[str, Any]: ...
    @property
    def distribution(self) -> tuple[Term, ...]: ...


@dataclass(frozen=True)
class Model:
    """One lighting model. What it lacks keeps its default.

    name: in files, and of its files in each layer: reference/NAME.py, nodegroups/NAME*.py, osl/NAME*.osl.
    label: in Blender. opening: how the tip of a preset begins.
    parameters: its own, in the order of its sockets; a Fresnel term's come beside them.
    kinds: the forms it has, with their labels; the first is the default. Of ``has_fresnel``: the Fresnel kinds.
    sheets: kinds that are a thin sheet, without an inside.
    flags: what is true or false of a preset; false where the file does not say.
    distribution: of a model whose presets have tables [[distribution]], one for example; () of others.
    parts: name and model of what it is made of. labels: of inputs that are called otherwise here.
    lobes: parameters of one lobe, ``lobe_model`` of it, at most so many.
    estimators: those it has, of ``estimators.ESTIMATORS``.
    reference: (form, its parts' references by name) -> the model of the reference.
    flaw: why a preset's numbers do not go together, as the rest of a line; "" if they do.
    account: (what, why) of each part of such a material, for ``vgroove explain``.
    solid: RGB at normal incidence, for viewports without shaders; None: that of its Fresnel term.
    principled: what inputs of Blender's Principled get, by their names, for exports (``principled.Inputs``); None: the
    colour at normal incidence, and the slope as roughness.
    is_diffuse: whether it has a diffuse part. mirrors: whether Mirror mirrors all of it, so that denoisers see that.
    bounces: whether light that bounces within its grooves can be added (``nodegroups.groove``).
    smooth_estimator: the estimator that is exact for m = 0 and draws nothing at random there.
    upright: estimators whose closures stand on the shading normal, beside ``estimators.UPRIGHT``.
    of_cycles: (estimator, backend) -> whether the material differs between versions of Cycles.
    most_lights: by estimator, how many lights fit on Cycles' stack if eight do not; and in Blender 4.5.
    """

    name: str
    label: str
    opening: str
    parameters: tuple[Parameter, ...]
    reference: Callable[[Form, dict[str, Any]], Any]
    kinds: Mapping[str, str] = field(default_factory=dict)
    has_fresnel: bool = False
    flags: tuple[str, ...] = ()
    distribution: tuple[Term, ...] = ()
    parts: tuple[tuple[str, str], ...] = ()
    labels: Mapping[str, str] = field(default_factory=dict)
    lobes: tuple[Parameter, ...] = ()
    lobe_model: str = ""
    most_lobes: int = 0
    estimators: tuple[str, ...] = ("fit", "closure", "corrected", "hybrid", "mirror", "direct")
    flaw: Callable[[Form], str] = lambda _form: ""
    account: Callable[[Form], Iterable[tuple[str, str]]] | None = None
    solid: Callable[[Form], tuple[float, ...]] | None = None
    principled: Callable[[Form], Mapping[str, Any]] | None = None
    transparent: bool = False
    sheets: frozenset[str] = frozenset()
    is_diffuse: bool = False
    mirrors: bool = True
    bounces: Callable[[Form], bool] = lambda _form: False
    smooth_estimator: str = ""
    upright: frozenset[str] = frozenset()
    of_cycles: Callable[[str, str], bool] = lambda _estimator, _backend: False
    most_lights: Mapping[str, int] = field(default_factory=dict)
    most_lights_4_5: Mapping[str, int] = field(default_factory=dict)

    def parameter(self, name: str) -> Parameter:
        """The parameter of this name; KeyError if the model itself has none of this name."""
        return {one.name: one for one in (*self.parameters, *self.lobes)}[name]

    @property
    def is_compound(self) -> bool:
        """Whether its group holds the groups of other models."""
        return bool(self.parts)
