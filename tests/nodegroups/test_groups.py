# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups give the reference's values, and OSL shaders, groups and tooltips speak of the same parameters."""

from functools import partial
from itertools import product

import numpy as np
import pytest

from vgroove import headless, nodegroups
from vgroove.addon import models
from vgroove.addon.blender import gonio
from vgroove.addon.models.cook_torrance import SLOPE
from vgroove.addon.reference import beckmann_d, f82, fresnel_conductor, fresnel_dielectric, schlick, spherical
from vgroove.nodegroups import beckmann_d as beckmann_group
from vgroove.nodegroups import (
    cook_torrance_closure,
    cook_torrance_direct,
    cook_torrance_fit,
    cook_torrance_mirror,
    fresnel,
    lamp,
    osl_script,
    ramp,
    random_numbers,
    shading_normal,
    trajectory,
    vgroove_g,
)

pytestmark = pytest.mark.blender

SHADERS = (
    "cook_torrance_fit",
    "cook_torrance_closure",
    "cook_torrance_mirror",
    "cook_torrance_direct",
    "lamp",
    "gonio_camera",
)
KEYS = {
    "Roughness": [(0.0, 0.1), (0.3, 0.2), (1.0, 0.6)],
    "Base Color": [(0.1, (0.9, 0.5, 0.3)), (0.6, (0.1, 0.2, 0.3))],
}


@pytest.fixture
def group_value(blender, empty_material):
    """A function that renders one output of a group for given inputs, as plain nodes."""

    def value(module, output, **inputs):
        made = empty_material()
        tree = made.node_tree
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = nodegroups.ensure(module.NAME, module.REVISION, module.build)
        for name, given in inputs.items():
            socket = node.inputs[name.replace("_", " ")]
            socket.default_value = (*given, 1.0) if socket.type == "RGBA" else given
        emission, sink = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(node.outputs[output], emission.inputs["Color"])
        tree.links.new(emission.outputs[0], sink.inputs["Surface"])
        with headless.quiet():
            image = gonio.measure(made, gonio.Geometry(resolution=(4, 4)), shading_osl=False)
        return image[1, 1].astype(float)

    return value


@pytest.mark.parametrize("cosine", [0.0, 0.1, 0.5, 0.9, 1.0])
def test_fresnel_groups_give_the_reference_value(group_value, cosine):
    """F0, IOR and n, k at five angles."""
    c = np.float64(np.float32(cosine))
    f0 = np.float64(np.float32([0.04, 0.5, 0.95]))
    # About 6 float32 operations of 6e-8, doubled for the fifth power.
    np.testing.assert_allclose(
        group_value(fresnel.KINDS["schlick"], "F", Base_Color=f0, Cosine=c), schlick(c, f0), rtol=1e-6
    )
    tint = np.float64(np.float32([0.6, 0.9, 1.0]))
    # Of b and the powers about 12 operations more, on what is at most 1.
    got = group_value(fresnel.KINDS["f82"], "F", Base_Color=f0, Edge_Tint=tint, Cosine=c)
    np.testing.assert_allclose(got, f82(c, f0, tint), rtol=2e-6, atol=1e-6)
    for eta in np.float64(np.float32([0.6, 1.1, 1.5, 2.4])):
        got = group_value(fresnel.KINDS["dielectric"], "F", IOR=eta, Cosine=c)
        # g - c rounds by 2^-24 (g + c), which counts (g + c)/(g - c) times, squared in F.
        np.testing.assert_allclose(got, np.full(3, fresnel_dielectric(c, eta)), rtol=2e-5, atol=1e-7)
    n, k = np.float64(np.float32([0.27, 0.68, 1.32])), np.float64(np.float32([3.61, 2.62, 2.29]))
    got = group_value(fresnel.KINDS["conductor"], "F", IOR=n, Extinction=k, Cosine=c)
    np.testing.assert_allclose(got, fresnel_conductor(c, n, k), rtol=5e-6)


@pytest.mark.parametrize("m", [0.01, 0.1, 0.5, 1.0, 10.0])
@pytest.mark.parametrize("slope", [0.0, 0.5, 1.0, 3.0])
def test_beckmann_group_gives_the_reference_value(group_value, m, slope):
    """D of a facet whose slope is 0 to 3 times m."""
    h = spherical(np.arctan(slope * m), 0.4)
    h32 = np.float64(np.float32(h))
    h32 /= np.linalg.norm(h32)
    got = group_value(beckmann_group, "D", h=h, N=(0, 0, 1), Slope_m=m)
    # exp() multiplies the relative rounding of tan^2/m^2, about 6 * 2^-24, by tan^2/m^2 <= 9; the facet's own
    # components round by 2^-25, which turns tan by 2^-25 / m relative.
    bound = (20 + 2 * slope**2 * (6 + 1 / m)) * 2.0**-24
    np.testing.assert_allclose(got, np.full(3, beckmann_d(h32, np.float64(np.float32(m)))), rtol=bound)


def all_groups():
    """Every group of every module, by name."""
    made = {}
    for kind, module in fresnel.KINDS.items():
        made[module.NAME] = nodegroups.ensure(module.NAME, module.REVISION, module.build)
        for estimator in (cook_torrance_fit, cook_torrance_closure, cook_torrance_mirror, cook_torrance_direct):
            more = {} if estimator in (cook_torrance_fit, cook_torrance_closure) else {"lamps": 2}
            for build in (estimator.build, estimator.build_osl):
                name = f"{estimator.NAME} {kind} {build.__name__}"
                made[name] = nodegroups.ensure(name, 1, partial(build, kind=kind, **more))
    for module in (beckmann_group, vgroove_g, random_numbers, shading_normal):
        made[module.NAME] = nodegroups.ensure(module.NAME, module.REVISION, module.build)
    for kind in lamp.KINDS:
        for shadows in {False, lamp.can_cast_shadows()}:
            for sized, build in product({kind in lamp.AREAS, True}, (lamp.build, lamp.build_osl)):
                variant = {"kind": kind, "shadows": shadows, "sized": sized}
                name = f"{lamp.name(**variant)} {build.__name__}"
                made[name] = nodegroups.ensure(name, 1, partial(build, **variant))
    for color in (False, True):
        group = ramp.group(color=color)
        made[group.name] = group
    for build in (trajectory.build, partial(trajectory.build_osl, title="test")):
        name = f"{trajectory.NAME} {'build_osl' if isinstance(build, partial) else 'build'}"
        made[name] = nodegroups.ensure(name, 1, partial(build, keys=KEYS))
    return made


def sockets_of(group):
    return [item for item in group.interface.items_tree if item.item_type == "SOCKET"]


def test_every_socket_has_a_tooltip_and_every_number_a_range(blender):
    """What artists see is explained and cannot be set where the model does not hold."""
    for name, group in all_groups().items():
        for item in sockets_of(group):
            assert item.description, (name, item.name)
            if item.in_out == "INPUT" and item.socket_type == "NodeSocketFloat":
                assert item.min_value < item.max_value < float("inf"), (name, item.name)
                assert item.min_value <= item.default_value <= item.max_value, (name, item.name)


def test_both_backends_show_the_same_inputs(blender):
    """The OSL group and the node group of an estimator differ in nothing that an artist sees."""
    made = all_groups()
    for name, group in made.items():
        if name.endswith(" build"):
            twin = made[f"{name}_osl"]
            assert [(i.name, i.socket_type, i.in_out, i.description) for i in sockets_of(group)] == [
                (i.name, i.socket_type, i.in_out, i.description) for i in sockets_of(twin)
            ], name


def test_nodes_do_not_lie_on_top_of_each_other(blender):
    """Groups are laid out for people: columns from left to right, no two nodes in one place."""
    for name, group in all_groups().items():
        places = [tuple(node.location) for node in group.nodes if node.bl_idname != "NodeFrame"]
        assert len(places) == len(set(places)), name
        for link in group.links:
            assert link.from_node.location_absolute.x < link.to_node.location_absolute.x, name


@pytest.mark.parametrize("shader", SHADERS)
def test_every_shader_compiles_and_explains_its_parameters(blender, shader, tmp_path):
    """By Cycles' own compiler; ranges and defaults agree with the node group's."""
    import _cycles
    import oslquery

    path = tmp_path / f"{shader}.osl"
    path.write_text(osl_script.source(shader), encoding="utf-8")
    with headless.quiet():
        assert _cycles.osl_compile(str(path), str(tmp_path / f"{shader}.oso"))
    query = oslquery.OSLQuery(str(tmp_path / f"{shader}.oso"))
    parameters = {p.name: p for p in query.parameters}
    if not shader.startswith("cook_torrance"):
        return
    estimator = {
        "fit": cook_torrance_fit,
        "closure": cook_torrance_closure,
        "mirror": cook_torrance_mirror,
        "direct": cook_torrance_direct,
    }
    module = estimator[shader.rpartition("_")[2]]
    for kind in fresnel.KINDS:
        more = {} if module in (cook_torrance_fit, cook_torrance_closure) else {"lamps": 0}
        group = nodegroups.ensure(f"{shader} {kind}", 1, partial(module.build_osl, kind=kind, **more))
        items = {item.name: item for item in sockets_of(group)}
        for one in (*models.fresnel.KINDS[kind].parameters, SLOPE):
            item, parameter, of_input = items[one.label], parameters[one.name], one.scale.of_input
            given = np.ravel(parameter.value)[:3]
            shown = of_input(np.ravel(item.default_value)[: len(given)])
            np.testing.assert_allclose(shown, given, rtol=1e-6)
            metadata = {meta.name: meta.value for meta in parameter.metadata}
            assert metadata.get("label") == (one.symbol or one.label)
            if item.socket_type == "NodeSocketFloat":
                ends = [of_input(end) for end in (item.min_value, item.max_value)]
                assert [metadata["min"], metadata["max"]] == pytest.approx(ends)


@pytest.mark.parametrize("course", KEYS.values(), ids=["number", "color"])
def test_the_shader_of_a_course_has_its_groups_ranges_and_defaults(blender, course, tmp_path):
    """Age, Rate and Offset; and as many keys as the course."""
    import _cycles
    import oslquery

    path = tmp_path / "trajectory.osl"
    path.write_text(osl_script.source("trajectory", {trajectory.TABLE: trajectory.table(course)}), encoding="utf-8")
    with headless.quiet():
        assert _cycles.osl_compile(str(path), str(tmp_path / "trajectory.oso"))
    parameters = {p.name: p for p in oslquery.OSLQuery(str(tmp_path / "trajectory.oso")).parameters}
    assert len(parameters["ages"].value) == len(course)
    group = nodegroups.ensure(trajectory.NAME, 1, partial(trajectory.build, keys=KEYS))
    for item in sockets_of(group):
        if item.in_out == "INPUT":
            metadata = {meta.name: meta.value for meta in parameters[item.name].metadata}
            assert metadata["label"] == item.name
            assert parameters[item.name].value == item.default_value
            assert (metadata["min"], metadata["max"]) == (item.min_value, item.max_value)


def test_a_group_of_another_revision_is_not_reused(blender):
    """A saved file's older group keeps serving its materials; new ones get the new group."""
    module = fresnel.KINDS["schlick"]
    old = nodegroups.ensure(module.NAME, 0, module.build)
    new = nodegroups.ensure(module.NAME, module.REVISION, module.build)
    assert old is not new
    assert nodegroups.ensure(module.NAME, module.REVISION, module.build) is new
    assert nodegroups.ensure(module.NAME, 0, module.build) is old
