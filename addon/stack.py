# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of Cycles' stack a material needs. A shader that needs more than there is renders black, without an error.

SVM keeps every number that a later node reads on a stack of ``SIZE`` floats. What is computed here is what Cycles does
before it renders (scene/shader_graph.cpp, scene/svm.cpp): groups are taken apart, constants folded, equal nodes merged,
closures given their weights; then nodes run as soon as their inputs are there, in the order in which they were made,
and their outputs lie in the first gap that is wide enough until the last reader is done.

Never too little in what tests render, and within 15 % above where up to one lamp is bound. What drivers and keys set
may be any number here, so nothing is folded that hangs on it: of eight bound lamps that is about a third too much.
Surfaces alone; of a Bump node's three evaluations one is counted.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan, cos, exp, log, sin, sqrt
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from bpy.types import Material, Node, NodeSocket, ShaderNodeTree

SIZE = 255  # Cycles' own SVM_STACK_SIZE
SPARE = 4  # floats, for what is left out here; measured on 5.2, it was short by one at most
WIDTHS = {"VALUE": 1, "INT": 1, "BOOLEAN": 1, "VECTOR": 3, "RGBA": 3, "SHADER": 0}
COMBINED = {"ShaderNodeMixShader", "ShaderNodeAddShader"}
CONSTANTS = {"ShaderNodeValue", "ShaderNodeRGB"}
THREE = (0.0, 0.0, 0.0)


@dataclass(eq=False)
class _Output:
    node: _Node
    name: str
    kind: str
    readers: list[_Input] = field(default_factory=list)
    place: _Place | None = None


@dataclass(eq=False)
class _Input:
    node: _Node
    name: str
    kind: str
    value: Any = None
    link: _Output | None = None
    folded: bool = False  # to a constant, which a closure then reads from the stack


@dataclass(eq=False)
class _Place:
    """Floats on the stack from ``start``; several outputs share one where a conversion does nothing."""

    start: int
    width: int
    users: int = 1


@dataclass(eq=False)
class _Node:
    number: int
    kind: str
    form: str = ""
    inputs: list[_Input] = field(default_factory=list)
    outputs: list[_Output] = field(default_factory=list)

    def input(self, name: str) -> _Input | None:
        return next((one for one in self.inputs if one.name == name), None)


def stack_need(material: Material) -> int:
    """How many floats of the stack the material's surface needs at once."""
    graph = _Graph()
    last = graph.flatten(material.node_tree)
    if last is None or last.link is None:
        return 0
    graph.simplify()
    if last.link is None:
        return 0
    graph.prune(last.link.node)
    graph.add_weights(last.link.node, None)
    return _Compiler().run(last.link.node) + SPARE


# What Cycles makes of a node tree


class _Graph:
    def __init__(self) -> None:
        self.nodes: list[_Node] = []
        self.geometry: dict[str, _Output] = {}
        self.moving: set[tuple[Any, str]] = set()  # trees and paths of inputs that drivers or keys set

    def new(self, kind: str, inputs: Iterable[tuple[str, str, Any]], outputs: Iterable[tuple[str, str]]) -> _Node:
        node = _Node(len(self.nodes), kind)
        node.inputs = [_Input(node, name, of, value) for name, of, value in inputs]
        node.outputs = [_Output(node, name, of) for name, of in outputs]
        self.nodes.append(node)
        return node

    def connect(self, source: _Output, target: _Input) -> None:
        if source.kind != target.kind and "SHADER" not in {source.kind, target.kind}:
            between = self.new("convert", [("in", source.kind, None)], [("out", target.kind)])
            self.connect(source, between.inputs[0])
            source = between.outputs[0]
        target.link = source
        source.readers.append(target)

    def flatten(  # noqa: C901 - one branch a kind of node
        self, tree: ShaderNodeTree, outer: dict[str, _Node] | None = None,
                results: dict[str, _Node] | None = None) -> _Input | None:  # fmt: skip
        """Add the nodes of a tree and of the groups in it; the input Surface of the output that Cycles renders."""
        inputs: dict[NodeSocket, _Input] = {}
        outputs: dict[NodeSocket, _Output] = {}
        self.moving |= {(tree, path) for path in _moved_by(tree)}
        rendered = tree.get_output_node("CYCLES") if outer is None else None
        surface = None
        for node in tree.nodes:
            if node.bl_idname == "NodeReroute" or node.mute:
                for link in node.internal_links:
                    made = self._proxy(link.to_socket)
                    inputs[link.from_socket], outputs[link.to_socket] = made.inputs[0], made.outputs[0]
            elif node.bl_idname == "ShaderNodeGroup":
                into = {one.identifier: self._proxy(one) for one in node.inputs if one.type in WIDTHS}
                out = {one.identifier: self._proxy(one) for one in node.outputs if one.type in WIDTHS}
                inputs |= {one: into[one.identifier].inputs[0] for one in node.inputs if one.type in WIDTHS}
                outputs |= {one: out[one.identifier].outputs[0] for one in node.outputs if one.type in WIDTHS}
                if node.node_tree is not None:
                    self.flatten(node.node_tree, into, out)
            elif node.bl_idname == "NodeGroupInput" and outer is not None:
                outputs |= {one: outer[one.identifier].outputs[0] for one in node.outputs if one.identifier in outer}
            elif node.bl_idname == "NodeGroupOutput" and results is not None:
                inputs |= {one: results[one.identifier].inputs[0] for one in node.inputs if one.identifier in results}
            elif node.bl_idname == "ShaderNodeOutputMaterial":
                if node == rendered:
                    made = self.new("output", [("Surface", "SHADER", None)], [])
                    surface = inputs[node.inputs["Surface"]] = made.inputs[0]
            elif node.bl_idname != "NodeFrame":
                self._plain(node, inputs, outputs)
        for link in tree.links:
            if link.from_socket in outputs and link.to_socket in inputs:
                self.connect(outputs[link.from_socket], inputs[link.to_socket])
        return surface

    def _value(self, socket: NodeSocket) -> Any:
        """An input's own value; of one that moves, none that anything else has, as it may be any."""
        value = _value(socket)
        if (
            value is None
            or not self.moving
            or (socket.id_data, socket.path_from_id("default_value")) not in self.moving
        ):
            return value
        unlike = 0.37 + 1e-3 * len(self.nodes)
        return (unlike, unlike + 0.1, unlike + 0.2) if isinstance(value, tuple) else unlike

    def _proxy(self, socket: NodeSocket) -> _Node:
        return self.new("proxy", [("in", socket.type, self._value(socket))], [("out", socket.type)])

    def _plain(self, node: Node, inputs: dict[NodeSocket, _Input], outputs: dict[NodeSocket, _Output]) -> None:
        shown = [one for one in node.inputs if one.enabled and one.type in WIDTHS]
        made = self.new(
            node.bl_idname, ((one.identifier, one.type, self._value(one)) for one in shown),
            ((one.identifier, one.type) for one in node.outputs if one.enabled and one.type in WIDTHS),
        )  # fmt: skip
        if made.kind in {"ShaderNodeMath", "ShaderNodeVectorMath"}:
            made.form = node.operation
        else:
            settings = ("operation", "data_type", "distribution", "fresnel_type", "attribute_name", "noise_dimensions")
            made.form = " ".join(str(getattr(node, name, "")) for name in settings)
        if made.kind in CONSTANTS:
            made.outputs[0].node.inputs = [_Input(made, "value", made.outputs[0].kind, _value(node.outputs[0]))]
        inputs |= dict(zip(shown, made.inputs, strict=False))
        outputs |= dict(
            zip((one for one in node.outputs if one.enabled and one.type in WIDTHS), made.outputs, strict=True)
        )

    # Simplification

    def simplify(self) -> None:
        for node in self.nodes:
            if node.kind == "proxy":
                self._skip(node.outputs[0], node.inputs[0])
        self._default_inputs()
        ordered = self._in_order()
        for node in ordered:
            if all(one.link is None for one in node.inputs) and node.kind in _FOLDED:
                values = [one.value for one in node.inputs]
                for output in node.outputs:
                    self._replace(output, _FOLDED[node.kind](node.form, output, values))
            else:
                self._fold_partly(node)
        self._merge(ordered)

    def _default_inputs(self) -> None:
        """Closures read the surface's normal and tangent where nothing is linked."""
        for node in list(self.nodes):
            for one in node.inputs:
                if one.link is None and one.name in {"Normal", "Tangent"} and _is_closure(node):
                    if one.name not in self.geometry:
                        made = self.new("ShaderNodeNewGeometry", [], [(one.name, "VECTOR")])
                        self.geometry[one.name] = made.outputs[0]
                    self.connect(self.geometry[one.name], one)

    def _in_order(self) -> list[_Node]:
        """From nodes without links on, each after what it reads, as they become ready."""
        waiting = {
            node: sum(one.link is not None for one in node.inputs) for node in self.nodes if node.kind != "proxy"
        }
        queue = [node for node, count in waiting.items() if count == 0]
        for node in queue:
            for output in node.outputs:
                for reader in output.readers:
                    waiting[reader.node] -= 1
                    if waiting[reader.node] == 0:
                        queue.append(reader.node)
        return queue

    def _skip(self, output: _Output, by: _Input) -> None:
        """What read ``output`` reads what ``by`` does."""
        if by.link is None:
            self._replace(output, by.value)
            return
        by.link.readers.remove(by)
        for reader in output.readers:
            reader.link = by.link
            by.link.readers.append(reader)
        output.readers, by.link = [], None

    def _pass(self, node: _Node, output: _Output, by: _Input) -> None:
        """As ``_skip``, for a node whose other inputs are no longer read."""
        self._skip(output, by)
        for one in node.inputs:
            if one.link is not None:
                one.link.readers.remove(one)
                one.link = None

    def _replace(self, output: _Output, value: Any) -> None:
        for reader in output.readers:
            reader.link, reader.value, reader.folded = None, _as(reader.kind, value), True
        output.readers = []

    def _fold_partly(self, node: _Node) -> None:  # noqa: C901 - one branch a kind of node
        if node.kind == "ShaderNodeMix":
            factor = node.inputs[0]
            if factor.link is None and factor.value in {0.0, 1.0}:
                self._pass(node, node.outputs[0], node.inputs[1 if factor.value == 0.0 else 2])
        elif node.kind == "ShaderNodeMixShader":
            factor = node.inputs[0]
            if factor.link is None and (factor.value <= 0.0 or factor.value >= 1.0):
                self._pass(node, node.outputs[0], node.inputs[1 if factor.value <= 0.0 else 2])
        elif node.kind == "ShaderNodeAddShader":
            for one, other in (node.inputs, node.inputs[::-1]):
                if one.link is None and node.outputs[0].readers:
                    self._pass(node, node.outputs[0], other)
        elif node.kind in {"ShaderNodeMath", "ShaderNodeVectorMath"}:
            self._fold_math(node)
        elif node.kind == "ShaderNodeEmission":
            color, strength = node.inputs[:2]
            if (color.link is None and not any(color.value)) or (strength.link is None and strength.value == 0.0):
                self._replace(node.outputs[0], None)
        elif node.kind == "convert":
            before = node.inputs[0].link
            assert before is not None  # noqa: S101 - else it was folded
            back = before.node
            if back.kind == "convert" and back.inputs[0].kind == node.outputs[0].kind and before.kind != "VALUE":
                self._skip_to(node, back)

    def _skip_to(self, node: _Node, back: _Node) -> None:
        source = back.inputs[0].link
        if source is None:
            return
        for reader in node.outputs[0].readers:
            reader.link = source
            source.readers.append(reader)
        node.outputs[0].readers = []
        link = node.inputs[0].link
        if link is not None:
            link.readers.remove(node.inputs[0])
            node.inputs[0].link = None

    def _fold_math(self, node: _Node) -> None:
        """x + 0, x - 0, x * 1, x / 1 are x; x * 0, 0 / x, x . 0 and x cross 0 are 0."""
        a, b = node.inputs[:2] if len(node.inputs) > 1 else (node.inputs[0], node.inputs[0])
        output = next((one for one in node.outputs if one.readers), None)
        if output is None:
            return

        def is_all(one: _Input, value: float) -> bool:
            return one.link is None and all(part == value for part in _parts(one.value))

        if node.form in {"ADD", "SUBTRACT"} and is_all(b, 0.0):
            self._pass(node, output, a)
        elif node.form == "ADD" and is_all(a, 0.0):
            self._pass(node, output, b)
        elif node.form in {"MULTIPLY", "DIVIDE"} and is_all(b, 1.0):
            self._pass(node, output, a)
        elif node.form == "MULTIPLY" and is_all(a, 1.0):
            self._pass(node, output, b)
        elif (node.form in {"MULTIPLY", "DIVIDE", "DOT_PRODUCT", "CROSS_PRODUCT"} and is_all(a, 0.0)) or (
            node.form in {"MULTIPLY", "DOT_PRODUCT", "CROSS_PRODUCT"} and is_all(b, 0.0)
        ):
            self._drop(node, output)

    def _drop(self, node: _Node, output: _Output) -> None:
        self._replace(output, 0.0)
        for one in node.inputs:
            if one.link is not None:
                one.link.readers.remove(one)
                one.link = None

    def _merge(self, ordered: list[_Node]) -> None:
        """Nodes that do the same with the same are one: the first that Cycles comes to."""
        known: dict[Any, _Node] = {}
        for node in ordered:
            if node.kind == "output" or not node.outputs:
                continue
            key = (node.kind, node.form, *((id(one.link) if one.link else str(one.value)) for one in node.inputs),
                   *(f"{one.name} {one.kind}" for one in node.outputs if node.kind == "convert"))  # fmt: skip
            first = known.setdefault(key, node)
            if first is node:
                continue
            names = {one.name: one for one in first.outputs}
            for output in node.outputs:
                if output.name not in names:
                    names[output.name] = _Output(first, output.name, output.kind)
                    first.outputs.append(names[output.name])
                for reader in output.readers:
                    reader.link = names[output.name]
                    names[output.name].readers.append(reader)
                output.readers = []
            for one in node.inputs:
                if one.link is not None:
                    one.link.readers.remove(one)
                    one.link = None

    def prune(self, root: _Node) -> None:
        """Nothing waits for nodes that the surface does not need, as those that only EEVEE shows."""
        needed, waiting = {root}, [root]
        while waiting:
            for one in waiting.pop().inputs:
                if one.link is not None and one.link.node not in needed:
                    needed.add(one.link.node)
                    waiting.append(one.link.node)
        for node in needed:
            for output in node.outputs:
                output.readers = [one for one in output.readers if one.node in needed]

    # Weights

    def add_weights(self, node: _Node, weight: _Output | None) -> None:  # noqa: C901 - as Cycles does it
        """Each closure's weight is the product of the factors on the way to it."""
        if node.kind in COMBINED:
            first, second = node.inputs[-2:]
            weights = (weight, weight)
            if node.kind == "ShaderNodeMixShader":
                made = self.new("weights", [("Fac", "VALUE", node.inputs[0].value), ("Weight", "VALUE", 1.0)],
                                [("Weight1", "VALUE"), ("Weight2", "VALUE")])  # fmt: skip
                if node.inputs[0].link is not None:
                    self.connect(node.inputs[0].link, made.inputs[0])
                if weight is not None:
                    self.connect(weight, made.inputs[1])
                weights = (made.outputs[0], made.outputs[1])
            for one, of in zip((first, second), weights, strict=True):
                if one.link is not None:
                    self.add_weights(one.link.node, of)
            return
        own = node.input("weight")
        if own is None:
            own = _Input(node, "weight", "VALUE")
            node.inputs.append(own)
            if weight is not None:
                self.connect(weight, own)
            return
        added = self.new(
            "ShaderNodeMath", [("a", "VALUE", 1.0), ("b", "VALUE", 1.0), ("c", "VALUE", 0.0)], [("", "VALUE")]
        )
        if own.link is not None:
            own.link.readers.remove(own)
            self.connect(own.link, added.inputs[0])
        if weight is not None:
            self.connect(weight, added.inputs[1])
        self.connect(added.outputs[0], own)


def _moved_by(tree: ShaderNodeTree) -> set[str]:
    """The paths of what drivers and F-curves set in a tree."""
    data = tree.animation_data
    if data is None:
        return set()
    paths = {curve.data_path for curve in data.drivers}
    if data.action is not None:
        bags = [bag for layer in data.action.layers for strip in layer.strips for bag in strip.channelbags]
        paths |= {curve.data_path for bag in bags for curve in bag.fcurves}
    return paths


def _is_closure(node: _Node) -> bool:
    return any(one.kind == "SHADER" for one in node.outputs) and node.kind not in COMBINED


def _value(socket: NodeSocket) -> Any:
    value = getattr(socket, "default_value", None)
    if value is None or isinstance(value, (int, float)):
        return value
    return tuple(value)[:3] if hasattr(value, "__len__") and not isinstance(value, str) else value


def _parts(value: Any) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)


def _as(kind: str, value: Any) -> Any:
    if value is None:
        return None
    if WIDTHS[kind] == 3:
        return value if isinstance(value, tuple) else (value,) * 3
    return sum(value) / 3.0 if isinstance(value, tuple) else value


# Constants: to fold what depends on nothing; a value that a later fold asks for is 0 or 1 exactly


def _math(form: str, output: _Output, values: list[Any]) -> Any:
    columns = [[_parts(_as(output.kind if one is not None else "VALUE", one)) for one in values if one is not None]]
    rows = list(zip(*columns[0], strict=False))
    if form in {"DOT_PRODUCT", "LENGTH", "NORMALIZE", "CROSS_PRODUCT", "SCALE", "DISTANCE"}:
        return _vector(form, [one for one in values if one is not None])
    computed = tuple(_scalar(form, *row) for row in rows)
    return computed if WIDTHS[output.kind] == 3 else computed[0]


def _vector(form: str, values: list[Any]) -> Any:
    a = _as("VECTOR", values[0])
    b = _as("VECTOR", values[1]) if len(values) > 1 else THREE
    if form == "DOT_PRODUCT":
        return sum(x * y for x, y in zip(a, b, strict=True))
    size = sqrt(sum(x * x for x in a))
    if form == "LENGTH":
        return size
    if form == "NORMALIZE":
        return tuple(x / size for x in a) if size else THREE
    if form == "SCALE":
        return tuple(x * _as("VALUE", values[-1]) for x in a)
    if form == "DISTANCE":
        return sqrt(sum((x - y) ** 2 for x, y in zip(a, b, strict=True)))
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


_SCALAR: dict[str, Callable[..., float]] = {
    "ADD": lambda a, b, *_: a + b,
    "SUBTRACT": lambda a, b, *_: a - b,
    "MULTIPLY": lambda a, b, *_: a * b,
    "DIVIDE": lambda a, b, *_: a / b if b else 0.0,
    "MULTIPLY_ADD": lambda a, b, c, *_: a * b + c,
    "MINIMUM": lambda a, b, *_: min(a, b),
    "MAXIMUM": lambda a, b, *_: max(a, b),
    "LESS_THAN": lambda a, b, *_: float(a < b),
    "GREATER_THAN": lambda a, b, *_: float(a > b),
    "SQRT": lambda a, *_: sqrt(max(a, 0.0)),
    "EXPONENT": lambda a, *_: exp(min(a, 80.0)),
    "LOGARITHM": lambda a, b, *_: log(a) / log(b) if a > 0 and b > 0 and b != 1 else 0.0,
    "ABSOLUTE": lambda a, *_: abs(a),
    "SINE": lambda a, *_: sin(a),
    "COSINE": lambda a, *_: cos(a),
    "ARCTANGENT": lambda a, *_: atan(a),
    "POWER": lambda a, b, *_: a**b if a > 0 else 0.0,
}


def _scalar(form: str, *values: float) -> float:
    return _SCALAR[form](*values) if form in _SCALAR else 0.5  # of no form that a group of ours asks the result of


def _mix(_form: str, _output: _Output, values: list[Any]) -> Any:
    factor, a, b = values[:3]
    factor = min(max(_as("VALUE", factor), 0.0), 1.0)
    mixed = tuple(x + (y - x) * factor for x, y in zip(_parts(a), _parts(b), strict=True))
    return mixed if isinstance(a, tuple) else mixed[0]


_FOLDED: dict[str, Callable[[str, _Output, list[Any]], Any]] = {
    "ShaderNodeMath": _math,
    "ShaderNodeVectorMath": _math,
    "ShaderNodeMix": _mix,
    "ShaderNodeCombineXYZ": lambda _f, _o, values: tuple(values),
    "ShaderNodeSeparateXYZ": lambda _f, output, values: values[0]["XYZ".index(output.name)],
    "ShaderNodeValue": lambda _f, _o, values: values[0],
    "ShaderNodeRGB": lambda _f, _o, values: values[0],
    "convert": lambda _f, output, values: _as(output.kind, values[0]),
}


# What Cycles compiles


class _Compiler:
    def __init__(self) -> None:
        self.used: list[int] = []  # how many hold each float
        self.most = 0
        self.done: set[_Node] = set()
        self.closures: set[_Node] = set()

    def run(self, root: _Node) -> int:
        self._closures_of(root, root)
        return self.most

    # Nodes

    def _depend(self, one: _Input, found: dict[_Node, None], skip: _Node | None = None) -> None:
        """What has to run before ``one`` can be read, and has not."""
        waiting = [one]
        while waiting:
            link = waiting.pop().link
            if link is None or link.node in self.done or link.node in found or link.node is skip:
                continue
            found[link.node] = None
            waiting += link.node.inputs

    def _run_all(self, nodes: Iterable[_Node]) -> None:
        left = sorted((node for node in nodes if node not in self.done), key=lambda node: node.number)
        while left:
            later = []
            for node in left:
                if all(one.link is None or one.link.node in self.done for one in node.inputs):
                    self._generate(node)
                    self.done.add(node)
                else:
                    later.append(node)
            if len(later) == len(left):
                return  # waits for a closure
            left = later

    def _generate(self, node: _Node) -> None:
        if node.kind == "convert" and node.inputs[0].link is not None and node.inputs[0].kind != "VALUE" and (
            node.outputs[0].kind != "VALUE"
        ):  # fmt: skip
            place = node.inputs[0].link.place
            if place is not None:
                node.outputs[0].place = place
                place.users += 1
            temporary = []
        else:
            temporary = [self._take(WIDTHS[one.kind]) for one in self._read_from_stack(node)]
            for output in node.outputs:
                if output.readers and WIDTHS[output.kind]:
                    output.place = self._take(WIDTHS[output.kind])
        for link in dict.fromkeys(one.link for one in node.inputs if one.link is not None):
            if link.place is not None and all(one.node is node or one.node in self.done for one in link.readers):
                self._free(link.place)
                link.place = None
        for place in temporary:
            self._free(place)

    def _read_from_stack(self, node: _Node) -> list[_Input]:
        """Constants that a node reads from the stack, for as long as it runs."""
        plain = [one for one in node.inputs if one.link is None and WIDTHS[one.kind]]
        if node.kind in CONSTANTS:
            return []
        if node.kind == "ShaderNodeMath":
            return plain + [_Input(node, "", "VALUE")] * (3 - len(node.inputs))
        if node.kind == "ShaderNodeVectorMath":  # three vectors and a factor, whatever the operation reads
            vectors = sum(one.kind == "VECTOR" for one in node.inputs)
            unread = [_Input(node, "", "VECTOR")] * (3 - vectors) + [_Input(node, "", "VALUE")] * (
                vectors == len(node.inputs)
            )
            return plain + unread
        if _is_closure(node):  # other constants are part of its own code
            return [one for one in plain if one.folded]
        return plain

    def _take(self, width: int) -> _Place:
        free, start = 0, len(self.used)
        for index, users in enumerate(self.used):
            free = 0 if users else free + 1
            if free == width:
                start = index + 1 - width
                break
        else:
            start = len(self.used) - free
        self.used += [0] * (start + width - len(self.used))
        for index in range(start, start + width):
            self.used[index] = 1
        self.most = max(self.most, start + width)
        return _Place(start, width)

    def _free(self, place: _Place) -> None:
        place.users -= 1
        if place.users == 0:
            for index in range(place.start, place.start + place.width):
                self.used[index] = 0

    # Closures

    def _closures_of(self, root: _Node, node: _Node) -> None:
        if node in self.closures:
            return
        self.closures.add(node)
        if node.kind not in COMBINED:
            for one in node.inputs:
                found: dict[_Node, None] = {}
                self._depend(one, found)
                self._run_all(found)
            self._generate(node)
            self.done.add(node)
            return
        first, second = node.inputs[-2:]
        factor = node.inputs[0] if node.kind == "ShaderNodeMixShader" and node.inputs[0].link is not None else None
        if factor is not None:
            found = {}
            self._depend(factor, found)
            self._run_all(found)
            shared = self._shared(root, node, first, second)
            if shared:
                for one in (first, second):
                    if one.link is not None:
                        self._shared_closures(root, one.link.node, shared)
                self._run_all(one for one in shared if not _is_closure(one) and one.kind not in COMBINED)
        for one in (first, second):
            if one.link is not None:
                self._closures_of(root, one.link.node)
        self.done.add(node)

    def _shared(self, root: _Node, node: _Node, first: _Input, second: _Input) -> set[_Node]:
        """What both sides need, or one side and something outside of this node."""
        sides: list[dict[_Node, None]] = [{}, {}]
        for one, found in zip((first, second), sides, strict=True):
            self._depend(one, found)
        shared = sides[0].keys() & sides[1].keys()
        if root is not node:
            outside: dict[_Node, None] = {}
            for one in root.inputs:
                self._depend(one, outside, node)
            shared |= outside.keys() & (sides[0].keys() | sides[1].keys())
        return set(shared)

    def _shared_closures(self, root: _Node, node: _Node, shared: set[_Node]) -> None:
        if node in shared:
            self._closures_of(root, node)
            return
        for one in node.inputs:
            if one.kind == "SHADER" and one.link is not None:
                self._shared_closures(root, one.link.node, shared)
