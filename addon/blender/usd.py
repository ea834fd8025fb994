# SPDX-License-Identifier: GPL-3.0-or-later
"""The USD Preview Surface of our materials, written by Blender's exporter's own hook for each material.

The exporter calls it in a thread that must not change the file, so a Principled as for glTF is out of the question.
What Blender's exporter does with a Principled is done here with a description of one: UsdPreviewSurface 2.6, with
images by UsdUVTexture. A network of MaterialX, which it makes of the nodes themselves, is left as it is.
"""

from __future__ import annotations

from dataclasses import replace
from math import degrees, exp
from typing import TYPE_CHECKING, Any

from . import principled
from .material import MaterialError, is_ours

if TYPE_CHECKING:
    from bpy.types import Material, Node

    from .principled import Input

NAME = "Principled_BSDF"  # as Blender calls it
PREVIEW = {
    "Base Color": "diffuseColor", "Metallic": "metallic", "Roughness": "roughness", "Coat Weight": "clearcoat",
    "Coat Roughness": "clearcoatRoughness", "Normal": "normal", "Alpha": "opacity",
    "Emission Color": "emissiveColor",
}  # fmt: skip
COLOURS = {"diffuseColor": "Color3f", "emissiveColor": "Color3f", "normal": "Normal3f"}  # by the type of each
WRAP = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "black", "MIRROR": "mirror"}
SPACES = {"sRGB": "sRGB", "Non-Color": "raw"}
CHANNELS = {"Red": "r", "Green": "g", "Blue": "b", "Alpha": "a"}


def write(context: Any, made: Material, usd_material: Any) -> bool:
    """Give ``usd_material`` a preview surface; whether it got one.

    None for materials that are not ours, and for those that have one: where a Principled of an artist is mixed in.
    """
    if not is_ours(made) or usd_material.GetSurfaceOutput().HasConnectedSource():
        return False
    try:
        inputs = principled.describe(made)
    except MaterialError:
        return False
    surface = _Surface(context, usd_material)
    for name, value in _values(made, inputs).items():
        surface.set(name, value)
    for name, of in inputs.items():
        if name in PREVIEW and of.image is not None:
            factor = _strength(inputs) if name == "Emission Color" else of.factor
            surface.link(PREVIEW[name], replace(of, factor=factor), of.image)
    return True


def _strength(inputs: dict[str, Input]) -> Any:
    """That of the emission, which a preview surface has within the colour."""
    return inputs["Emission Strength"].value if "Emission Strength" in inputs else 0.0


def _values(made: Material, inputs: dict[str, Input]) -> dict[str, Any]:
    def value(name: str, default: Any) -> Any:
        found = inputs[name].value if name in inputs else None
        return default if found is None else found

    color = value("Base Color", 0.8)
    if absorption := principled.absorption(made):  # it has no volume: the colour of what comes through
        thickness = principled.depth(made.original)
        color = tuple(one * exp(-a * thickness) for one, a in zip(color, absorption, strict=True))
    n = value("IOR", 1.5)
    r = abs((n - 1.0) / (n + 1.0)) * (2.0 * value("Specular IOR Level", 0.5)) ** 0.5  # root of what is reflected
    return {
        "emissiveColor": tuple(one * _strength(inputs) for one in value("Emission Color", (0.0, 0.0, 0.0))),
        "diffuseColor": color,
        "metallic": value("Metallic", 0.0),
        "roughness": value("Roughness", 0.5),
        "ior": (1.0 + r) / (1.0 - r),
        "clearcoat": value("Coat Weight", 0.0),
        "clearcoatRoughness": value("Coat Roughness", 0.03),
        "opacity": value("Alpha", 1.0) * (1.0 - value("Transmission Weight", 0.0)),
    }


class _Surface:
    """A preview surface being written."""

    def __init__(self, context: Any, usd_material: Any) -> None:
        from pxr import UsdShade

        self.context, self.stage, self.path = context, context.get_stage(), usd_material.GetPath()
        self.shader = self._define(NAME, "UsdPreviewSurface")
        output = UsdShade.Tokens.surface
        usd_material.CreateSurfaceOutput().ConnectToSource(self.shader.ConnectableAPI(), output)

    def _define(self, name: str, identity: str) -> Any:
        from pxr import UsdShade

        shader = UsdShade.Shader.Define(self.stage, self.path.AppendChild(name.replace(" ", "_")))
        shader.CreateIdAttr(identity)
        return shader

    def set(self, name: str, value: Any) -> None:
        """An input's number."""
        _input(self.shader, name, value)

    def link(self, name: str, of: Input, node: Node) -> None:
        """An input's image, where its coordinates are those of a UV map."""
        from pxr import Sdf

        source: Any = of.source
        coordinates = _coordinates(node)
        file = str(self.context.export_texture(node.image)) if coordinates else ""
        if not coordinates or not file:
            return
        texture = self._define(f"{name}_image", "UsdUVTexture")
        texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(file)
        space = SPACES.get(node.image.colorspace_settings.name, "auto")
        for wrap in ("wrapS", "wrapT"):
            _input(texture, wrap, WRAP[node.extension])
        _input(texture, "sourceColorSpace", space)
        factor, bias = (of.factor,) * 3, (0.0,) * 3
        if name == "normal":  # stored as (n + 1) / 2
            strength = source.node.inputs["Strength"].default_value if "Strength" in source.node.inputs else 1.0
            factor, bias = (2.0 * strength, 2.0 * strength, 2.0), (-strength, -strength, -1.0)
        if factor != (1.0,) * 3 or any(bias):
            _input(texture, "scale", (*factor, 1.0))
            _input(texture, "bias", (*bias, 0.0))
        channel = "rgb" if name in COLOURS else CHANNELS.get(source.name, "r")
        self._read(texture, name, *coordinates)
        self._connect(self.shader, name, texture, channel)

    def _read(self, texture: Any, name: str, uv: str, mapping: Node | None) -> None:
        """Have an image read a UV map, through a Mapping node where there is one."""
        reader = self._define(f"{name}_uv", "UsdPrimvarReader_float2")
        _input(reader, "varname", self._primvar(uv))
        if mapping is not None:
            turned = self._define(f"{name}_mapping", "UsdTransform2d")
            _input(turned, "rotation", degrees(mapping.inputs["Rotation"].default_value[2]))
            for to, of in (("scale", "Scale"), ("translation", "Location")):
                _input(turned, to, tuple(mapping.inputs[of].default_value[:2]))
            self._connect(turned, "in", reader, "result")
            reader = turned
        self._connect(texture, "st", reader, "result")

    def _primvar(self, uv: str) -> str:
        """The name that a UV map has got: Blender may rename the active one to "st"."""
        from pxr import UsdGeom

        names = {one.GetPrimvarName() for prim in self.stage.Traverse()
                 for one in UsdGeom.PrimvarsAPI(prim).GetPrimvars()}  # fmt: skip
        return uv if uv in names else "st"

    @staticmethod
    def _connect(to: Any, name: str, source: Any, output: str) -> None:
        from pxr import Sdf

        types = Sdf.ValueTypeNames
        kinds = {"rgb": types.Float3, "result": types.Float2}
        wanted = {**COLOURS, "st": "Float2", "in": "Float2"}
        source.CreateOutput(output, kinds.get(output, types.Float))
        to.CreateInput(name, getattr(types, wanted.get(name, "Float"))).ConnectToSource(source.ConnectableAPI(), output)


def _input(shader: Any, name: str, value: Any) -> None:
    """An input of a shader, whose type follows from the value."""
    from pxr import Gf, Sdf

    types = Sdf.ValueTypeNames
    if isinstance(value, str):
        kind = types.String if name == "varname" else types.Token
    elif isinstance(value, tuple):
        kind = {2: types.Float2, 3: types.Color3f, 4: types.Float4}[len(value)]
        value = {2: Gf.Vec2f, 3: Gf.Vec3f, 4: Gf.Vec4f}[len(value)](*value)
    else:
        kind, value = types.Float, float(value)
    shader.CreateInput(name, kind).Set(value)


def _coordinates(image: Node) -> tuple[str, Node | None] | None:
    """The UV map that an image is placed by, "" for the active one, and a Mapping node; None for other coordinates."""
    link, mapping = next(iter(image.inputs["Vector"].links), None), None
    if link is not None and link.from_node.bl_idname == "ShaderNodeMapping":
        mapping = link.from_node
        link = next(iter(mapping.inputs["Vector"].links), None)
    if link is None:
        return ("", None) if mapping is None else None
    if link.from_node.bl_idname == "ShaderNodeUVMap":
        return link.from_node.uv_map, mapping
    return ("", mapping) if link.from_socket.name == "UV" else None
