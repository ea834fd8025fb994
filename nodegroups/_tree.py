# SPDX-License-Identifier: GPL-3.0-or-later
"""A small builder through which node groups read like the equations they hold.

Sockets are wrapped in ``Value``; arithmetic on values adds Math or Vector Math nodes. Only nodes that all supported
Blenders share are used here. Comparisons are functions, because an overloaded ``==`` breaks ``in`` and sets.
"""

from __future__ import annotations

from contextlib import contextmanager
from math import e
from typing import TYPE_CHECKING, Any, TypeAlias

import bpy

from ..addon.library.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from bpy.types import Node, NodeSocket

Number: TypeAlias = "Value | float | tuple[float, float, float]"  # what arithmetic takes
OPERANDS = ("Value", "Value_001", "Value_002"), ("Vector", "Vector_001", "Vector_002")  # of Math, of Vector Math
TAKES = {"number": {"VALUE", "VECTOR", "RGBA"}, "vector": {"VECTOR", "RGBA"}, "shader": {"SHADER"}}


class NativeError(InputError):
    """One of Blender's own nodes lacks the socket that is wired here."""


class Value:
    """A socket that carries a number (``is_vector`` false) or three (vector and colour alike)."""

    __array_ufunc__ = None  # NumPy numbers must not try to spread over a socket

    def __init__(self, tree: Tree, socket: bpy.types.NodeSocket) -> None:
        self.tree, self.socket = tree, socket
        self.is_vector = socket.type in {"VECTOR", "RGBA"}

    def __add__(self, other: Number) -> Value:
        return self.tree.math("ADD", self, other)

    def __radd__(self, other: Number) -> Value:
        if isinstance(other, int) and other == 0:  # where sum() starts
            return self
        return self.tree.math("ADD", other, self)

    def __sub__(self, other: Number) -> Value:
        return self.tree.math("SUBTRACT", self, other)

    def __rsub__(self, other: Number) -> Value:
        return self.tree.math("SUBTRACT", other, self)

    def __mul__(self, other: Number) -> Value:
        return self.tree.math("MULTIPLY", self, other)

    def __rmul__(self, other: Number) -> Value:
        return self.tree.math("MULTIPLY", other, self)

    def __truediv__(self, other: Number) -> Value:
        return self.tree.math("DIVIDE", self, other)

    def __rtruediv__(self, other: Number) -> Value:
        return self.tree.math("DIVIDE", other, self)

    def __neg__(self) -> Value:
        return self * -1.0

    def __pow__(self, exponent: float) -> Value:
        """Whole powers by products, so that no logarithm rounds them, and the square root as 0.5."""
        if exponent == 0.5:
            return sqrt(self)
        if exponent == 1:
            return self
        half = self ** (exponent // 2)
        return half * half * self if exponent % 2 else half * half

    @property
    def xyz(self) -> tuple[Value, Value, Value]:
        """The three components."""
        apart = self.tree.one_node("ShaderNodeSeparateXYZ", Vector=self)
        x, y, z = (Value(self.tree, output(apart, name)) for name in "XYZ")
        return x, y, z

    @property
    def rgb(self) -> tuple[Value, Value, Value]:
        """The three components of a colour: one step in Cycles, for which ``xyz`` takes four."""
        apart = self.tree.one_node("ShaderNodeSeparateColor", Color=self)
        r, g, b = (Value(self.tree, output(apart, name)) for name in ("Red", "Green", "Blue"))
        return r, g, b


class Tree:
    """A node group under construction."""

    def __init__(self, node_tree: bpy.types.ShaderNodeTree) -> None:
        self.node_tree = node_tree
        self._frame: bpy.types.Node | None = None
        self._panel: bpy.types.NodeTreeInterfacePanel | None = None
        self._known: dict[tuple[object, ...], Node] = {}
        self._nested: dict[str, bpy.types.ShaderNodeTree] = {}
        self._input = node_tree.nodes.new("NodeGroupInput")
        self._output = node_tree.nodes.new("NodeGroupOutput")

    # Interface

    # ``held``: what is linked is held to the range, too, which a socket does for typed numbers only. It costs nothing
    # where nothing is linked, as Cycles folds constants.

    def input_float(
        self, name: str, default: float, *, low: float, high: float, tip: str, subtype: str = "NONE", held: bool = False
    ) -> Value:
        item = self._socket(name, "INPUT", "NodeSocketFloat", tip)
        item.subtype = subtype
        item.min_value, item.max_value, item.default_value = low, high, default
        return hold(self._from_input(), low, high) if held else self._from_input()

    def input_color(
        self, name: str, default: tuple[float, float, float], *, tip: str, high: float = 1.0, held: bool = False
    ) -> Value:
        item = self._socket(name, "INPUT", "NodeSocketColor", tip)
        item.default_value = (*default, 1.0)
        return hold(self._from_input(), 0.0, high) if held else self._from_input()

    def input_vector(
        self, name: str, default: tuple[float, float, float] = (0, 0, 0), *, low: float = -1e30, high: float = 1e30,
        tip: str, hide_value: bool = False, held: bool = False,
    ) -> Value:  # fmt: skip
        item = self._socket(name, "INPUT", "NodeSocketVector", tip)
        item.min_value, item.max_value, item.default_value, item.hide_value = low, high, default, hide_value
        return hold(self._from_input(), low, high) if held else self._from_input()

    def inputs_of(self, group: bpy.types.ShaderNodeTree, names: Mapping[str, str] | None = None) -> None:
        """Inputs like those of another group, panels too, but for names that there are already.

        Those that ``names`` calls otherwise go where the caller is, into a panel of its.
        """
        own = names or {}
        around, panels = self._panel, {"": None}
        known = {socket.name for socket in self._input.outputs}
        for item in group.interface.items_tree:
            if item.item_type == "PANEL":
                there = self.node_tree.interface.items_tree
                same = next((p for p in there if p.item_type == "PANEL" and p.name == item.name), None)
                panels[item.name] = same or self.node_tree.interface.new_panel(item.name, default_closed=True)
            elif item.in_out == "INPUT" and (item.name in own or item.name not in known):
                self._panel = around if item.name in own else panels[item.parent.name]
                copy = self._socket(own.get(item.name, item.name), "INPUT", item.socket_type, item.description)
                self._panel = around
                for name in ("subtype", "min_value", "max_value", "default_value", "hide_value"):
                    if hasattr(item, name):
                        setattr(copy, name, getattr(item, name))

    def input_named(self, name: str) -> Value:
        """The input made before under this name."""
        return Value(self, self._input.outputs[name])

    def output_float(self, name: str, value: Number, *, tip: str) -> None:
        self._to_output(name, "NodeSocketFloat", value, tip)

    def output_color(self, name: str, value: Number, *, tip: str) -> None:
        self._to_output(name, "NodeSocketColor", value, tip)

    def output_vector(self, name: str, value: Number, *, tip: str) -> None:
        self._to_output(name, "NodeSocketVector", value, tip)

    def output_shader(self, name: str, socket: bpy.types.NodeSocket, *, tip: str) -> None:
        self._socket(name, "OUTPUT", "NodeSocketShader", tip)
        self.node_tree.links.new(socket, self._output.inputs[-2])

    def replace_output(self, index: int, change: Callable[[NodeSocket], NodeSocket]) -> None:
        """Lead ``change`` of what an output gives to it."""
        there = self._output.inputs[index]
        self.node_tree.links.new(change(there.links[0].from_socket), there)

    @contextmanager
    def panel(self, name: str) -> Iterator[None]:
        """Inputs made inside are shown under a fold-out panel of the group node."""
        self._panel = self.node_tree.interface.new_panel(name, default_closed=True)
        yield
        self._panel = None

    def _socket(self, name: str, in_out: str, socket_type: str, tip: str) -> bpy.types.NodeTreeInterfaceSocket:
        return self.node_tree.interface.new_socket(
            name, in_out=in_out, socket_type=socket_type, description=tip, parent=self._panel
        )

    def _from_input(self) -> Value:
        return Value(self, self._input.outputs[-2])  # the last socket is Blender's empty extension socket

    def _to_output(self, name: str, socket_type: str, value: Number, tip: str) -> None:
        self._socket(name, "OUTPUT", socket_type, tip)
        self.connect(value, self._output.inputs[-2])

    # Nodes

    @contextmanager
    def frame(self, label: str) -> Iterator[None]:
        """Nodes made inside are drawn in one labelled frame, titled by the term of the equation they hold."""
        self._frame = self.node_tree.nodes.new("NodeFrame")
        self._frame.label, self._frame.label_size = label, 40
        yield
        self._frame = None

    def node(self, kind: str, **given: Any) -> Node:
        """A new node of Blender's own: ``Capitalised`` names are inputs, as of ``wire``, and others are settings."""
        node = self.node_tree.nodes.new(kind)
        node.parent = self._frame
        for name, value in given.items():
            if not name[0].isupper():
                setattr(node, name, value)
        for name, value in given.items():
            if name[0].isupper():
                self.wire(node, name, value)
        return node

    def one_node(self, kind: str, **given: Any) -> Node:
        """As ``node``, but the one that was made before of the same: a file would hold both, Cycles merges them."""
        return self._once((kind, *_named_inputs(given)), lambda: self.node(kind, **given))

    def _once(self, key: tuple[object, ...], make: Callable[[], Node]) -> Node:
        if key not in self._known:
            self._known[key] = make()
        return self._known[key]

    def wire(self, node: Node, name: str, value: Number | NodeSocket) -> None:
        """Give an input of one of Blender's own nodes a value; ``name``: its identifier, '_' for a blank.

        Names on screen and places change from one Blender to the next, identifiers hardly. Raises NativeError where
        there is no such input, or it is of a type that does not take this value.
        """
        found = _named(node.inputs, name)
        kind = _kind(value)
        if found is None or found.type not in TAKES[kind]:
            raise NativeError(_unlike(node, f"input {name.replace('_', ' ')!r} that takes a {kind}"))
        if kind == "shader":
            self.node_tree.links.new(value, found)
        else:
            self.connect(value, found)

    def nested(self, node_tree: bpy.types.ShaderNodeTree) -> Node:
        """A nested node group; nothing of it connected yet."""
        return self.node("ShaderNodeGroup", node_tree=node_tree, label=node_tree.name)

    def nested_with_inputs(self, node_tree: bpy.types.ShaderNodeTree, names: Mapping[str, str] | None = None) -> Node:
        """A nested node group, fed by the inputs made here under its inputs' names, or what ``names`` calls them."""
        node = self.nested(node_tree)
        for socket in node.inputs:
            self.connect(self.input_named((names or {}).get(socket.name, socket.name)), socket)
        return node

    def group(self, node_tree: bpy.types.ShaderNodeTree, **inputs: Number) -> Node:
        """The nested node group with inputs connected by name ('_' for a blank)."""

        def make() -> Node:
            node = self.nested(node_tree)
            for name, value in inputs.items():
                self.connect(value, node.inputs[name.replace("_", " ")])
            return node

        return self._once((node_tree.name, *_named_inputs(inputs)), make)

    def connect(self, value: Number, socket: bpy.types.NodeSocket) -> None:
        if isinstance(value, Value):
            self.node_tree.links.new(value.socket, socket)
        elif socket.type == "VECTOR" and not isinstance(value, tuple):
            socket.default_value = (value, value, value)
        elif socket.type == "RGBA":
            socket.default_value = (*value, 1.0) if isinstance(value, tuple) else (value, value, value, 1.0)
        else:
            socket.default_value = value

    def nested_value(self, name: str, revision: int, build: Callable[[Tree], None], **inputs: Number) -> Value:
        """The first output of the group ``.VGroove NAME`` for these inputs."""
        from . import ensure  # here, as it imports this module

        if name not in self._nested:
            self._nested[name] = ensure(f".VGroove {name}", revision, build)
        return Value(self, self.group(self._nested[name], **inputs).outputs[0])

    def math(self, operation: str, *operands: Number) -> Value:
        """One Math node, or one Vector Math node where an operand is a vector (numbers then count thrice)."""
        vector = any(isinstance(operand, tuple) or getattr(operand, "is_vector", False) for operand in operands)
        kind = "ShaderNodeVectorMath" if vector else "ShaderNodeMath"
        node = self.one_node(kind, operation=operation, **dict(zip(OPERANDS[vector], operands, strict=False)))
        return Value(self, output(node, OPERANDS[vector][0]))

    def add_shaders(self, sockets: list[bpy.types.NodeSocket]) -> bpy.types.NodeSocket:
        """All closures added up; an empty sum is an emission of nothing."""
        if not sockets:
            return output(self.node("ShaderNodeEmission", Color=(0.0, 0.0, 0.0)), "Emission")
        total = sockets[0]
        for socket in sockets[1:]:
            total = output(self.node("ShaderNodeAddShader", Shader=total, Shader_001=socket), "Shader")
        return total

    def weighted(self, socket: bpy.types.NodeSocket, weight: Number) -> bpy.types.NodeSocket:
        """A closure scaled by ``weight`` in 0..1: mixed with nothing."""
        return output(self.node("ShaderNodeMixShader", Fac=weight, Shader_001=socket), "Shader")

    def geometry(self, name: str) -> Value:
        """An output of the Geometry node: Position, Normal, Incoming ..."""
        frame, self._frame = self._frame, None
        # The view is wanted in nearly every group, of a node with nine outputs.
        found = self.nested_value("View", 1, _build_view) if name == "Incoming" else _geometry(self, name)
        self._frame = frame
        return found

    def fused(self, a: Number, b: Number, c: Number) -> Value:
        """a b + c in one node."""
        return self.math("MULTIPLY_ADD", a, b, c)


def _geometry(tree: Tree, name: str) -> Value:
    return Value(tree, output(tree.one_node("ShaderNodeNewGeometry"), name))


def _build_view(tree: Tree) -> None:
    tree.output_vector("Incoming", _geometry(tree, "Incoming"), tip="Unit vector to the viewer")


def _named_inputs(given: Mapping[str, Any]) -> list[tuple[str, object]]:
    """What tells equal inputs: the socket of a value, and the digits of a number, of which -0.0 has others than 0.0."""
    return [(name, value.socket if isinstance(value, Value) else repr(value)) for name, value in given.items()]


def _kind(value: Number | NodeSocket) -> str:
    if isinstance(value, Value):
        return "vector" if value.is_vector else "number"
    return "vector" if isinstance(value, tuple) else "number" if isinstance(value, float | int) else "shader"


def output(node: Node, name: str) -> NodeSocket:
    """The output of one of Blender's own nodes, by its identifier ('_' for a blank); NativeError if it has none."""
    found = _named(node.outputs, name)
    if found is None:
        raise NativeError(_unlike(node, f"output {name.replace('_', ' ')!r}"))
    return found


def _named(sockets: bpy.types.bpy_prop_collection[NodeSocket], name: str) -> NodeSocket | None:
    names = name, name.replace("_", " ")
    return next((socket for socket in sockets if socket.identifier in names), None)


def _unlike(node: Node, what: str) -> str:
    return (
        f"the node {node.bl_label} of Blender {bpy.app.version_string} has no {what}; "
        "take a Blender that vgroove is tested with, or a newer vgroove"
    )


def minimum(a: Value, b: Number) -> Value:
    return a.tree.math("MINIMUM", a, b)


def maximum(a: Value, b: Number) -> Value:
    return a.tree.math("MAXIMUM", a, b)


def clamp(a: Value) -> Value:
    """``a`` held within 0..1."""
    return hold(a, 0.0, 1.0)


def hold(a: Value, low: float, high: float) -> Value:
    """``a`` held within low..high; a number that is not one becomes ``low``."""
    if a.is_vector:
        return a.tree.nested_value("Hold", 1, _build_hold, Value=a, Low=low, High=high)
    return Value(a.tree, output(a.tree.one_node("ShaderNodeClamp", Value=a, Min=low, Max=high), "Result"))


def _build_hold(tree: Tree) -> None:
    """A group, as every color of every interface is held."""
    value, low, high = (tree.input_vector(name, tip=f"{name}, of each component") for name in ("Value", "Low", "High"))
    tree.output_vector("Value", minimum(maximum(value, low), high), tip="Within both")


def less(a: Value, b: Number) -> Value:
    """1 where a < b, else 0."""
    return a.tree.math("LESS_THAN", a, b)


def greater(a: Value, b: Number) -> Value:
    """1 where a > b, else 0."""
    return a.tree.math("GREATER_THAN", a, b)


def select(condition: Value, yes: Number, no: Number) -> Value:
    """``yes`` where the condition is 1, ``no`` where it is 0. Both must be finite."""
    tree = condition.tree
    vector = any(isinstance(v, tuple) or getattr(v, "is_vector", False) for v in (yes, no))
    kind = "Vector" if vector else "Float"
    given = {"Factor_Float": condition, f"A_{kind}": no, f"B_{kind}": yes}
    node = tree.one_node("ShaderNodeMix", data_type=kind.upper(), clamp_factor=True, **given)
    return Value(tree, output(node, f"Result_{kind}"))


def _scalar(operation: str, a: Value, *more: float) -> Value:
    """A scalar function; of a vector, of each component."""
    if a.is_vector:
        return vector(*(a.tree.math(operation, component, *more) for component in a.xyz))
    return a.tree.math(operation, a, *more)


def sqrt(a: Value) -> Value:
    """Square root, 0 below 0."""
    return _scalar("SQRT", a)


def exp(a: Value) -> Value:
    return _scalar("EXPONENT", a)


def log(a: Value) -> Value:
    """Natural logarithm, 0 for a <= 0."""
    return _scalar("LOGARITHM", a, e)


def sin(a: Value) -> Value:
    return a.tree.math("SINE", a)


def cos(a: Value) -> Value:
    return a.tree.math("COSINE", a)


def absolute(a: Value) -> Value:
    return a.tree.math("ABSOLUTE", a)


def vector(x: Number, y: Number, z: Number) -> Value:
    tree = next(v.tree for v in (x, y, z) if isinstance(v, Value))
    return Value(tree, output(tree.one_node("ShaderNodeCombineXYZ", X=x, Y=y, Z=z), "Vector"))


def dot(a: Value, b: Number) -> Value:
    node = a.tree.one_node("ShaderNodeVectorMath", operation="DOT_PRODUCT", Vector=a, Vector_001=b)
    return Value(a.tree, output(node, "Value"))


def cross(a: Value, b: Number) -> Value:
    return a.tree.math("CROSS_PRODUCT", a, b)


def scale(a: Value, factor: Value) -> Value:
    """Vector times number."""
    node = a.tree.one_node("ShaderNodeVectorMath", operation="SCALE", Vector=a, Scale=factor)
    return Value(a.tree, output(node, "Vector"))


def normalize(a: Value) -> Value:
    return a.tree.math("NORMALIZE", a)


def length(a: Value) -> Value:
    return Value(a.tree, output(a.tree.one_node("ShaderNodeVectorMath", operation="LENGTH", Vector=a), "Value"))


def tangents(n: Value) -> tuple[Value, Value]:
    """Two unit vectors at right angles to the unit vector ``n`` and to each other."""
    T = normalize(cross(n, select(less(n.xyz[2] ** 2, 0.8), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))))
    return T, cross(n, T)
