# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF Viewer's plots: their numbers are the reference's, and so are those in the files that are written."""

import csv
import xml.etree.ElementTree as ET
from math import radians

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image

from vgroove import headless
from vgroove.addon.blender import lobes, material, measuring
from vgroove.addon.library import presets
from vgroove.addon.measured import curves
from vgroove.addon.reference import albedo, lobe, spherical

pytestmark = pytest.mark.blender
COPPER = presets.find("lecture/copper")
THETA, PHI = 60.0, 20.0
INK = (0.1, 0.1, 0.1, 1.0)


@pytest.fixture
def stage(extension):
    """The default scene, its cube of copper, all plots, light from two angles."""
    extension.context.object.active_material = material.build(COPPER, material.Choice())
    settings = extension.context.scene.vgroove_viewer
    settings.light_from, settings.theta, settings.phi, settings.show = "ANGLES", radians(THETA), radians(PHI), True
    settings.plots = set(measuring.PLOTS)
    return extension


def wi_of(bpy):
    from vgroove.addon.ui import viewer

    return viewer.toward_light(bpy.context.scene, None, viewer.frame(bpy.context.scene))


def curves_of(bpy, plot):
    from vgroove.addon.ui import viewer_draw

    return viewer_draw.plot_curves(bpy.context, plot, wi_of(bpy))


@pytest.mark.parametrize(("plot", "phi"), [(measuring.PLANE, PHI), (measuring.ACROSS, PHI + 90.0)])
def test_a_slice_is_the_reference_s(stage, plot, phi):
    (one,) = curves_of(stage, plot)
    expected = COPPER.reference().evaluate(wi_of(stage), lobe.slice_directions(one.at, phi))
    assert_allclose(one.rgb, expected, rtol=1e-5, atol=1e-30)  # m passes through float32
    wi = wi_of(stage)
    made = stage.context.object.active_material
    assert lobes.curve_of(made, wi, plot) is lobes.curve_of(made, wi, plot)


def test_theta_h_is_the_reference_s(stage):
    (one,) = curves_of(stage, measuring.THETA_H)
    wi, wo = curves.pairs(one.at, np.full_like(one.at, THETA), curves.View(THETA, PHI))
    assert_allclose(one.rgb, COPPER.reference().evaluate(wi, wo), rtol=1e-4, atol=1e-30)
    assert_allclose(np.degrees(np.arccos((wi + wo)[0, 2] / np.linalg.norm((wi + wo)[0]))), 0.0, atol=1e-6)


@pytest.mark.parametrize("identity", ["lecture/copper", "ceramics/bone_china", "diffuse/plaster"])
def test_the_albedo_is_within_what_it_says(stage, identity):
    """+-0.003, RGB, at a few of its angles."""
    stage.context.object.active_material = material.build(presets.find(identity), material.Choice())
    (one,) = curves_of(stage, measuring.ALBEDO)
    some = slice(None, None, 9)
    expected = albedo(presets.find(identity).reference(), spherical(np.radians(one.at[some]), 0.0 * one.at[some]))
    assert_allclose(one.rgb[some], expected, rtol=0.0, atol=3e-3)


def test_a_smooth_coat_has_no_albedo_curve(stage):
    """f does not hold what it mirrors."""
    stage.context.object.active_material = material.build(
        presets.find("ceramics/bone_china").with_parameters(m=0.0), material.Choice()
    )
    assert curves_of(stage, measuring.ALBEDO) == []
    assert len(curves_of(stage, measuring.PLANE)) == 1


@pytest.mark.parametrize("log", [False, True])
def test_the_plot_names_its_peak_and_scale(stage, log):
    """As long as the peak at the peak; the light at the left."""
    from vgroove.addon.ui import viewer_draw, viewer_plots

    stage.context.scene.vgroove_viewer.log = log
    plots = viewer_draw.plots(stage.context, wi_of(stage), INK)
    (one,) = curves_of(stage, measuring.PLANE)
    values = lobe.channel_of(one.rgb, "luminance")
    points, color, _ = plots[0].lines[-1]
    assert color[:3] == viewer_draw.COLORS[0]
    away = (points - viewer_plots.CENTRE) / viewer_plots.RADIUS
    far = np.hypot(*away.T)
    assert far.max() == pytest.approx(1.0, abs=1e-9)
    assert np.degrees(np.arctan2(*away[far.argmax()])) == pytest.approx(one.at[values.argmax()], abs=1e-6)
    light = next(points for points, of, _ in plots[0].lines if of == viewer_plots.GOLD)
    assert np.degrees(np.arctan2(*(light[1] - viewer_plots.CENTRE))) == pytest.approx(-THETA, abs=1e-4)
    texts = [text for text, *_ in plots[0].words]
    peak = values.max()
    assert f"peak {peak:.3g} at {one.at[values.argmax()]:.1f}°" in texts
    assert f"{peak:.2g}" in texts
    assert f"{peak * (1e-2 if log else 0.5):.2g}" in texts
    assert not [of for _, of, _ in plots[1].lines if of == viewer_plots.GOLD]  # the light is not in the slice across


def write(bpy, tmp_path, ending):
    with headless.quiet():
        done = bpy.ops.vgroove.export_plots(filepath=str(tmp_path / "plots"), file_format=ending)
    assert done == {"FINISHED"}
    return tmp_path / f"plots{ending}"


def measured(bpy, monkeypatch, factor=2.0):
    """Points that stand for a measurement: twice the formula."""
    from vgroove.addon.ui import viewer_measure

    one = curves_of(bpy, measuring.PLANE)[0]
    some = slice(len(one.at) // 2, None, 20)  # theta_h is not negative
    points = measuring.Points(one.at[some], factor * one.rgb[some], np.ones((len(one.at[some]), 2)))
    made = bpy.context.object.active_material
    kept = viewer_measure.Measured(wi_of(bpy), dict.fromkeys(measuring.PLOTS, points))
    monkeypatch.setitem(viewer_measure._measured, made.session_uid, kept)
    return points


def test_csv_has_the_numbers(stage, tmp_path, monkeypatch):
    """Every plot, formula and measured; luminance from R, G and B."""
    points = measured(stage, monkeypatch)
    rows = list(csv.DictReader(write(stage, tmp_path, ".csv").read_text(encoding="utf-8").splitlines()))
    assert {row["plot"] for row in rows} == {"plane", "across", "albedo", "theta_h"}
    (line,) = (one for one in curves_of(stage, measuring.PLANE) if not one.measured)
    for source, at, rgb in (("formula", line.at, line.rgb), ("measured", points.at, points.rgb)):
        mine = [row for row in rows if (row["plot"], row["source"]) == ("plane", source)]
        assert {row["material"] for row in mine} == {"Copper"}
        assert_allclose([float(row["angle (deg)"]) for row in mine], at, rtol=1e-8)
        assert_allclose([[float(row[c]) for c in "RGB"] for row in mine], rgb, rtol=1e-8)
        assert_allclose([float(row["Y"]) for row in mine], rgb @ lobe.LUMINANCE, rtol=1e-8)


def test_svg_is_well_formed_and_has_lines_and_points(stage, tmp_path, monkeypatch):
    from vgroove.addon.ui import viewer_draw

    points = measured(stage, monkeypatch)
    root = ET.parse(write(stage, tmp_path, ".svg")).getroot()  # noqa: S314 - our own
    plots = viewer_draw.plots(stage.context, wi_of(stage), INK)
    assert len(root.findall(".//{*}polyline")) == sum(len(one.lines) for one in plots)
    assert len(root.findall(".//{*}circle")) == 4 * len(points.at)
    assert "Plane of incidence, f in 1/sr" in [one.text for one in root.findall(".//{*}text")]


def test_png_is_a_picture(tmp_path):
    """As another program reads it."""
    from vgroove.addon.ui import viewer_export

    rgb = np.arange(7 * 5 * 3, dtype=np.uint8).reshape(7, 5, 3)
    path = tmp_path / "plain.png"
    path.write_bytes(viewer_export.png(rgb))
    assert np.array_equal(np.asarray(Image.open(path)), rgb)


def test_what_cannot_be_written_is_told(stage, tmp_path):
    with headless.quiet(), pytest.raises(RuntimeError, match="cannot be written"):
        stage.ops.vgroove.export_plots(filepath=str(tmp_path / "no" / "plots"), file_format=".svg")
    stage.context.scene.vgroove_viewer.plots = set()
    assert not stage.ops.vgroove.export_plots.poll()
