# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds of every model, by its spec alone: a new one is tested here as soon as its file is there."""

from dataclasses import replace

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, material
from vgroove.addon.blender.material import Choice, build, lamps_to_bind
from vgroove.addon.choose import automatic
from vgroove.addon.library import presets, writing
from vgroove.addon.models import MODELS, PARAMETERS, estimators, fresnel, label, parameter
from vgroove.addon.reference import albedo, rendered, spherical
from vgroove.lab.check import plan
from vgroove.lab.sidak import chance
from vgroove.nodegroups import osl_script

from ..chi_square import chi_square, draw, viewer


def examples():
    """A preset of every model and kind, with the numbers that its sockets start at; of what has lobes one lobe."""
    for name, model in MODELS.items():
        for kind in model.kinds:
            terms = fresnel.KINDS[kind].parameters if model.has_fresnel else ()
            numbers = {one.name: one.default for one in (*model.parameters, *terms)}
            numbers |= {f"{one.name}_1": one.default for one in model.lobes}
            if (name, kind) == ("ashikhmin_shirley", "lambert"):  # by itself each number is as bright as it may be
                numbers["amplitude"] = (0.7, 0.6, 0.5)
            for flags in [(), *((flag,) for flag in model.flags)]:
                preset = presets.Preset(
                    f"test/{name}",
                    "Test",
                    name,
                    kind,
                    numbers,
                    {"data": "test"},
                    flags=flags,
                    distribution=model.distribution,
                    table=model.table,
                )
                if not model.flaw(preset):
                    yield preset


EXAMPLES = list(examples())
OPAQUE = [preset for preset in EXAMPLES if not preset.transparent]


def title(preset):
    return "-".join((preset.model, preset.kind, *preset.flags))


def pairs(count=60):
    """wi and wo over the upper hemisphere, (count, 3), none nearer the horizon than 0.6 degrees."""
    z, phi = np.random.default_rng(1982).random((2, 2, count))
    return (spherical(np.arccos(0.01 + 0.99 * z[k]), 2.0 * np.pi * phi[k]) for k in range(2))


def test_there_is_an_example_of_every_model():
    """Each model's own defaults go together."""
    assert {preset.model for preset in EXAMPLES} == set(MODELS)


@pytest.mark.parametrize("name", MODELS)
def test_a_spec_names_only_what_there_is(name):
    """Its file's name, estimators of the list, models of the registry."""
    model = MODELS[name]
    assert name == model.name
    assert set(model.estimators) <= set(estimators.ALL)
    assert {*model.most_lights, *model.most_lights_4_5, *model.upright} <= set(model.estimators)
    assert {part for _, part in model.parts} <= set(MODELS)
    assert not model.lobes or model.lobe_model in MODELS
    assert not model.smooth_estimator or model.smooth_estimator in model.estimators
    assert not model.has_fresnel or set(model.kinds) <= set(fresnel.KINDS)


@pytest.mark.parametrize("one", PARAMETERS.values(), ids=list(PARAMETERS))
def test_a_parameter_can_be_shown(one):
    """Label, tip, a range around its default, and the same range wherever its name is used."""
    assert one.label
    assert one.tip
    for value in np.atleast_1d(one.default):
        assert one.low <= value <= one.high
    for model in MODELS.values():
        for other in (*model.parameters, *model.lobes):
            if other.name == one.name:
                assert replace(other, default=one.default, tip=one.tip) == one


@pytest.mark.parametrize("preset", EXAMPLES, ids=title)
def test_a_preset_is_written_and_read_back(preset):
    """Every number of the spec goes through a file."""
    assert presets.parse(writing.dumps(preset), preset.id, "test") == preset


@pytest.mark.parametrize("preset", OPAQUE, ids=title)
def test_values_are_finite_and_reciprocal(preset):
    """f(wi, wo) = f(wo, wi) >= 0. Not of what gives the rest of one part to another, which asks for wo alone."""
    wi, wo = pairs()
    model = preset.reference()
    f, back = model.evaluate(wi, wo), model.evaluate(wo, wi)
    assert f.shape == (*wi.shape[:-1], 3)
    assert np.isfinite(f).all()
    assert (f >= 0.0).all()
    if not getattr(model, "coupled", False):
        # tan^2 and 1/cos of a facet 0.6 degrees above the horizon lose 1e4 of 2^-53, a few times over.
        np.testing.assert_allclose(f, back, rtol=1e-11)


@pytest.mark.parametrize("preset", OPAQUE, ids=title)
def test_no_more_light_leaves_than_arrives(preset):
    """The directional albedo is between 0 and 1 at every view to 89.5 degrees."""
    views = spherical(np.radians([0.0, 30.0, 60.0, 80.0, 89.5]), 0.0)
    E = albedo(preset.reference(), views)
    assert E.shape == (5, 3)
    assert (E >= 0.0).all()
    assert (E <= 1.0 + 1e-6).all()  # as near as an albedo is known


@pytest.mark.parametrize("preset", OPAQUE, ids=title)
def test_samples_are_drawn_as_pdf_says_and_weigh_f_cos_over_it(preset):
    """By chi-square over the hemisphere, and sample by sample."""
    model, wo = preset.reference(), viewer(50.0)
    wi, weight = draw(model, wo, 100_000, 24, OPAQUE.index(preset))
    assert chi_square(model, wo, wi) > chance(len(OPAQUE))
    wi, weight = wi[:2000], weight[:2000]
    above = wi[:, 2] > 1e-3
    f_cos = model.evaluate(wi, wo) * wi[:, 2:]
    density = model.pdf(wi, wo)[:, None]
    np.testing.assert_allclose((weight * density)[above], f_cos[above], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("preset", EXAMPLES, ids=title)
def test_every_estimator_says_what_it_renders(preset):
    """Finite, and of the model's shape."""
    wi, wo = pairs(50)
    for estimator in preset.spec.estimators:
        f = rendered(preset.reference(), estimator)(wi, wo)
        assert f.shape == (50, 3)
        assert np.isfinite(f).all()


@pytest.mark.parametrize("native", [False, True])
@pytest.mark.parametrize("name", [name for name, model in MODELS.items() if not model.is_compound])
def test_the_head_of_a_shader_has_every_parameter(name, native):
    """As its sockets have them, but for what belongs to the body."""
    head = osl_script.PARAMETERS[f"{name}{'_native' * native}_parameters.h"]
    for one in MODELS[name].parameters:
        assert (f'label = "{one.symbol or one.label}"' in head) != one.in_volume


# In Blender: the first kind of each model, and the others with `make test-all`

FIRST = {preset.model: preset for preset in reversed(EXAMPLES)}
BUILT = [
    pytest.param(preset, id=title(preset), marks=[] if preset == FIRST[preset.model] else [pytest.mark.more])
    for preset in EXAMPLES
]


@pytest.mark.blender
@pytest.mark.parametrize("preset", BUILT)
def test_every_estimator_builds_and_renders_in_nodes_and_osl(instrument, preset):
    """Finite and not black under a white sky and a sun; the same by nodes and OSL where nothing is drawn at random."""
    for estimator in preset.spec.estimators:
        images = []
        for osl in (False, True):
            with headless.quiet(), gonio.stage((8, 8), samples=16, seed=0, shading_osl=osl) as stage:
                gonio.light(stage, gonio.Geometry(furnace=True))
                sun = instrument.data.objects.new("Sun", instrument.data.lights.new("Sun", "SUN"))
                sun.data.angle *= estimator != "direct"  # a point at random on it would be noise
                stage.collection.objects.link(sun)
                bound = lamps_to_bind(stage, estimator, preset.model)
                choice = Choice("osl" if osl else "nodes", estimator, bound, shadows=False)
                geometry = gonio.Geometry(20.0, resolution=(8, 8))
                gonio._patch(stage, build(preset, choice), geometry)
                gonio._camera(stage, geometry)
                images.append(gonio.rendered(stage))
        assert all(np.isfinite(image).all() for image in images)
        assert all((image >= 0.0).all() for image in images)
        assert all(image.mean() > 1e-3 for image in images)
        if estimator == "direct":  # without noise: the same but for float32, OSL's fast functions included
            np.testing.assert_allclose(images[0], images[1], rtol=1e-4, atol=1e-5 * images[0].max())
        if estimator in {"closure", "fit"} and not preset.transparent:
            # 16 samples of the sky leave a percent of noise, which both share, as they draw the same directions
            assert np.mean(images[0]) == pytest.approx(np.mean(images[1]), rel=0.02)


@pytest.mark.blender
@pytest.mark.parametrize("preset", BUILT)
def test_sockets_have_the_specs_ranges_and_tips(instrument, preset):
    """What an artist sees is what the spec says, by every estimator."""
    for estimator in preset.spec.estimators:
        group = material.group_of(preset, Choice("nodes", estimator))
        items = {item.name: item for item in group.interface.items_tree if item.item_type == "SOCKET"}
        for key in preset.parameters:
            one, item = parameter(key), items.get(label(preset.model, key))
            if item is None:
                assert one.in_volume
                continue
            assert item.description
            assert item.socket_type == f"NodeSocket{one.socket}"
            if one.socket == "Float":
                assert item.subtype == one.subtype
                low, high = sorted(map(one.scale.of_input, (item.min_value, item.max_value)))
                assert item.min_value < item.max_value
                assert low == pytest.approx(one.low, abs=1e-6)
                assert any(high == pytest.approx(of, rel=2e-6) for of in (one.high, one.native_high) if of is not None)


LOBE = ["Base Color", "Specular Color"]
GROOVES = ["Anisotropy", "Rotation", "Tangent"]
ORDER = {  # of an artist's inputs
    "phong": [*LOBE, "Roughness", "Normal"],
    "blinn_phong": [*LOBE, "Roughness", "Normal"],
    "ashikhmin_shirley": [*LOBE, "Specular Tint", "Roughness", *GROOVES, "Normal"],
}


@pytest.mark.blender
@pytest.mark.parametrize("preset", BUILT)
def test_sockets_are_the_same_in_both_backends_and_explained(instrument, preset):
    """Names in order, types and tooltips, by every estimator, with a light bound where it asks for one."""
    for estimator in preset.spec.estimators:
        with headless.quiet(), gonio.stage((8, 8), samples=1, seed=0, shading_osl=True) as stage:
            gonio.light(stage, gonio.Geometry(20.0))
            bound = lamps_to_bind(stage, estimator, preset.model)
            groups = [material.group_of(preset, Choice(backend, estimator, bound)) for backend in ("nodes", "osl")]
            nodes, osl = (
                [(item.name, item.in_out, item.socket_type, item.description)
                 for item in group.interface.items_tree if item.item_type == "SOCKET" and item.name != "EEVEE"]
                for group in groups
            )  # fmt: skip
        assert nodes == osl
        assert all(description for *_, description in nodes)
        inputs = [name for name, direction, *_ in nodes if direction == "INPUT"]
        assert inputs[: len(ORDER.get(preset.model, []))] == ORDER.get(preset.model, [])
        assert any(name.startswith("To Lamp") for name in inputs) == bool(bound)


@pytest.mark.blender
@pytest.mark.parametrize("preset", BUILT)
def test_automatic_picks_what_there_is(instrument, preset):
    """In a lit scene and in none."""
    shown = instrument.context.scene
    for scene in (shown, None):
        assert automatic.pick_estimator(scene, preset) in preset.spec.estimators


def test_the_quick_plan_has_rows_of_every_model():
    """``vgroove check --quick`` leaves no model out."""
    assert {plan.model_of(row) for row in plan.quick_plan()} >= set(MODELS)
