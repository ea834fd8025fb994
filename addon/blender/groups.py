# SPDX-License-Identifier: GPL-3.0-or-later
"""A preset by a choice -> its node group, from the modules of nodegroups/ that are named after the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache, partial
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import TYPE_CHECKING

from ... import nodegroups
from ...nodegroups import absorption, eevee, fit_table, groove, versions
from ..models import MODELS
from ..models.estimators import NATIVE
from .choice import Choice, MaterialError, binds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import ShaderNodeTree

    from ...nodegroups._tree import Tree
    from ..library.presets import Preset


TABLES = (fit_table.TABLE, groove.TABLE)


def module_of(model: str, estimator: str) -> ModuleType:
    """The module that builds a model's group by an estimator; of a model that is made of others it has one for all."""
    name = model if MODELS[model].is_compound else f"{model}_{estimator}"
    return import_module(f".{name}", nodegroups.__name__)


@cache
def formula_of(model: str) -> ModuleType | None:
    """The module that builds a model's formula for EEVEE's lights, if it has one."""
    name = f".{model}_eevee"
    there = versions.LIGHT_NODES and find_spec(name, nodegroups.__name__)
    return import_module(name, nodegroups.__name__) if there else None


class _Builders(Mapping[str, ModuleType]):
    """The modules of a model by estimator, each imported when it is asked for: a scene needs few of them."""

    def __init__(self, model: str) -> None:
        self.model = model

    def __getitem__(self, estimator: str) -> ModuleType:
        if estimator not in MODELS[self.model].estimators:
            raise KeyError(estimator)
        return module_of(self.model, estimator)

    def __iter__(self) -> Iterator[str]:
        return iter(MODELS[self.model].estimators)

    def __len__(self) -> int:
        return len(MODELS[self.model].estimators)


BUILDERS = {name: _Builders(name) for name in MODELS}


def group_of(preset: Preset, choice: Choice) -> ShaderNodeTree:
    """The node group of the preset's model by this choice. MaterialError if the model has none so."""
    known = BUILDERS[preset.model]
    if choice.estimator not in known:
        what = f'{preset.id} is {preset.model}, which has no estimator "{choice.estimator}"'
        message = f"{what}; use one of {', '.join(known)}"
        raise MaterialError(message)
    if choice.lamps and not binds("direct", 0.0, preset.model):
        message = f"{preset.id} is {preset.model}, which evaluates no lamps by itself; leave lamps empty"
        raise MaterialError(message)
    _restore_tables()
    module, spec = known[choice.estimator], preset.spec
    bounces = scatters(preset, choice)
    choice = replace(choice, bounces=bounces)  # for its parts too
    form = import_module(f".{preset.model}", nodegroups.__name__)
    parts = {name: group_of(part, choice) for name, part in preset.parts().items()}
    label, arguments = form.variant(preset, choice.estimator, parts) if parts else form.variant(preset)
    spreads = disperses(preset, choice)
    if spreads:
        label, arguments = f"{label} Dispersive".strip(), arguments | {"disperses": True}
    label = f"{label} Bounces" if bounces else label
    build_group = module.build_osl if choice.backend == "osl" and not (parts or spreads) else module.build
    if not (parts or spec.transparent or choice.estimator in NATIVE):
        arguments["lamps"] = len(choice.lamps)
    label = f"{module.NAME} {label}".strip()
    if choice.lamps:
        label += f", {len(choice.lamps)} lamp{'s' * (len(choice.lamps) > 1)}"
    build = partial(build_group, **arguments)
    if choice.backend == "osl" or not (choice.estimator in NATIVE or preset.is_smooth):  # whose nodes EEVEE knows
        build = partial(_with_closure, build, group_of(preset, Choice("nodes", "closure", bounces=bounces)))
    elif (formula := formula_of(preset.model)) is not None:
        name = f"{formula.NAME} {form.variant(preset)[0]}"
        shown = nodegroups.ensure(name, formula.REVISION, partial(formula.build, **arguments))
        build = partial(_with_formula, build, shown)
    if bounces:
        build = partial(_with_bounces, build, preset.kind, choice.estimator)
    return nodegroups.ensure(label + suffix(choice), module.REVISION, build)


def _restore_tables() -> None:
    """An artist may have deleted one from groups that are there already."""
    for table in TABLES:
        if table.find() is None:
            table.restore()


def scatters(preset: Preset, choice: Choice) -> bool:
    """Whether light bounces on within the grooves. ``direct`` has the formula of one bounce, and nothing else."""
    return choice.bounces and preset.can_bounce and choice.estimator != "direct"


def disperses(preset: Preset, choice: Choice) -> bool:
    """Whether a material bends each colour by itself. Of a rough one by random facets none does."""
    return (
        choice.disperses and versions.DISPERSES and preset.can_disperse
        and (preset.is_smooth or choice.estimator in NATIVE)
    )  # fmt: skip


def absorption_group() -> ShaderNodeTree:
    """The node group of what a body takes of the light that goes through it."""
    return nodegroups.ensure(absorption.NAME, absorption.REVISION, absorption.build)


def suffix(choice: Choice) -> str:
    """What names of groups say of the backend."""
    return " (OSL)" if choice.backend == "osl" else ""


def _with_bounces(build_group: Callable[[Tree], None], kind: str, estimator: str, tree: Tree) -> None:
    build_group(tree)
    groove.add_bounces(tree, kind, estimator)


def _with_closure(build_group: Callable[[Tree], None], closure: ShaderNodeTree, tree: Tree) -> None:
    build_group(tree)
    eevee.add_closure(tree, closure)


def _with_formula(build_group: Callable[[Tree], None], formula: ShaderNodeTree, tree: Tree) -> None:
    build_group(tree)
    eevee.add_formula(tree, formula)
