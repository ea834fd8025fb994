# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of BRDFs and the numbers behind them."""

import csv
import io
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from vgroove.addon.library import presets
from vgroove.addon.library.errors import InputError
from vgroove.addon.measured import Merl, tabulate
from vgroove.addon.measured.curves import MOST, csv_text, numbers
from vgroove.addon.measured.merl import half_and_difference
from vgroove.addon.reference import Anisotropic, CookTorrance, Lambert, OrenNayar, Schlick, albedo, lobe, spherical
from vgroove.lab import plots

COPPER = CookTorrance(0.3, Schlick((0.95, 0.64, 0.54)))
GREY = Lambert([0.6, 0.3, 0.1])


def test_head_on_light_has_an_azimuth_too():
    """Along which a brushed surface is cut."""
    brushed = Anisotropic(0.5, 0.1, Schlick(0.9))
    along, across = (
        numbers("polar", {"": brushed}, plots.View(theta_i=0.0, phi_i=phi)).rgb[""][:, 0] for phi in (0.0, 90.0)
    )
    assert (along > 0.5 * along.max()).sum() > 2 * (across > 0.5 * across.max()).sum()


def direction(theta_o, phi_i=0.0, phi_o=0.0):
    """theta_o in degrees is positive on the mirror's side."""
    turn = 180.0 if theta_o >= 0 else 0.0
    return spherical(np.radians(abs(theta_o)), np.radians(phi_i + phi_o + turn))


def test_a_slice_holds_the_reference():
    view = plots.View(theta_i=60.0, phi_i=20.0, phi_o=30.0, times="cos_o")
    found = numbers("polar", {"copper": COPPER, "grey": GREY}, view)
    assert found.axes == ("theta_o",)
    for k in range(0, len(found.at), 37):
        theta = found.at[k, 0]
        wo = direction(theta, 20.0, 30.0)
        expected = COPPER.evaluate(view.wi, wo) * wo[2]
        np.testing.assert_allclose(found.rgb["copper"][k], expected, rtol=1e-12)
        np.testing.assert_allclose(found.rgb["grey"][k], np.array([0.6, 0.3, 0.1]) / np.pi * wo[2], rtol=1e-12)


@pytest.mark.parametrize("m", [0.001, 0.02, 0.3])
def test_a_slice_finds_the_peak(m):
    """Of lobes however narrow, to a thousandth, and its shape: angles are dense about the mirror direction."""
    view = plots.View(theta_i=30.0)
    values = numbers("polar", {"": CookTorrance(m, Schlick(0.9))}, view).rgb[""][:, 0]
    found = values.max()
    assert (values > 0.5 * found).sum() > 30
    near = np.radians(30.0 + 40.0 * m * np.linspace(-1.0, 1.0, 20001))
    best = CookTorrance(m, Schlick(0.9)).evaluate(view.wi, spherical(near, np.pi))[:, 0].max()
    assert found == pytest.approx(best, rel=1e-3)


@pytest.mark.parametrize(("plot", "axis"), [("theta_h", 0), ("theta_d", 1)])
def test_curves_of_half_and_difference_angles_hold_the_reference(plot, axis):
    """As the pairs of directions at these angles give it, computed here from the definition of the angles."""
    view = plots.View(theta_i=40.0, theta_h=25.0, phi_d=70.0)
    found = numbers(plot, {"": COPPER}, view)
    at = found.at[:, 0]
    angles = [np.full_like(at, 25.0), np.full_like(at, 40.0)]
    angles[axis] = at
    theta_h, theta_d, phi_d = (np.radians(one) for one in (*angles, np.full_like(at, 70.0)))
    in_h = spherical(theta_d, phi_d)
    y, z = np.array([0.0, 1.0, 0.0]), spherical(theta_h)
    wi = in_h[:, :1] * np.cross(y, z) + in_h[:, 1:2] * y + in_h[:, 2:] * z
    wo = 2.0 * in_h[:, 2:] * z - wi
    np.testing.assert_allclose(found.rgb[""], COPPER.evaluate(wi, wo), rtol=1e-9)
    again = half_and_difference(wi, wo)
    np.testing.assert_allclose(np.degrees(again[axis]), at, atol=1e-9)


def test_the_image_is_dark_grey_below_the_horizon_and_the_reference_above():
    """With phi_d of 0 light or view go below at theta_h + theta_d of 90 degrees."""
    found = numbers("slice", {"": GREY}, plots.View(phi_d=0.0))
    below = found.at.sum(axis=-1) > 90.0
    assert (np.isnan(found.rgb[""]).all(axis=-1) == below).all()
    lit = found.rgb[""][~below]
    np.testing.assert_allclose(lit, np.broadcast_to(np.array([0.6, 0.3, 0.1]) / np.pi, lit.shape), rtol=1e-12)


def test_the_albedo_is_the_reference_s():
    found = numbers("albedo", {"copper": COPPER}, plots.View())
    k = len(found.at) // 2
    wo = spherical(np.radians(found.at[k, 0]))
    np.testing.assert_allclose(found.rgb["copper"][k], albedo(COPPER, wo), rtol=1e-12)
    assert (found.unit, found.quantity) == ("", "albedo")


def test_a_measured_brdf_is_plotted_beside_a_model():
    """A table of Lambert: 5e-3, as its summary's albedo."""
    table = Merl(tabulate(GREY.evaluate))
    found = numbers("albedo", {"table": table}, plots.View())
    expected = np.broadcast_to([0.6, 0.3, 0.1], (len(found.at), 3))
    np.testing.assert_allclose(found.rgb["table"], expected, rtol=5e-3)
    both = numbers("polar", {"table": table, "model": GREY}, plots.View())
    np.testing.assert_allclose(both.rgb["table"], both.rgb["model"], rtol=1e-9)


def test_cook_torrance_at_grazing_light_peaks_off_the_mirror_direction():
    found = numbers("theta_o", {"": COPPER}, plots.View(theta_i=70.0))
    assert found.at[found.rgb[""][:, 0].argmax(), 0] > 80.0


def test_oren_nayar_scatters_back():
    found = numbers("theta_o", {"": OrenNayar(0.8, 0.5)}, plots.View(theta_i=60.0))
    assert found.at[found.rgb[""][:, 0].argmax(), 0] < -50.0


@pytest.mark.parametrize("plot", plots.PLOTS)
def test_csv_names_units_and_holds_what_is_drawn(plot):
    view = plots.View(theta_i=30.0)
    shown = numbers(plot, {"copper, satin": COPPER, "grey": GREY}, view)
    note, *rows = csv_text(plot, shown, view).splitlines()
    assert note.startswith(f"# {plot}: theta_i = 30 deg, ")
    head, *lines = csv.reader(io.StringIO("\n".join(rows)))
    assert head[: len(shown.axes)] == [f"{axis} (deg)" for axis in shown.axes]
    assert head[len(shown.axes)] == ("copper, satin albedo R" if plot == "albedo" else "copper, satin f R (1/sr)")
    values = np.array(lines, dtype=float)
    assert len(values) == shown.at[..., 0].size
    np.testing.assert_allclose(values[:, : len(shown.axes)], shown.at.reshape(len(values), -1), rtol=1e-8)
    copper = shown.rgb["copper, satin"].reshape(-1, 3)
    start = len(shown.axes)
    np.testing.assert_allclose(values[:, start : start + 3], copper, rtol=1e-8)
    np.testing.assert_allclose(values[:, start + 3], copper @ lobe.LUMINANCE, rtol=1e-8)


@pytest.mark.parametrize("plot", plots.PLOTS)
@pytest.mark.parametrize(("channel", "log"), [("luminance", False), ("rgb", True)])
def test_figures_are_drawn_the_same_each_time(plot, channel, log):
    """As SVG to the byte, with the names in them; as PNG too."""
    brdfs = {"copper": COPPER, "grey one": GREY}

    def once():
        figure = plots.draw(plot, brdfs, plots.View(theta_i=60.0), channel=channel, log=log)
        return plots.svg(figure), plots.png(figure)

    (svg, png), again = once(), once()
    assert (svg, png) == again
    words = "".join(ET.fromstring(svg).itertext())  # noqa: S314 - our own
    assert "copper" in words
    assert "grey one" in words
    assert png.startswith(b"\x89PNG")


def test_the_colours_of_a_figure_are_as_many_as_brdfs():
    brdfs = {f"grey {k}": Lambert((k + 1) / 10.0) for k in range(MOST)}
    lines = plots.draw("theta_o", brdfs).axes[0].get_lines()
    assert len({line.get_color() for line in lines[:MOST]}) == MOST
    with pytest.raises(InputError, match="shows 1 to 8 BRDFs, got 9"):
        plots.draw("polar", brdfs | {"one more": GREY})


@pytest.mark.parametrize("plot", plots.PLOTS)
def test_any_name_is_shown_letter_by_letter(plot):
    """Where $ would begin a formula, and Matplotlib leaves names with _ out of legends."""
    svg = plots.svg(plots.draw(plot, {"_a": GREY, "b$_{$": GREY}))
    words = "".join(ET.fromstring(svg).itertext())  # noqa: S314 - our own
    assert "_a" in words
    assert "b$_{$" in words


def test_black_is_drawn_too():
    for plot in plots.PLOTS:
        for log in (False, True):
            assert plots.png(plots.draw(plot, {"black": Lambert(0.0)}, log=log))


def test_a_smooth_mirror_is_refused_but_its_albedo_is_not():
    window = {"window": presets.find("window")}
    with pytest.raises(InputError, match=r"window: is a smooth mirror.*or choose --plot albedo"):
        plots.draw("polar", window)
    assert numbers("albedo", window, plots.View()).rgb["window"].max() > 0.0
