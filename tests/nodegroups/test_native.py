# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own nodes and OSL closures that vgroove builds on: their sockets, their defaults, and what each renders.

The first to fail in a Blender that changed one, and it says which. Each closure is rendered alone under one sun, or
under half a white sky, beside the reference's formula for it. Volume absorption and subsurface scattering are rendered
by test_glass and test_translucent.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.reference import F82, Conductor, cycles, fresnel_dielectric, glass_btdf, schlick, smith_g
from vgroove.addon.reference.cook_torrance_fit import NARROWEST, smith_lobe
from vgroove.addon.reference.directions import dot, half_vector
from vgroove.addon.reference.glass import refraction_facet
from vgroove.addon.reference.oren_nayar_fit import cycles_diffuse
from vgroove.lab.check.views import closure_bar
from vgroove.nodegroups import osl_script, versions
from vgroove.nodegroups._native import NativeError, output
from vgroove.nodegroups._tree import Tree, cross

pytestmark = pytest.mark.blender

SOCKETS = Path(__file__).parents[1] / "data" / "native.toml"
DIFFUSE_BAR = 5e-6  # as lab/check/oren_nayar.py has it: about 20 float32 operations on cosines
SURE = 1e-6  # weights of perfect mirrors, some products of float32 from exact
M, ETA, COLOR = 0.3, 1.5, (0.8, 0.5, 0.2)
SUN, BELOW = gonio.Geometry(35.0, resolution=(24, 24)), gonio.Geometry(150.0, resolution=(24, 24))
SKY = gonio.Geometry(furnace=True, lit="above", resolution=(8, 8))
GROUND = replace(SKY, lit="below")


# Sockets


def recorded(version):
    """Inputs, with type and default, and outputs of each node as this version has them."""
    with SOCKETS.open("rb") as file:
        changes = tomllib.load(file)
    known = {}
    for since in sorted(changes, key=number):
        if number(since) <= version:
            for kind, parts in changes[since].items():
                for part, sockets in parts.items():
                    known.setdefault(kind, {}).setdefault(part, {}).update(sockets)
    return known


def number(text):
    return tuple(map(int, text.split(".")))


def sockets_of(node):
    """The same of a node that was just made; sockets of Blender's that only grow others are left out."""
    inputs = {one.identifier: [one.type, plain(one)] for one in node.inputs if one.type != "CUSTOM"}
    return {"inputs": inputs, "outputs": {one.identifier: one.type for one in node.outputs if one.type != "CUSTOM"}}


def plain(socket):
    value = getattr(socket, "default_value", "")
    if isinstance(value, str | int):
        return value
    rounded = np.round(np.asarray(value, dtype=np.float64), 4)
    return rounded.tolist()


@pytest.mark.parametrize("kind", sorted(recorded((9, 9))))
def test_a_node_has_the_sockets_that_are_recorded(blender, kind):
    """By identifier, type and default; more of them may mean something too."""
    known = recorded(versions.version())
    if kind not in known:
        assert not hasattr(blender.types, f"ShaderNode{kind}")
        return
    tree = blender.data.node_groups.new("Probe", "ShaderNodeTree")
    now = sockets_of(tree.nodes.new(f"ShaderNode{kind}"))
    expected = {"inputs": {}, "outputs": {}} | known[kind]
    changed = {part: differences(expected[part], now[part]) for part in expected}
    assert not any(changed.values()), f"{kind} of Blender {blender.app.version_string}: {changed}"


def differences(before, now):
    return {name: (before.get(name), now.get(name)) for name in before | now if before.get(name) != now.get(name)}


def test_every_node_that_is_built_is_recorded():
    """Whatever kind of node the package asks for."""
    folder = Path(osl_script.__file__).parent
    asked = {kind for path in folder.glob("*.py") for kind in re.findall(r'"ShaderNode(\w+)"', path.read_text("utf-8"))}
    ours = {"Group", "Script", "Tree"}
    later = {"Raycast", "LightAccumulation", "LightEvaluation", "LightInfo", "ShadowRaycast"}
    assert asked - ours <= recorded(versions.version()).keys() | later


def test_a_missing_socket_and_one_of_another_type_are_refused(blender):
    """In one line that names the node, the socket and this Blender."""
    tree = Tree(blender.data.node_groups.new("Probe", "ShaderNodeTree"))
    version = re.escape(blender.app.version_string)
    with pytest.raises(NativeError, match=rf"Glass BSDF of Blender {version} has no input 'Eta' that takes a number"):
        tree.node("ShaderNodeBsdfGlass", Eta=1.5)
    with pytest.raises(NativeError, match=r"no input 'Roughness' that takes a vector"):
        tree.node("ShaderNodeBsdfGlass", Roughness=(0.1, 0.2, 0.3))
    with pytest.raises(NativeError, match=r"no input 'Shader' that takes a number"):
        tree.node("ShaderNodeMixShader", Shader=1.0)
    with pytest.raises(NativeError, match=r"no output 'Light'"):
        output(tree.node("ShaderNodeEmission"), "Light")


DECLARED = {
    "conductor_bsdf": "normal N, vector U, float roughness_x, float roughness_y, color ior, color extinction, "
    "string distribution",
    "dielectric_bsdf": "normal N, vector U, color reflection_tint, color transmission_tint, float roughness_x, "
    "float roughness_y, float ior, string distribution",
    "diffuse": "normal N",
    "diffuse_toon": "normal N, float size, float smooth",
    "emission": "",
    "generalized_schlick_bsdf": "normal N, vector U, color reflection_tint, color transmission_tint, "
    "float roughness_x, float roughness_y, color f0, color f90, float exponent, string distribution",
    "microfacet": "string distribution, normal N, vector U, float xalpha, float yalpha, float eta, int refract",
    "microfacet_f82_tint": "string distribution, vector N, vector T, float ax, float ay, color f0, color f82",
    "oren_nayar_diffuse_bsdf": "normal N, color albedo, float roughness",
    "reflection": "normal N, float eta",
    "refraction": "normal N, float eta",
    "transparent": "",
}


def test_osl_closures_are_declared_as_recorded(blender):
    """With the same arguments in the same order; and no shader of ours uses another."""
    folder = Path(blender.utils.system_resource("SCRIPTS")) / "addons_core" / "cycles" / "shader"
    text = " ".join(path.read_text("utf-8") for path in (folder / "stdosl.h", folder / "stdcycles.h"))
    declared = {
        name: " ".join(given.split())
        for name, given in re.findall(r"closure color\s+(\w+)\s*\(([^)]*)\)\s*BUILTIN", text)
    }
    assert {name: declared.get(name) for name in DECLARED} == DECLARED
    ours = " ".join(path.read_text("utf-8") for path in osl_script.FOLDER.rglob("*.*"))
    own = {"oren_nayar"}  # of osl/include
    assert (set(re.findall(r"\b(\w+)\(", ours)) - own) & declared.keys() == DECLARED.keys()


# What they render


@dataclass(frozen=True)
class Probe:
    """One closure: made by a function of a ``Tree``, or by a term of OSL, and what it renders in each geometry.

    expected: f(wi, wo) in 1/sr, or the albedo in a half world, (H, W, 3); NaN where Cycles is known to differ.
    """

    name: str
    make: object
    expected: object
    geometries: tuple[gonio.Geometry, ...] = (SUN,)
    bar: float = closure_bar(M)


def node(kind, **given):
    return lambda tree: output(tree.node(f"ShaderNode{kind}", **given), "BSDF")


def stretched(tree):
    """Tangent along y: Cycles asks for none that is typed."""
    metal = {"fresnel_type": "F82", "Base_Color": (1.0, 1.0, 1.0), "Edge_Tint": (1.0, 1.0, 1.0), **METAL}
    T = cross(tree.geometry("Normal"), (1.0, 0.0, 0.0))
    return output(tree.node("ShaderNodeBsdfMetallic", Anisotropy=0.7, Tangent=T, **metal), "BSDF")


def lobe(F, across=M, along=M):
    """Beckmann's D, Smith's G and F of the angle to the facet; slopes along y and x."""

    def f(wi, wo):
        wi = np.broadcast_to(wi, wo.shape)
        h = half_vector(wi, wo)
        sides = [tuple(w[..., k] for k in (1, 0, 2)) for w in (wi, wo, h)]
        up = (wi[..., 2] > 0) & (wo[..., 2] > 0)
        shape = smith_lobe(*sides, np.float64(across), np.float64(along)) / np.where(up, wi[..., 2], 1.0)
        return F(np.where(up, dot(wo, h), 1.0)) * np.where(up, shape, 0.0)[..., None]

    return f


def through(eta):
    """Walter's BTDF with Smith's G; NaN where no facet connects, of which Cycles renders some."""

    def f(wi, wo):
        wi = np.broadcast_to(wi, wo.shape)
        h, found = refraction_facet(wi, wo, eta)
        value = glass_btdf(wi, wo, M, eta, smith_g(-wi, wo, M))
        return np.where((found > 0) & (h[..., 2] > 0), value, np.nan)[..., None] * np.ones(3)

    return f


def dielectric(eta):
    return lambda c: fresnel_dielectric(c, eta)[..., None] * np.ones(3)


def glass(eta):
    return lambda wi, wo: lobe(dielectric(eta))(wi, wo) if wi[2] > 0 else through(eta)(wi, wo)


def flat(above, below):
    """A perfect closure's weight by which half of the world is lit."""
    return lambda lit, _wo: np.multiply({"above": above, "below": below}[lit], np.ones(3))


def bent(eta):
    """Perfect refraction to an index: all of what is below, but for total reflection."""

    def weight(lit, wo):
        passes = np.square(eta) > 1.0 - np.square(wo[..., 2])
        return (passes & (lit == "below"))[..., None] * np.ones(3)

    return weight


def oren_nayar(roughness):
    return lambda wi, wo: cycles_diffuse(np.broadcast_to(wi, wo.shape), wo, COLOR, roughness)


ASPECT = np.sqrt(1.0 - (1.0 - NARROWEST) * 0.7)
F0, TINT = (0.9, 0.6, 0.3), (0.5, 0.7, 0.9)
N, K = (0.27, 0.68, 1.32), (3.61, 2.62, 2.29)
METAL = {"distribution": "BECKMANN", "Roughness": M**0.5}
SMOOTH = {"distribution": "BECKMANN", "Roughness": 0.0}
INSIDE = tuple(replace(one, inside=True) for one in (SUN, BELOW))
BACK = tuple(replace(one, inside=True) for one in (SKY, GROUND))


def ior(inside):
    """What refracting closures of OSL are to be given."""
    return 1.0 / ETA if inside and not versions.OSL_TURNS_IOR else ETA


def colour(of):
    return f"color({', '.join(map(str, of))})"


NODES = (
    *(Probe(f"Diffuse {r}", node("BsdfDiffuse", Color=COLOR, Roughness=r), oren_nayar(r), bar=DIFFUSE_BAR)
      for r in (0.0, 0.5, 1.0)),
    Probe("Metallic, F82", node("BsdfMetallic", fresnel_type="F82", Base_Color=F0, Edge_Tint=TINT, **METAL),
          lobe(F82(F0, TINT))),
    Probe("Metallic, stretched", stretched,
          lobe(lambda c: np.ones((*c.shape, 3)), across=M / ASPECT, along=M * ASPECT)),
    Probe("Metallic, conductor", node("BsdfMetallic", fresnel_type="PHYSICAL_CONDUCTOR", IOR=N, Extinction=K, **METAL),
          lobe(Conductor(N, K)), bar=closure_bar(M) if versions.EXACT_CONDUCTOR else 8e-3),
    Probe("Glass", node("BsdfGlass", IOR=ETA, Color=(1.0, 1.0, 1.0), **METAL), glass(ETA), (SUN, BELOW)),
    Probe("Glass, inside", node("BsdfGlass", IOR=ETA, Color=(1.0, 1.0, 1.0), **METAL), glass(1.0 / ETA), INSIDE),
    *(Probe(f"Refraction{', inside' * inside}", node("BsdfRefraction", IOR=ETA, Color=(1.0, 1.0, 1.0), **SMOOTH),
            bent(1.0 / ETA if inside else ETA), BACK if inside else (SKY, GROUND), SURE) for inside in (False, True)),
    Probe("Glossy", node("BsdfAnisotropic", Color=COLOR, **SMOOTH), flat(COLOR, 0.0), (SKY, GROUND), SURE),
    Probe("Transparent", node("BsdfTransparent", Color=COLOR), flat(0.0, COLOR), (SKY, GROUND), SURE),
    Probe("Emission", lambda tree: output(tree.node("ShaderNodeEmission", Color=COLOR, Strength=3.0), "Emission"),
          flat(np.multiply(3.0, COLOR), np.multiply(3.0, COLOR)), (SKY, GROUND), SURE),
    Probe("Mix Shader", lambda tree: tree.weighted(node("BsdfTransparent", Color=COLOR)(tree), 0.25),
          flat(0.0, np.multiply(0.25, COLOR)), (GROUND,), SURE),
    Probe("Mix Shader, held", lambda tree: tree.weighted(node("BsdfTransparent", Color=COLOR)(tree), 2.0),
          flat(0.0, COLOR), (GROUND,), SURE),
    Probe("Add Shader", lambda tree: tree.add_shaders([node("BsdfTransparent", Color=c)(tree) for c in (COLOR, COLOR)]),
          flat(0.0, np.multiply(2.0, COLOR)), (GROUND,), SURE),
)  # fmt: skip
ROUND = f"vector(0), {M}, {M}"
OSL = (
    Probe("diffuse", f"{colour(COLOR)} * diffuse(N)", oren_nayar(0.0), bar=DIFFUSE_BAR),
    Probe("oren_nayar_diffuse_bsdf", f"oren_nayar_diffuse_bsdf(N, {colour(COLOR)}, 1.0)", oren_nayar(1.0),
          bar=DIFFUSE_BAR),
    Probe("microfacet_f82_tint", f'microfacet_f82_tint("beckmann", N, {ROUND}, {colour(F0)}, {colour(TINT)})',
          lobe(F82(F0, TINT))),
    Probe("microfacet_f82_tint, stretched",
          f'microfacet_f82_tint("beckmann", N, vector(0, 1, 0), {M / ASPECT}, {M * ASPECT}, color(1), color(1))',
          lobe(lambda c: np.ones((*c.shape, 3)), across=M / ASPECT, along=M * ASPECT)),
    Probe("conductor_bsdf", f'conductor_bsdf(N, {ROUND}, {colour(N)}, {colour(K)}, "beckmann")', lobe(Conductor(N, K)),
          bar=closure_bar(M) if versions.EXACT_CONDUCTOR else 8e-3),
    Probe("generalized_schlick_bsdf",
          f'generalized_schlick_bsdf(N, {ROUND.replace("vector(0)", "vector(0), color(1), color(0)")}, {colour(F0)}, '
          f'color(1), 5.0, "beckmann")', lobe(lambda c: schlick(c, F0))),
    *(Probe(f"dielectric_bsdf{', inside' * inside}",
            f'dielectric_bsdf(N, vector(0), color(1), color(1), {M}, {M}, {ior(inside)}, "beckmann")',
            glass(1.0 / ETA if inside else ETA), INSIDE if inside else (SUN, BELOW)) for inside in (False, True)),
    *(Probe(f"refraction{', inside' * inside}", f"refraction(N, {ior(inside)})", bent(1.0 / ETA if inside else ETA),
            BACK if inside else (SKY, GROUND), SURE) for inside in (False, True)),
    Probe("reflection", f"{colour(COLOR)} * reflection(N)", flat(COLOR, 0.0), (SKY, GROUND), SURE),
    Probe("transparent", f"{colour(COLOR)} * transparent()", flat(0.0, COLOR), (SKY, GROUND), SURE),
    Probe("emission", f"{colour(COLOR)} * emission()", flat(COLOR, COLOR), (SKY, GROUND), SURE),
)  # fmt: skip


def material(blender, make):
    """One closure, to the output."""
    made = versions.empty_material("Probe")
    node_tree = made.node_tree
    out = node_tree.nodes.new("ShaderNodeOutputMaterial")
    if isinstance(make, str):
        script = node_tree.nodes.new("ShaderNodeScript")
        text = blender.data.texts.new("probe.osl")
        text.from_string(
            f'#include "stdcycles.h"\nshader probe(output closure color BSDF = 0)\n{{\n    BSDF = {make};\n}}\n'
        )
        with osl_script.tidy():
            script.script = text
            if not script.bytecode:
                osl_script._compile(script, "probe")
        node_tree.links.new(script.outputs[0], out.inputs["Surface"])
        return made
    group = blender.data.node_groups.new("Probe", "ShaderNodeTree")
    tree = Tree(group)
    tree.output_shader("BSDF", make(tree), tip="")
    nested = node_tree.nodes.new("ShaderNodeGroup")
    nested.node_tree = group
    node_tree.links.new(nested.outputs[0], out.inputs["Surface"])
    return made


def off(blender, probe):
    """The largest difference from what is expected, over the largest value, as a share of the bar."""
    found = []
    for geometry in probe.geometries:
        with headless.quiet():
            image = gonio.measure(
                material(blender, probe.make), geometry, samples=1, shading_osl=isinstance(probe.make, str)
            )
        wo = geometry.wo()
        expected = probe.expected(geometry.lit, wo) if geometry.furnace else probe.expected(geometry.wi(), wo)
        expected = expected * np.ones_like(wo)
        known = np.isfinite(expected)
        scale = max(float(np.max(expected[known], initial=0.0)), SURE)
        if geometry.furnace:
            scale = max(scale, 0.1)
        found.append(float(np.max(np.abs(image - expected)[known])) / scale / probe.bar)
    return max(found)


@pytest.mark.parametrize("probe", NODES, ids=lambda probe: probe.name)
def test_a_node_renders_its_formula(blender, probe):
    """In SVM. What changed, and by how much, is in the message."""
    measured = off(blender, probe)
    assert measured <= 1.0, f"{probe.name} of Blender {blender.app.version_string}: off by {measured * probe.bar:.2g}"


@pytest.mark.parametrize("probe", OSL, ids=lambda probe: probe.name)
def test_an_osl_closure_renders_its_formula(blender, probe):
    measured = off(blender, probe)
    assert measured <= 1.0, f"{probe.name} of Blender {blender.app.version_string}: off by {measured * probe.bar:.2g}"


# The switches


def probes(*names):
    return [one for one in (*NODES, *OSL) if one.name in names]


def test_the_other_oren_nayar_is_red(blender):
    """Blender 5.3 colours light that bounced more than once by another power of the colour."""
    other = next(one for one in cycles.VERSIONS if one != cycles.version())
    with cycles.as_of(other):
        for probe in probes("Diffuse 0.5", "Diffuse 1.0", "oren_nayar_diffuse_bsdf"):
            assert off(blender, probe) > 100.0
    assert cycles.version() != other


@pytest.mark.parametrize("name", ["dielectric_bsdf, inside", "refraction, inside"])
def test_the_ior_turned_over_once_too_often_is_red(blender, name):
    """Blender 5.3 does so itself in OSL; what earlier ones were given is wrong there, and the other way round."""
    (probe,) = probes(name)
    wrong = 1.0 / ETA if versions.OSL_TURNS_IOR else ETA
    assert str(ior(inside=True)) in probe.make
    assert off(blender, replace(probe, make=probe.make.replace(str(ior(inside=True)), str(wrong)))) > 100.0


def test_glass_wired_by_place_is_red_where_places_changed(blender):
    """Blender 5.3 put Anisotropy where the IOR had been."""

    def by_place(tree):
        made = tree.node("ShaderNodeBsdfGlass", distribution="BECKMANN", IOR=1.01)
        for value, socket in zip(((1.0, 1.0, 1.0, 1.0), M**0.5, ETA), made.inputs, strict=False):
            socket.default_value = value
        return output(made, "BSDF")

    (probe,) = probes("Glass")
    assert (off(blender, replace(probe, make=by_place)) > 100.0) == versions.since(5, 3)
