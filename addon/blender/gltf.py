# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's glTF exporter makes of our materials: while it runs, each holds a Principled that renders nothing.

It could stay there for good: mixed in by a constant 0, it takes Cycles no time and changes no pixel (5.2: copper and
plastic, Fit and Mirror). But then nothing would keep its numbers up to date, as no link or driver turns n and k into a
colour, and artists would find nodes that do nothing. The exporter calls the hooks below, so the numbers are those of
the moment, and its own code does the rest: images, UV maps, one map for roughness and metallic.
"""

from __future__ import annotations

from math import exp
from typing import TYPE_CHECKING, Any

import bpy

from . import principled, roles
from .material import MaterialError, is_ours

if TYPE_CHECKING:
    from bpy.types import Material, Node, NodeSocket

IOR, SPECULAR, VOLUME = "KHR_materials_ior", "KHR_materials_specular", "KHR_materials_volume"
EMISSIVE = "KHR_materials_emissive_strength"
WAS_ACTIVE = "was_active"  # custom property: the outputs that were active before


class Hooks:
    """Called by the exporter, by the names of its methods."""

    def pre_export_hook(self, _settings: dict[str, Any]) -> None:
        """Before it reads anything."""
        for made in _ours():
            put_in(made)

    def gather_material_hook(self, written: Any, made: Material, _settings: dict[str, Any]) -> None:
        """What the exporter leaves out: an IOR without transmission, what a body absorbs; not a computed emission."""
        from io_scene_gltf2.io.com.gltf2_io_extensions import Extension

        made = made.original
        if not is_ours(made) or not roles.nodes(made, roles.EXPORT):
            return
        inputs, absorption = principled.describe(made), principled.absorption(made)
        glow = inputs.get("Emission Color")
        if glow is not None and glow.source is not None and glow.image is None:  # the exporter makes it white
            written.emissive_factor = None
            written.extensions.pop(EMISSIVE, None)
        if "IOR" in inputs and "Transmission Weight" not in inputs:
            known = written.extensions.get(SPECULAR)
            if known is None or not known.extension:  # the exporter takes an IOR out again that stands alone
                written.extensions[SPECULAR] = Extension(SPECULAR, {"specularFactor": 1.0}, required=False)
            written.extensions[IOR] = Extension(IOR, {"ior": inputs["IOR"].value}, required=False)
        thickness = principled.depth(made, local=True) if absorption else 0.0
        if thickness > 0.0:
            most = max(absorption)
            color = [exp(-one / most) for one in absorption]  # what is left after the distance 1 / most
            of = {"thicknessFactor": thickness, "attenuationDistance": 1.0 / most, "attenuationColor": color}
            written.extensions[VOLUME] = Extension(VOLUME, of, required=False)
            written.double_sided = None  # it has an inside

    def post_export_hook(self, _settings: dict[str, Any]) -> None:
        """After the file is written; not called where the exporter fails, so ``put_in`` takes out first."""
        for made in _ours():
            take_out(made)


def _ours() -> list[Material]:
    return [one for one in bpy.data.materials if is_ours(one)]


def put_in(made: Material) -> None:
    """Add a Principled that the exporter finds and no renderer shows."""
    take_out(made)
    try:
        inputs = principled.describe(made)
    except MaterialError:  # numbers that no material has: it is exported as one without Principled
        return
    tree = made.node_tree
    nodes = principled.add_node(tree, inputs, {name for name, of in inputs.items() if of.image})
    output = tree.get_output_node("ALL")
    if output is None:  # Cycles and EEVEE have one each, which they take first
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(nodes[0].outputs[0], output.inputs["Surface"])
        nodes.append(output)
    else:
        nodes.append(_mix(nodes[0].outputs[0], output))
    for node in nodes:
        node[roles.KEY] = roles.EXPORT
    if not output.is_active_output:  # the exporter looks at no other
        nodes[0][WAS_ACTIVE] = [node.name for node in tree.nodes if getattr(node, "is_active_output", False)]
        output.is_active_output = True
    made.update_tag()  # the exporter reads evaluated materials, and Blender sees no change in what it shows


def _mix(shader: NodeSocket, output: Node) -> Node:
    """What ``output`` shows, mixed with nothing of ``shader``."""
    tree, surface = output.id_data, output.inputs["Surface"]
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 0.0
    for link in surface.links:
        tree.links.new(link.from_socket, mix.inputs[1])
    tree.links.new(shader, mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)
    return mix


def take_out(made: Material) -> None:
    """Remove what ``put_in`` added."""
    tree = made.node_tree
    for node in roles.nodes(made, roles.EXPORT):
        for name in node.get(WAS_ACTIVE, ()):
            tree.nodes[name].is_active_output = True
        if node.bl_idname == "ShaderNodeMixShader":
            for source in [link.from_socket for link in node.inputs[1].links]:
                for target in [link.to_socket for link in node.outputs[0].links]:
                    tree.links.new(source, target)
    for node in roles.nodes(made, roles.EXPORT):
        tree.nodes.remove(node)
