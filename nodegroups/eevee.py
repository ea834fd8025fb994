# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows of a material whose nodes it cannot run: ``closure``, fed by the same inputs.

EEVEE has no random facets, no shadow rays from shaders and no OSL. Native closures it shows as they are: those of
``fit`` nearer to Cycles than ``closure``. Cycles drops what only this output needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import bpy

    from ._tree import Tree

OUTPUT = "EEVEE"


def add_closure(tree: Tree, closure: bpy.types.ShaderNodeTree) -> None:
    """A second output: the group ``closure``, its inputs linked to those of the same name."""
    with tree.frame("What EEVEE shows: Cycles' own closure"):
        node = tree.nested_with_inputs(closure)
    tree.output_shader(OUTPUT, node.outputs[0], tip="To a Material Output for EEVEE")
