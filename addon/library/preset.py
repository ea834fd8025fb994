# SPDX-License-Identifier: GPL-3.0-or-later
"""One material: a model with numbers, where they come from, and how they change. Imports no bpy."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ..models import MODELS, base_name, fresnel, parameter
from . import timeline
from .checks import PresetError, as_number, check_key

if TYPE_CHECKING:
    from ..models import Model, Number
    from ..reference import Fresnel
    from ..reference.facet_distribution import Term
    from ..reference.trajectory import Trajectory


@dataclass(frozen=True)
class Preset:
    """One material. ``parameters`` holds the model's numbers by their reference names.

    ``kind`` is the form of the model, one of its spec's ``kinds``: where it has a Fresnel term, that of the term.
    ``flags``: those of the model's flags that are true. ``distribution``: of
    its facets, where its model needs one. ``m_range``: slopes that suit the material. ``verified``: its
    reflectance head-on, "f0", by the reference. ``time``: how its numbers change, where they do; ``parameters`` are
    those at the start.
    """

    id: str
    name: str
    model: str
    kind: str
    parameters: dict[str, Number]
    source: dict[str, str]
    tags: tuple[str, ...] = ()
    notes: str = ""
    flags: tuple[str, ...] = ()
    distribution: tuple[Term, ...] = ()
    m_range: tuple[float, float] | None = None
    verified: dict[str, Number] = field(default_factory=dict)
    time: timeline.Timeline | None = None

    @property
    def family(self) -> str:
        return self.id.split("/")[0]

    @property
    def evidence(self) -> str:
        """How its colour and roughness are known, in Blender's words; "" where its file does not say."""
        colour, roughness = (self.source.get(key, "") for key in ("colour", "roughness"))
        if not colour or not roughness:
            return ""
        same = colour == roughness
        return f"Color and roughness {colour}" if same else f"Color {colour}, roughness {roughness}"

    @property
    def spec(self) -> Model:
        """What its model is."""
        return MODELS[self.model]

    @property
    def m(self) -> float:
        """RMS facet slope, of several lobes the largest; 0 for a smooth interface, and for a model that has none."""
        slopes = [v for key, v in self.parameters.items() if parameter(key).is_roughness and isinstance(v, float)]
        return max(slopes, default=0.0)

    @property
    def roughness(self) -> float:
        """Blender's Roughness, for what does not run the shader: the root of the slope, 1 for a model without one."""
        return min(1.0, self.m**0.5) if "m" in self.parameters or self.lobes else 1.0

    @property
    def solid(self) -> tuple[float, float, float]:
        """RGB at normal incidence, for what does not run the shader."""
        r, g, b = self.spec.solid(self) if self.spec.solid else map(float, self.reference_fresnel()(1.0))
        return r, g, b

    @property
    def is_smooth(self) -> bool:
        """Whether it is a plain interface, of a model that is exact there."""
        return bool(self.spec.smooth_estimator) and self.m == 0.0

    @property
    def transparent(self) -> bool:
        """Whether light goes through it."""
        return self.spec.transparent

    @property
    def is_sheet(self) -> bool:
        """Whether it is a thin sheet, without an inside."""
        return self.kind in self.spec.sheets

    @property
    def refracts(self) -> bool:
        """Whether it bends the light that goes through it: a sheet lets it straight through."""
        return self.transparent and not self.is_sheet

    @property
    def can_disperse(self) -> bool:
        """Whether it refracts by a known Abbe number."""
        return self.refracts and self.parameters.get("abbe", 0.0) != 0.0

    @property
    def can_bounce(self) -> bool:
        """Whether light that bounces within its grooves can be added."""
        return self.spec.bounces(self)

    @property
    def lobes(self) -> int:
        """How many lobes it has beside its own numbers; 0 for most models."""
        return sum(base_name(key) != key for key in self.parameters) // max(len(self.spec.lobes), 1)

    def trajectory(self) -> Trajectory:
        """How its numbers change; PresetError where they do not."""
        if self.time is None:
            message = f"preset {self.id} does not change over time"
            raise PresetError(message)
        return self.time.trajectory(self.parameters)

    def at(self, time: float) -> Preset:
        """The material as it is at a time, in the preset's own unit; times beyond its range show its ends."""
        now = {name: timeline.plain(value) for name, value in self.trajectory().at(time).items()}
        return replace(self, parameters=self.parameters | now, verified={}, m_range=None, time=None)

    def reference_fresnel(self) -> Fresnel:
        """F of the reference, for models that have one."""
        return fresnel.reference(self)

    def reference(self) -> Any:
        """The model of the reference that this preset stands for."""
        return self.spec.reference(self, {name: part.reference() for name, part in self.parts().items()})

    def parts(self) -> dict[str, Preset]:
        """What it is made of, each as a preset: the diffuse part and the specular one of a sum; {} for most models."""
        parts = {name: self._part(model, "") for name, model in self.spec.parts}
        return parts | {f"lobe {k}": self._part(self.spec.lobe_model, f"_{k}") for k in range(1, self.lobes + 1)}

    def _part(self, model: str, suffix: str) -> Preset:
        spec = MODELS[model]
        kind = self.kind if spec.has_fresnel else next(iter(spec.kinds))
        terms = fresnel.KINDS[kind].parameters if spec.has_fresnel else ()
        numbers = {one.name: self.parameters[one.name + suffix] for one in (*spec.parameters, *terms)}
        return replace(self, model=model, kind=kind, parameters=numbers, time=None)

    def with_parameters(self, /, **changes: Any) -> Preset:
        """A copy with some parameters changed; raises PresetError for an unknown name or a value out of range.

        What is given a value keeps it: it no longer changes over time.
        """
        where = f"preset {self.id}"
        for key in changes:
            check_key(where, key, self.parameters)
        checked = self.parameters | {key: as_number(where, key, value) for key, value in changes.items()}
        changed = replace(self, parameters=checked, time=self.time and self.time.without(changes))
        check_form(where, changed)
        if changed == self:
            return self
        suits = self.m_range is not None and self.m_range[0] <= changed.m <= self.m_range[1]
        return replace(changed, verified={}, m_range=self.m_range if suits else None)


def check_form(where: str, preset: Preset) -> None:
    """PresetError where numbers do not go together, at any time of a preset that changes."""
    if flaw := preset.spec.flaw(preset):
        message = f"{where}: {flaw}"
        raise PresetError(message)
    if preset.time is None:
        return
    moments = preset.time.moments
    values = preset.trajectory().at(moments)
    for index, time in enumerate(moments):
        now = {name: timeline.plain(of[index]) for name, of in values.items()}
        if flaw := preset.spec.flaw(replace(preset, parameters=preset.parameters | now)):
            message = f"{where}: at time {time:g}: {flaw}"
            raise PresetError(message)
