# SPDX-License-Identifier: GPL-3.0-or-later
"""The kinds of Fresnel term, by name, for the groups that hold one."""

from . import ensure, f82, fresnel_conductor, fresnel_dielectric, schlick
from ._tree import Tree, Value

KINDS = {"schlick": schlick, "dielectric": fresnel_dielectric, "conductor": fresnel_conductor, "f82": f82}


def interface(tree: Tree, kind: str) -> dict[str, Value]:
    """The inputs of Fresnel ``kind``: of F0, or the IOR, or n and k, or F0 and the tint at 82 degrees."""
    return KINDS[kind].interface(tree)


def reflectance(tree: Tree, kind: str, parameters: dict[str, Value], cosine: Value | float) -> Value:
    """F at ``cosine`` through the nested group of ``kind``."""
    module = KINDS[kind]
    node = tree.group(ensure(module.NAME, module.REVISION, module.build))
    for value, socket in zip([*parameters.values(), cosine], node.inputs, strict=True):
        tree.connect(value, socket)
    return Value(tree, node.outputs["F"])
