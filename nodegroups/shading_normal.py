# SPDX-License-Identifier: GPL-3.0-or-later
"""The normal that a model is shaded with: the surface's own or an artist's, held to what the surface can reflect.

Cycles corrects the normals of its own closures (Bump Map Correction). That would also bend the leaning lobes of ``fit``
and the random facets of ``mirror``, so it is off for them, and the same correction is made here, before they lean.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import ensure
from ._tree import Tree, Value, clamp, dot, greater, hold, maximum, minimum, normalize, output, scale, select, sqrt

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Node, NodeSocket

NAME = ".VGroove Normal"
REVISION = 3
SPECULAR_NAME = ".VGroove Specular Normal"
SPECULAR_REVISION = 4
SMOOTHING_NAME = ".VGroove Bump Smoothing"
TIP = "A bump or normal map; the surface's own if unlinked"
LONGEST = 1e15  # its square is finite in float32
LOWEST = 0.01  # cosine that Cycles keeps a mirrored ray above the surface; at most VIEW_SHARE of the view's own
VIEW_SHARE = 0.9
SMOOTHING = 0.125  # squared slope of Cycles' bump smoothing, over the squared tangent of the map's tilt
AVERAGE = 0.62  # of even light a share 1/(1 + AVERAGE slope^1.5) is kept: within .02 of the mean up to 75 degrees


def interface(tree: Tree) -> Value:
    """The input "Normal", hidden value. An unlinked group input reads (0, 0, 0)."""
    return tree.input_vector("Normal", hide_value=True, tip=TIP)


def build(tree: Tree) -> None:
    given = hold(interface(tree), -LONGEST, LONGEST)
    linked = greater(dot(given, given), 1e-12)
    tree.output_vector("N", select(linked, normalize(given), tree.geometry("Normal")), tip="Unit normal")
    tree.output_float("Linked", linked, tip="1 where a normal is given, else 0")


def shading_normal(tree: Tree, given: Value) -> Value:
    """N for a group whose input ``given`` may be unlinked; diffuse closures take it as it is."""
    return Value(tree, tree.group(ensure(NAME, REVISION, build), Normal=given).outputs["N"])


def specular_normal(tree: Tree, given: Value) -> Value:
    """N for closures that mirror: raised where the view's mirror image would be below the surface."""
    return Value(tree, _specular(tree, given).outputs["Shading"])


def raised(tree: Tree, given: Value, shader: Callable[[Value], NodeSocket]) -> NodeSocket:
    """The shader of ``specular_normal``. Where that is N itself, Cycles runs none of what raises it."""
    node = _specular(tree, given)
    plain, up = (shader(Value(tree, node.outputs[name])) for name in ("N", "Raised"))
    below = Value(tree, node.outputs["Below"])
    return output(tree.node("ShaderNodeMixShader", Fac=below, Shader=plain, Shader_001=up), "Shader")


def _specular(tree: Tree, given: Value) -> Node:
    return tree.group(ensure(SPECULAR_NAME, SPECULAR_REVISION, build_specular), Normal=given)


def build_specular(tree: Tree) -> None:
    """N + k Ng, k the least for which the mirror image R of the view has R . Ng >= t; N itself where it has.

    In the plane of N and Ng, I and R have the same length; with R . Ng = t, N halves the angle between them. Written
    out, with c = Ng . I, d = N . Ng and u = N . I - d c, the sine of N's tilt times I's part along it:
    d + k = (sqrt(u^2 + (1 - d^2) (c^2 - t^2)) - u) / (c - t).
    Cycles solves a quartic for the same normal (``ensure_valid_specular_reflection`` in kernel/closure/bsdf_util.h). It
    leaves curves alone: a ribbon faces the viewer while N goes around the hair.
    """
    N = shading_normal(tree, interface(tree))
    Ng, I = tree.geometry("True Normal"), tree.geometry("Incoming")
    with tree.frame("-R . Ng > -t, or nearly: k is 0 where the view itself is that low; never on hair, as in Cycles"):
        on_hair = Value(tree, output(tree.node("ShaderNodeHairInfo"), "Is Strand"))
        threshold = tree.math("MULTIPLY_ADD", on_hair, 2.0, -LOWEST)  # no cosine is above 1
        below = greater(dot(tree.math("REFLECT", I, N), Ng), threshold)
    with tree.frame("k"):
        c, d = dot(Ng, I), dot(N, Ng)
        t = minimum(VIEW_SHARE * c, LOWEST)
        u = dot(N, I) - d * c
        beside = tree.math("MULTIPLY_ADD", u, u, (1.0 - d * d) * (c * c - t * t))
        k = maximum((sqrt(beside) - u) / (c - t) - d, 0.0)
    tree.output_vector("N", N, tip="Unit normal as given")
    higher = normalize(N + scale(Ng, k))
    tree.output_vector("Raised", higher, tip="Unit normal with R . Ng = t")
    tree.output_float("Below", below, tip="1 where N has to be raised, else 0")
    tree.output_vector("Shading", select(below, higher, N), tip="Raised where it has to be, else N")


def lit(tree: Tree, given: Value, wi: Value) -> Value:
    """1 where a light is above the surface without the map, else 0: Cycles asks it of every closure."""
    return Value(tree, _towards_light(tree, given, wi).outputs["Lit"])


def smoothing(tree: Tree, given: Value, wi: Value) -> Value:
    """The share of light from wi that Cycles' diffuse closures keep on a mapped normal; 1 where none is linked."""
    return Value(tree, _towards_light(tree, given, wi).outputs["Smoothing"])


def _towards_light(tree: Tree, given: Value, wi: Value) -> Node:
    return tree.group(ensure(SMOOTHING_NAME, REVISION, build_smoothing), Normal=given, To_Light=wi)


def build_smoothing(tree: Tree) -> None:
    """GGX shadowing on the unmapped surface, rougher the more the map tilts N. Cycles folds it away if none is linked.

    Source: Conty Estevez, Lecocq & Stein 2019, A Microfacet-Based Shadowing Function to Solve the Bump Terminator
    Problem; ``bump_shadowing_term`` in Cycles' kernel/closure/bsdf.h.
    """
    given = interface(tree)
    wi = tree.input_vector("To Light", (0, 0, 1), hide_value=True, tip="Unit vector")
    linked, slope2, d = _tilt(tree, given)
    light = dot(wi, tree.geometry("Normal"))
    with tree.frame("1 where nothing is linked"):
        above = greater(light * d, 0.0)
        tree.output_float("Lit", 1.0 - linked * (1.0 - above), tip="1 above the unmapped surface, else 0")
        G = 2.0 / (1.0 + sqrt(1.0 + slope2 * (1.0 / maximum(light * light, 1e-12) - 1.0)))
        tree.output_float("Smoothing", 1.0 - linked * (1.0 - above * G), tip="Share of the light that is kept")


def average_smoothing(tree: Tree, given: Value) -> Value:
    """``smoothing`` in an even light, for diffuse closures that do without Cycles' own."""
    node = tree.group(ensure(f"{SMOOTHING_NAME} Average", REVISION, build_average), Normal=given)
    return Value(tree, node.outputs["Smoothing"])


def typical_smoothing(tree: Tree, given: Value) -> Value:
    """For closures whose lights are unknown: half way, by its square root, from the average to 1 under a high sun."""
    return sqrt(average_smoothing(tree, given))


def build_average(tree: Tree) -> None:
    """The mean over the cosine-weighted directions above the unmapped surface, to .02 for tilts up to 75 degrees."""
    linked, slope2, _ = _tilt(tree, interface(tree))
    lost = AVERAGE * tree.math("POWER", linked * slope2, 0.75)
    tree.output_float("Smoothing", 1.0 / (1.0 + lost), tip="Share of the light that is kept, on average")


def _tilt(tree: Tree, given: Value) -> tuple[Value, Value, Value]:
    """Whether a normal is linked, the squared slope of its smoothing, and its cosine to the surface's own."""
    node = tree.group(ensure(NAME, REVISION, build), Normal=given)
    N, linked = (Value(tree, node.outputs[name]) for name in ("N", "Linked"))
    with tree.frame("Squared slope, from the tilt of the map"):
        d = dot(N, tree.geometry("Normal"))
        return linked, clamp(SMOOTHING * (1.0 / maximum(d * d, 1e-12) - 1.0)), d
