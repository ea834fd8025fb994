# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups and shaders whose Fresnel term, or other kind, comes from data: for the universal material."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...addon.models import fresnel as fresnel_kinds
from ...addon.models.spec import Parameter
from ...nodegroups import cook_torrance_closure as closure
from ...nodegroups import fresnel, osl_script
from ...nodegroups._tree import Value, select
from ...nodegroups.parameters import add_input
from .universal_data import NAME, REVISION

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from bpy.types import NodeSocket

    from ...nodegroups._tree import Tree

ANY = "any"  # the kind of Fresnel term that data choose
SWITCH = Parameter("kind", "kind", "Which of several, by number", 0.0, 0.0, 10.0)


class AnyFresnel:
    """As a module of ``fresnel.KINDS``: every term at once, of which an input chooses one."""

    NAME = f"{NAME} Fresnel"
    REVISION = REVISION
    KINDS = dict(fresnel.KINDS)

    def __init__(self, *, osl: bool) -> None:
        f82, dielectric, conductor = (
            fresnel_kinds.KINDS[kind].parameters for kind in ("f82", "dielectric", "conductor")
        )
        self.parameters = (
            *f82,
            *dielectric,
            *(replace(one, label=one.symbol) for one in conductor),
        )  # two are called IOR
        self._switch = () if osl else (SWITCH,)  # in OSL the scripts have it

    def interface(self, tree: Tree) -> dict[str, Value]:
        inputs = {one.name: add_input(tree, one) for one in self.parameters}
        return inputs | {one.name: _kind_input(tree) for one in self._switch}

    def as_kind(self) -> fresnel_kinds.Kind:
        """For groups nested in these, which take the inputs by their names."""
        return replace(fresnel_kinds.KINDS["f82"], label="Any", parameters=(*self.parameters, *self._switch))

    def build(self, tree: Tree) -> None:
        parameters = self.interface(tree)
        cosine = tree.input_float("Cosine", 1.0, low=0.0, high=1.0, tip="wo . h, view against half vector")
        F: Value | None = None
        for index, kind in enumerate(self.KINDS):
            of = fresnel.reflectance(tree, kind, _of_kind(kind, parameters), cosine)
            F = of if F is None else select(_is(parameters["kind"], index), of, F)
        assert F is not None  # noqa: S101 - there are kinds
        tree.output_color("F", F, tip="Fresnel reflectance")


def _kind_input(tree: Tree, name: str = SWITCH.name) -> Value:
    tree.input_float(name, SWITCH.low, low=SWITCH.low, high=SWITCH.high, tip=SWITCH.tip)
    return tree.input_named(name)  # after a panel it is not the last


def _is(value: Value, index: int) -> Value:
    return value.tree.math("COMPARE", value, float(index), 0.5)


def _of_kind(kind: str, parameters: Mapping[str, Value]) -> dict[str, Value]:
    return {one.name: parameters[one.name] for one in fresnel_kinds.KINDS[kind].parameters}


@contextmanager
def any_kind(*, osl: bool) -> Iterator[None]:
    """While groups are built here, there is a further kind of Fresnel term: ``ANY``."""
    native = closure.lobe

    def lobe(tree: Tree, kind: str, parameters: dict[str, Value], *shape: Value) -> NodeSocket:
        """Cycles' own lobe of each kind, all but one weighted with 0."""
        if kind != ANY:
            return native(tree, kind, parameters, *shape)
        return tree.add_shaders([
            tree.weighted(native(tree, of, _of_kind(of, parameters), *shape), _is(parameters["kind"], index))
            for index, of in enumerate(AnyFresnel.KINDS)
        ])  # fmt: skip

    among = AnyFresnel(osl=osl)
    fresnel.KINDS[ANY] = among  # type: ignore[assignment]
    fresnel_kinds.KINDS[ANY] = among.as_kind()
    closure.lobe = lobe  # type: ignore[assignment]
    try:
        yield
    finally:
        closure.lobe = native
        del fresnel.KINDS[ANY], fresnel_kinds.KINDS[ANY]


def by_data(make: Callable[..., None], *parameters: str) -> Callable[..., None]:
    """A group of OSL shaders that takes these of their parameters, which else are constants, by inputs."""

    def build_open(tree: Tree, **arguments: Any) -> None:
        make(tree, **arguments)
        for name in parameters:
            value = _kind_input(tree, name)
            for node in tree.node_tree.nodes:
                if node.bl_idname == "ShaderNodeScript":
                    tree.connect(value, osl_script.socket(node, name))

    return build_open
