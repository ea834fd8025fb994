# SPDX-License-Identifier: GPL-3.0-or-later
"""The page in Chromium: it draws, its numbers are the reference's, and its controls do what they say."""

import importlib.util
import json
import re
import sys
from pathlib import Path
from urllib.parse import quote, unquote

import numpy as np
import pytest

from vgroove.addon.library import presets
from vgroove.addon.reference import albedo, spherical
from vgroove.viewer import page


def _load(name):
    """A script of tools/."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).parents[2] / "tools" / f"{name}.py")
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


browser, axe = _load("browser"), _load("axe")

NAMES = ("copper", "diffuse/plaster", "bone_china", "alum_bronze_merl", "vinyl_record", "car_paints/blue", "alabaster",
         "phong/phong_red_plastic")  # fmt: skip
REC_709 = np.array([0.2126, 0.7152, 0.0722])


@pytest.fixture(scope="module")
def chromium(tmp_path_factory):
    """Running; where it cannot be installed, an error of one line, not a skip."""
    try:
        running = browser.Browser(tmp_path_factory.mktemp("profile"))
    except browser.UnavailableError as error:
        pytest.exit(str(error), returncode=3)
    yield running
    running.close()


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A page of eight BRDFs."""
    written = tmp_path_factory.mktemp("page") / "page.html"
    found = [presets.find(name) for name in NAMES]
    written.write_text(page.page([(one.name, one) for one in found]), encoding="utf-8")
    return written


@pytest.fixture(scope="module")
def opened(chromium, path):
    """The page, drawn."""
    assert chromium.open(path) == []
    return chromium


def luminance(name, wi, wo):
    return float(presets.find(name).reference().evaluate(wi, wo) @ REC_709)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (420, 900)])
def test_it_draws_without_an_error(chromium, path, size, scheme):
    """From a file, in both colour schemes, wide and narrow: nothing sticks out, and no canvas is blank."""
    assert chromium.open(path, size=size, scheme=scheme) == []
    found = chromium.run(
        """handle.state().log = true; // lobes that fill the picture
        handle.changed();
        for (let k = 0; k < 2; k++) await new Promise(requestAnimationFrame);
        return {lines: [...document.querySelectorAll("path.curve")].map((one) => one.getTotalLength()),
          wide: document.documentElement.scrollWidth, back: getComputedStyle(document.body).backgroundColor,
          inks: [...document.querySelectorAll("canvas")].map((canvas) => {
            const copy = document.createElement("canvas");
            Object.assign(copy, {width: 64, height: 64});
            const context = copy.getContext("2d");
            context.drawImage(canvas, 0, 0, 64, 64);
            return new Set(new Uint32Array(context.getImageData(0, 0, 64, 64).data.buffer)).size;
          })};"""
    )
    assert found["wide"] <= size[0]
    assert len(found["lines"]) >= 4 * len(NAMES)
    assert min(found["lines"]) > 20.0
    assert len(found["inks"]) == 4
    assert min(found["inks"]) > 50  # different colours
    assert (sum(map(int, re.findall(r"\d+", found["back"])[:3])) < 384) == (scheme == "dark")


@pytest.mark.parametrize("index", range(len(NAMES)))
def test_values_are_the_references(opened, index):
    """What plots draw, at directions all around."""
    rng = np.random.default_rng(3)
    for _ in range(4):
        wi, wo = (spherical(*(rng.random(2) * [1.4, 6.28])) for _ in range(2))
        found = opened.run(f"return handle.value({index}, {wi.tolist()}, {wo.tolist()})")
        assert found == pytest.approx(luminance(NAMES[index], wi, wo), rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("index", [0, 1, 2, 5])
@pytest.mark.parametrize("theta", [0.0, 0.8, 1.3])
def test_albedo_is_within_what_it_says(opened, index, theta):
    """+-0.003."""
    wo = spherical(theta)
    found = opened.run(f"return handle.albedo({index}, {wo.tolist()})")
    np.testing.assert_allclose(found, albedo(presets.find(NAMES[index]).reference(), wo), rtol=0.0, atol=3e-3)


def test_the_value_under_the_pointer_is_shown_with_its_unit(opened):
    """At theta_o = 0 of the plane of incidence, light at 45 degrees."""
    text = opened.run(
        """const plot = document.querySelectorAll(".plot")[2], box = plot.getBoundingClientRect();
        const ticks = [...plot.querySelectorAll("text")];
        const at = ticks.find((one) => one.textContent === "0°").getBoundingClientRect();
        plot.dispatchEvent(new PointerEvent("pointermove", {clientX: at.x + at.width / 2, clientY: box.y + 50}));
        return plot.nextSibling.textContent;"""
    )
    angle = float(re.search(r"θo (−?[\d.]+)°", text)[1].replace("−", "-"))
    assert abs(angle) < 1.5
    assert text.endswith("1/sr")
    shown = float(re.search(r"°([\d.]+?)(?=0\.|\d\.)", text)[1])
    wo = spherical(abs(np.radians(angle)), np.pi if angle >= 0 else 0.0)
    assert shown == pytest.approx(luminance("copper", spherical(np.pi / 4), wo), rel=0.05)  # the angle has one digit


def test_the_link_holds_the_state(chromium, path):
    """Angles, scale, what is shown, and changed parameters; opened again, it is the same."""
    chromium.open(path)
    chromium.run(
        """const state = handle.state();
        Object.assign(state, {thetaI: 63, log: true, times: "cos_io"});
        state.brdfs[1].shown = false;
        state.brdfs[0].form.parameters.m = 0.123;
        handle.changed();"""
    )
    chromium.run(f"await new Promise((r) => setTimeout(r, 300)); return {browser.DRAWN}")
    link = chromium.run("return location.hash")
    assert "0.123" in unquote(link)
    assert chromium.open(path, fragment=link) == []
    state = chromium.run(
        """const {thetaI, log, times, brdfs} = handle.state();
        return [thetaI, log, times, brdfs.map((b) => [b.name, b.shown, b.form.parameters.m])];"""
    )
    assert state[:3] == [63, True, "cos_io"]
    assert state[3][0] == ["Copper", True, 0.123]
    assert state[3][1][1] is False
    other = "#" + quote(json.dumps([99, [], []]))
    assert chromium.open(path, fragment=other) == []
    assert chromium.run("return handle.state().thetaI") == 45


def test_keys_and_sliders_work(opened):
    """L, M, 1, Shift 2, and the slider of copper's slope."""
    found = opened.run(
        """const press = (code, key, shiftKey = false) =>
          document.body.dispatchEvent(new KeyboardEvent("keydown", {code, key, shiftKey, bubbles: true}));
        press("KeyL", "l"); press("KeyM", "m"); press("Digit1", "1"); press("Digit2", "2", true);
        const slider = document.querySelector('[aria-label="Slope m, slider"]');
        slider.value = 0;
        slider.dispatchEvent(new Event("input"));
        const {log, times, brdfs} = handle.state();
        return [log, times, brdfs[0].shown, brdfs[1].solo, brdfs[0].form.parameters.m];"""
    )
    assert found == [True, "cos_o", False, True, 1e-4]


def test_everything_that_can_be_focused_has_a_name(opened):
    """As assistive technology reads the page."""
    nodes = opened.call("Accessibility.getFullAXTree")["nodes"]
    focusable = [
        one for one in nodes if any(p["name"] == "focusable" and p["value"]["value"] for p in one.get("properties", []))
    ]
    assert len(focusable) > 40
    assert [one["role"]["value"] for one in focusable if not one.get("name", {}).get("value")] == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_no_serious_fault(chromium, path, scheme):
    """As the page opens, and with one BRDF alone; a control without a name is found."""
    chromium.open(path, scheme=scheme)
    assert axe.serious(chromium) == []
    chromium.run("document.querySelector('button.solo').click()")
    assert axe.serious(chromium) == []
    chromium.run("document.querySelector('[aria-label=Channel]').removeAttribute('aria-label')")
    assert [rule for _, rule, *_ in axe.serious(chromium)] == ["select-name"]


def test_it_prints_on_white_with_its_names(chromium, path):
    """Also where the screen is dark: names stand above the plots, and controls that do nothing on paper are gone."""
    chromium.open(path, scheme="dark", media="print", size=(794, 1123))
    found = chromium.run(
        """const seen = (one) => one.getClientRects().length > 0, top = (one) => one.getBoundingClientRect().top;
        return {back: getComputedStyle(document.body).backgroundColor,
          names: [...document.querySelectorAll(".item .name")].filter(seen).length,
          below: top(document.querySelector("main")) - top(document.querySelector("aside")),
          wide: document.documentElement.scrollWidth,
          rest: [...document.querySelectorAll("#view button, .group, .solo, .remove, .add")].filter(seen).length};"""
    )
    assert (found["back"], found["names"], found["rest"]) == ("rgb(255, 255, 255)", len(NAMES), 0)
    assert found["below"] > 0
    assert found["wide"] <= 794
