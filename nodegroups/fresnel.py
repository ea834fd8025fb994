# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of Fresnel term, by name, for the groups that hold one."""

from ..addon.models.fresnel import KINDS as MODELS
from . import ensure, f82, fresnel_conductor, fresnel_dielectric, schlick
from ._tree import Tree, Value
from .parameters import add_input

KINDS = {"schlick": schlick, "dielectric": fresnel_dielectric, "conductor": fresnel_conductor, "f82": f82}


def interface(tree: Tree, kind: str) -> dict[str, Value]:
    """The inputs of Fresnel ``kind``: of F0, or the IOR, or n and k, or F0 and the tint at 82 degrees."""
    return KINDS[kind].interface(tree)


def held(tree: Tree, kind: str) -> dict[str, Value]:
    """The same of a nested group, whose user has held them to their ranges."""
    return {one.name: add_input(tree, one, held=False) for one in MODELS[kind].parameters}


def nested(parameters: dict[str, Value], kind: str) -> dict[str, Value]:
    """By the names of ``held``'s inputs."""
    return {one.label: parameters[one.name] for one in MODELS[kind].parameters}


def reflectance(tree: Tree, kind: str, parameters: dict[str, Value], cosine: Value | float) -> Value:
    """F at ``cosine`` through the nested group of ``kind``."""
    module = KINDS[kind]
    group = ensure(module.NAME, module.REVISION, module.build)
    node = tree.group(group, **nested(parameters, kind), Cosine=cosine)
    return Value(tree, node.outputs["F"])
