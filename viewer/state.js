// SPDX-License-Identifier: GPL-3.0-or-later
// What the page shows, and the link that holds it.
import { luminance, radians, spherical } from "./directions.js";

export const MOST = 8;
export const COLOURS = ["#4477aa", "#e0703a", "#2f9e63", "#b65aa3", "#c79a1e", "#3fb1c9", "#d1495b", "#8a8f96"];
export const TIMES = {
  none: { label: "f", factor: () => 1 },
  cos_o: { label: "f cos θo", factor: (wi, wo) => wo[2] },
  cos_io: { label: "f cos θi cos θo", factor: (wi, wo) => wi[2] * wo[2] },
};
export const CHANNELS = { luminance, red: (c) => c[0], green: (c) => c[1], blue: (c) => c[2] };
export const DECADES = 4; // that a logarithmic plot shows below its peak

const copy = (form) => ({ ...structuredClone({ ...form, table: undefined }), table: form.table });

export const initial = (presets) => ({
  brdfs: presets.map((_, k) => entry(presets, k, k)),
  selected: 0, thetaI: 45, phiI: 0, times: "none", log: false, channel: "luminance", own: false,
  thetaD: 0, thetaH: 0, phiD: 90, camera: [62, 22],
});

/** A BRDF of the page: one of its presets, or a model with default numbers. */
export const entry = (presets, preset, colour) => ({
  preset, name: presets[preset].name, form: copy(presets[preset].form), colour: colour % MOST, shown: true, solo: false,
});

export const visible = (state) => {
  const alone = state.brdfs.some((one) => one.solo);
  return state.brdfs.filter((one) => (alone ? one.solo : one.shown));
};

export const light = (state) => spherical(radians(state.thetaI), radians(state.phiI));

/** Value that plots show: a channel of f, times cosines. */
export function value(state, model, wi, wo) {
  if (wi[2] <= 0 || wo[2] <= 0) return 0;
  return CHANNELS[state.channel](model.evaluate(wi, wo)) * TIMES[state.times].factor(wi, wo);
}

/** Three significant digits, with a true minus sign. */
export function digits(x, count = 3) {
  if (x === 0) return "0";
  const size = Math.abs(x);
  const text = size >= 1e5 || size < 1e-3 ? x.toExponential(count - 1).replace(/\.?0*e/, "e") : String(Number(x.toPrecision(count)));
  return text.replace("-", "−").replace("e+", "e").replace("e-", "e−");
}

// The link: only what differs from the presets of the page.

const VIEW = ["selected", "thetaI", "phiI", "times", "log", "channel", "own", "thetaD", "thetaH", "phiD", "camera"];

export function toHash(state, presets) {
  const view = VIEW.map((name) => state[name]);
  const brdfs = state.brdfs.map(({ preset, form, colour, shown, solo }) => {
    const of = presets[preset].form, changes = {};
    for (const name of ["kind", "flags", "parameters", "distribution"]) {
      if (JSON.stringify(form[name]) !== JSON.stringify(of[name])) changes[name] = form[name];
    }
    return [preset, colour, shown, solo, changes];
  });
  return `#${encodeURIComponent(JSON.stringify([1, view, brdfs]))}`;
}

/** The state of a link; null where it is none of this page's. */
export function ofHash(hash, presets) {
  try {
    const [version, view, brdfs] = JSON.parse(decodeURIComponent(hash.slice(1)));
    if (version !== 1 || view.length !== VIEW.length || brdfs.length > MOST) return null;
    const state = { ...initial([]), ...Object.fromEntries(VIEW.map((name, k) => [name, view[k]])) };
    state.brdfs = brdfs.map(([preset, colour, shown, solo, changes]) => {
      const one = entry(presets, preset, colour);
      return { ...one, shown, solo, form: { ...one.form, ...changes } };
    });
    return state.times in TIMES && state.channel in CHANNELS ? state : null;
  } catch {
    return null;
  }
}
