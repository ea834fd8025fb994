// SPDX-License-Identifier: GPL-3.0-or-later
// The page: plots, panel, keys and link, and when what is drawn.
import { brdf } from "./brdf.js";
import { linePlot, polarPlot } from "./curves.js";
import { degrees, fromHalfAndDifference, radians, spherical } from "./directions.js";
import { h } from "./dom.js";
import { albedo } from "./light.js";
import { lobePlot } from "./lobe.js";
import { panel } from "./panel.js";
import { slicePlot, spherePlot } from "./pictures.js";
import { CHANNELS, COLOURS, TIMES, digits, entry, initial, light, ofHash, toHash, value, visible } from "./state.js";

const UNIT = " 1/sr";
const STEP = 12, PAUSE = 200; // ms of pictures between two frames, and after the last change
const grid = (from, to, count) => Array.from({ length: count + 1 }, (_, k) => from + ((to - from) * k) / count);
const VIEWS = grid(-89.9, 89.9, 240), HALVES = grid(0, 89.9, 120).map((x) => (x * x) / 89.9), DIFFERENCES = grid(0, 89.9, 120);
const ALBEDOS = grid(0, 88, 22);

export function start(models, { registry, presets, shown: first }) {
  const opened = performance.now();
  let state = ofHash(location.hash, presets) ?? initial(presets.slice(0, first));
  const cache = new WeakMap(); // of an entry: its form as text, and its model
  const white = new WeakMap(); // of a model: its albedo, RGB at ALBEDOS
  const number = (name, low, high, label) => {
    const input = h("input", { type: "number", min: low, max: high, step: 1, value: state[name], "aria-label": label });
    input.addEventListener("input", () => { state[name] = Math.min(Math.max(Number(input.value) || 0, low), high); changed(); });
    return h("label", {}, label, input, "°");
  };

  const lobe = lobePlot("Lobe", { turn, light: lightTo, read: readLobe });
  const polar = polarPlot("Plane of incidence", "Slice in the plane of incidence, around the normal");
  const views = linePlot("Over θo", { range: [-90, 90], step: 30, symbol: "θo", label: "Over the angle of the viewer, in the plane of incidence" });
  const halves = linePlot("Over θh", { range: [0, 90], step: 15, symbol: "θh", label: "Over the half angle", aside: number("thetaD", 0, 89, "θd") });
  const differences = linePlot("Over θd", { range: [0, 90], step: 15, symbol: "θd", label: "Over the difference angle", aside: number("thetaH", 0, 89, "θh") });
  const albedos = linePlot("Albedo", { range: [0, 90], step: 15, symbol: "θo", label: "Directional albedo over the angle of the viewer" });
  const slice = slicePlot(number("phiD", 0, 180, "φd"));
  const studio = spherePlot("Studio", "Spheres under softboxes", true), lamp = spherePlot("One light", "Spheres under one light", false);
  const cards = [lobe, polar, views, halves, differences, albedos, slice, studio, lamp];
  document.getElementById("plots").append(...cards.map((one) => one.figure));

  const side = panel(document.getElementById("panel"), registry, presets, {
    changed: () => changed(),
    select(k) { state.selected = k; listed(); changed(); },
    show(k) { state.brdfs[k].shown = !state.brdfs[k].shown; listed(); changed(); },
    solo(k) { state.brdfs[k].solo = !state.brdfs[k].solo; listed(); changed(); },
    remove(k) { state.brdfs.splice(k, 1); state.selected = Math.max(Math.min(state.selected, state.brdfs.length - 1), 0); listed(); changed(); },
    add(one) {
      const used = new Set(state.brdfs.map(({ colour }) => colour));
      one.colour = COLOURS.findIndex((_, k) => !used.has(k));
      state.brdfs.push(one);
      state.selected = state.brdfs.length - 1;
      listed();
      changed();
    },
    reset() {
      const old = state.brdfs[state.selected];
      state.brdfs[state.selected] = { ...entry(presets, old.preset, old.colour), shown: old.shown, solo: old.solo };
      listed();
      changed();
    },
  });
  const bar = toolbar();
  listed();

  function listed() {
    for (const one of state.brdfs) one.colour_ = COLOURS[one.colour];
    side.items(state);
    side.numbers(state);
  }

  function modelOf(one) {
    const text = one.form.table ? "table" : JSON.stringify(one.form);
    const kept = cache.get(one);
    if (kept?.text === text) return kept.model;
    const model = brdf(one.form, registry.specs, models);
    cache.set(one, { text, model });
    return model;
  }

  const shown = () => visible(state).map((one) => ({ name: one.name, colour: one.colour_, model: modelOf(one) }));

  // Drawing: lobe and curves in the next frame, pictures in steps once nothing has changed for a moment.

  let frame = 0, dirty = false, rest = null, timer = 0, smooth = 0;
  function changed() {
    dirty = true;
    rest = null;
    clearTimeout(timer);
    later();
  }
  function later() { frame ||= requestAnimationFrame(draw); }

  function draw() {
    frame = 0;
    if (dirty) {
      curves();
      timer = setTimeout(() => { rest = pictures(); step(); }, PAUSE);
    }
    dirty = false;
    lobe.draw(state, false);
    clearTimeout(smooth);
    smooth = setTimeout(() => lobe.draw(state, true), PAUSE / 2);
    if (performance.getEntriesByName("first").length === 0) performance.measure("first", { start: opened, end: performance.now() });
  }

  function step() {
    const of = rest, end = performance.now() + STEP;
    if (!of) return;
    while (performance.now() < end) {
      if (of.next().done) { rest = null; document.body.dataset.drawn = "true"; return; }
    }
    setTimeout(step);
  }

  function curves() {
    delete document.body.dataset.drawn;
    const all = shown(), wi = light(state), phi = radians(state.phiI);
    const of = (pair) => all.map(({ name, colour, model }) => {
      const at = (x) => value(state, model, ...pair(x));
      return { name, colour, at };
    });
    const inPlane = of((x) => [wi, spherical(radians(Math.abs(x)), x >= 0 ? phi + Math.PI : phi)]);
    const sampled = (series, xs) => normalised(series.map((one) => ({ ...one, values: xs.map(one.at) })));
    const sub = TIMES[state.times].label + (state.channel === "luminance" ? "" : `, ${state.channel}`) + (state.own ? ", each to its peak" : "");
    const common = { log: state.log, unit: UNIT, sub };
    lobe.update(state, all);
    lobe.sub.textContent = sub;
    lobe.corner.textContent = all.length ? `${state.own ? "each to its own peak; the largest" : "outer ring"} ${digits(lobe.peak())}${UNIT}${state.log ? ", four decades" : ""}` : "Nothing is shown.";
    const around = sampled(inPlane, VIEWS);
    polar.draw(around, { ...common, xs: VIEWS, thetaI: state.thetaI });
    views.draw(around, { ...common, xs: VIEWS, mark: state.thetaI });
    const phiD = radians(state.phiD), [h0, d0] = [radians(state.thetaH), radians(state.thetaD)];
    halves.draw(sampled(of((x) => fromHalfAndDifference(radians(x), d0, phiD)), HALVES), { ...common, xs: HALVES, within: 75 });
    differences.draw(sampled(of((x) => fromHalfAndDifference(h0, radians(x), phiD)), DIFFERENCES), { ...common, xs: DIFFERENCES, within: 75 });
    bar(state);
  }

  /** Each to its own peak, if asked for. */
  function normalised(series) {
    if (!state.own) return series;
    return series.map((one) => {
      const peak = one.values.reduce((a, b) => Math.max(a, b), 0) || 1;
      return { ...one, values: one.values.map((v) => v / peak) };
    });
  }

  function* pictures() {
    try { history.replaceState(null, "", toHash(state, presets)); } catch { /* some viewers of files refuse */ }
    const all = shown(), pick = CHANNELS[state.channel], series = [];
    const one = state.brdfs[state.selected];
    yield* lamp.draw(state, all);
    if (one) yield* slice.draw(state, { model: modelOf(one), name: one.name });
    for (const { name, colour, model } of all) {
      const at = (x) => albedo(model, spherical(radians(Math.min(x, 89)))), known = white.get(model) ?? [];
      white.set(model, known);
      while (known.length < ALBEDOS.length) { known.push(at(ALBEDOS[known.length])); yield; }
      series.push({ name, colour, values: known.map(pick), at: (x) => pick(at(x)) });
    }
    albedos.draw(series, { xs: ALBEDOS, log: false, unit: "", sub: "share of a white sky, ±0.003", atLeast: 1 });
    if (one) side.warn(Math.max(...series.filter(({ name }) => name === one.name).flatMap(({ values }) => values), 0));
    yield* studio.draw(state, all);
  }

  function turn([azimuth, elevation]) {
    state.camera = [((azimuth % 360) + 360) % 360, Math.min(Math.max(elevation, 1), 89.5)];
    later();
  }

  function lightTo(thetaI, phiI) {
    state.thetaI = Math.round(Math.min(Math.max(thetaI, 0), 89));
    state.phiI = Math.round(((phiI % 360) + 360) % 360);
    changed();
  }

  function readLobe(read, { name, tint }, w, f, shownValue) {
    const [theta, phi] = [degrees(Math.acos(Math.min(w[2], 1))), (degrees(Math.atan2(w[1], w[0])) + 360) % 360];
    read.replaceChildren(h("i", { style: `background:${tint}` }), h("b", {}, name), `θo ${theta.toFixed(1)}° φo ${phi.toFixed(0)}° `,
      h("b", {}, `${digits(shownValue)}${UNIT}`), `f R ${digits(f[0])} G ${digits(f[1])} B ${digits(f[2])}`);
  }

  function toolbar() {
    const form = document.getElementById("view");
    form.addEventListener("submit", (event) => event.preventDefault());
    const range = (name, high, label) => {
      const input = h("input", { type: "range", min: 0, max: high, step: 1, "aria-label": `Light ${label}` }), out = h("output");
      input.addEventListener("input", () => { state[name] = Number(input.value); changed(); });
      form.append(h("label", {}, label, input, out));
      return () => { input.value = state[name]; out.textContent = `${state[name]}°`; };
    };
    const choice = (name, options, label) => {
      const input = h("select", { "aria-label": label }, ...options.map(([v, text]) => h("option", { value: v }, text)));
      input.addEventListener("change", () => { state[name] = input.value; changed(); });
      form.append(input);
      return () => { input.value = state[name]; };
    };
    const box = (name, text, title) => {
      const input = h("input", { type: "checkbox" });
      input.addEventListener("change", () => { state[name] = input.checked; changed(); });
      form.append(h("label", { title }, input, text));
      return () => { input.checked = state[name]; };
    };
    const all = [
      range("thetaI", 89, "θi"), range("phiI", 359, "φi"),
      choice("times", Object.entries(TIMES).map(([name, { label }]) => [name, label]), "Multiply"),
      choice("channel", Object.keys(CHANNELS).map((name) => [name, name]), "Channel"),
      box("log", "log", "Logarithm: four decades below the peak"), box("own", "own peak", "Scale each BRDF to its own peak"),
    ];
    const link = h("button", { type: "button", class: "framed", title: "Copy a link that holds what is shown" }, "Copy link");
    link.addEventListener("click", async () => {
      try { await navigator.clipboard.writeText(location.href); link.textContent = "Copied"; } catch { link.textContent = "It is in the address bar"; }
      setTimeout(() => { link.textContent = "Copy link"; }, 1500);
    });
    form.append(link);
    return () => all.forEach((set) => set());
  }

  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || /INPUT|SELECT/.test(event.target.tagName)) return;
    const digit = /^Digit([1-8])$/.exec(event.code);
    if (digit) {
      const one = state.brdfs[Number(digit[1]) - 1];
      if (!one) return;
      if (event.shiftKey) one.solo = !one.solo;
      else one.shown = !one.shown;
      listed();
    } else if (event.key === "l") state.log = !state.log;
    else if (event.key === "m") { const names = Object.keys(TIMES); state.times = names[(names.indexOf(state.times) + 1) % names.length]; }
    else if (event.key === "[" || event.key === "]") state.thetaI = Math.min(Math.max(state.thetaI + (event.key === "]" ? 5 : -5), 0), 89);
    else return;
    changed();
  });
  addEventListener("hashchange", () => { const linked = ofHash(location.hash, presets); if (linked) { state = linked; listed(); changed(); } });
  addEventListener("resize", later);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", later);
  changed();
  return { state: () => state, changed, value: (k, wi, wo) => value(state, modelOf(state.brdfs[k]), wi, wo), albedo: (k, wo) => albedo(modelOf(state.brdfs[k]), wo), turn, lobe };
}
