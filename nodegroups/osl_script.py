# SPDX-License-Identifier: GPL-3.0-or-later
"""OSL shaders inside node groups: the group carries what Script nodes ignore (ranges, tooltips, panels).

The text travels in the .blend, with headers written into it: text made in memory cannot include local files. The
compiled bytecode is kept in the node, so a saved file renders where the extension is not installed.
"""

from __future__ import annotations

import re
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import bpy

from ..addon.library.errors import InputError
from . import cook_torrance_table, oren_nayar_table, parameters, random_numbers, versions
from ._tree import Number, Tree, Value

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from bpy.types import Node, NodeSocket, Text

Variant: TypeAlias = "tuple[str, Mapping[str, str]]"


class OslError(InputError):
    """This Blender cannot compile OSL."""


LONGEST_NAME = 50  # Blender keeps 63 bytes of a name, and may add a number
FOLDER = Path(__file__).parent.parent / "osl"
TABLES = {
    "oren_nayar_fit_table.h": oren_nayar_table.header,
    "cook_torrance_fit_table.h": cook_torrance_table.header,
    "random_numbers.h": random_numbers.osl_header,
    "versions.h": versions.osl_header,
}
PARAMETERS = parameters.headers()


def source(shader: str, tables: Mapping[str, str] | None = None) -> str:
    """Text of ``osl/SHADER.osl`` with our own headers in place of their #include lines.

    ``tables``: text of headers that are not the same for every node of the shader.
    """
    text = (FOLDER / f"{shader}.osl").read_text(encoding="utf-8")
    return _inlined(text, tables or {})


def _inlined(text: str, tables: Mapping[str, str]) -> str:
    """Headers of ours, files or tables written as OSL, in place of their #include lines; Cycles' own stay."""
    return re.sub(r'#include "(\w+\.h)"', lambda found: _header(found[1], tables) or found[0], text)


def _header(name: str, tables: Mapping[str, str]) -> str:
    if name in tables:
        return tables[name]
    if name in TABLES:
        return TABLES[name]()
    if name in PARAMETERS:
        return PARAMETERS[name]
    path = FOLDER / "include" / name
    return _inlined(path.read_text(encoding="utf-8"), tables) if path.exists() else ""


def text_block(shader: str, variant: Variant | None = None) -> Text:
    """The shader as a text datablock; one a .blend, replaced when the source has changed.

    variant: of a shader of which there are several, its name and the texts of the headers that make it.
    """
    title, tables = variant or (shader, {})
    content = source(shader, tables) if tables else source(shader)
    name = f"vgroove {title}"[:LONGEST_NAME] + ".osl"
    for text in bpy.data.texts:
        if text.name.split(".osl")[0] == name.removesuffix(".osl") and text.as_string() == content:
            return text
    text = bpy.data.texts.new(name)
    text.from_string(content)
    text.cursor_set(0)
    return text


def script(tree: Tree, shader: str, variant: Variant | None = None, /, **parameters: Number) -> Node:
    """A Script node that runs ``shader``, or a variant as of ``text_block``, with its parameters connected.

    ``seed``, of a shader that has it, is the scene's unless it is given.
    Raises OslError if the shader does not compile (this Blender was built without OSL).
    """
    node = tree.node("ShaderNodeScript", mode="INTERNAL", label=shader)
    known = set(bpy.data.texts)
    try:
        with tidy():
            node.script = text_block(shader, variant)  # in a scene of Cycles this compiles it
            if not node.bytecode:
                _compile(node, shader)
    except OslError:
        for text in set(bpy.data.texts) - known:
            bpy.data.texts.remove(text)
        raise
    if "seed" not in parameters and any(item.identifier == "seed" for item in node.inputs):
        tree.connect(random_numbers.seed(tree), socket(node, "seed"))
    for name, value in parameters.items():
        tree.connect(value, socket(node, name))
    return node


@contextmanager
def tidy() -> Iterator[None]:
    """Remove the files that the Cycles add-on compiles to within the block; it leaves them in the temporary folder."""
    try:
        from cycles import osl
    except ImportError:  # a build without Cycles
        yield
        return
    compile_file, made = osl.osl_compile, []

    def compile_and_note(*arguments: Any) -> Any:
        found = compile_file(*arguments)
        made.append(found[1])
        return found

    osl.osl_compile = compile_and_note
    try:
        yield
    finally:
        osl.osl_compile = compile_file
        for path in made:
            Path(path).unlink(missing_ok=True)


def _compile(node: Node, shader: str) -> None:
    """Bytecode and sockets, by the Cycles add-on that comes with Blender."""
    cause: Exception | None = None
    try:
        from cycles.osl import update_script_node

        done = update_script_node(node, lambda *_: None)
    except ImportError as error:  # oslquery is only in builds with OSL
        done, cause = False, error
    if not done:
        reason = "was built without OSL" if isinstance(cause, ImportError) else f"cannot compile {shader}.osl"
        message = f"This Blender {reason}; choose the backend Nodes"
        raise OslError(message) from cause


def socket(node: Node, parameter: str) -> NodeSocket:
    """The input of a Script node for a shader parameter: its identifier, whatever its label says."""
    return next(item for item in node.inputs if item.identifier == parameter)


def output(tree: Tree, node: Node, parameter: str) -> Value:
    """An output of a Script node by parameter name."""
    return Value(tree, next(item for item in node.outputs if item.identifier == parameter))
