// SPDX-License-Identifier: GPL-3.0-or-later
// Plots of lines: along an axis, and around the normal. A series is {name, colour, values, at(x)}.
import { card, h, s } from "./dom.js";
import { DECADES, digits } from "./state.js";

const WIDTH = 320, HEIGHT = 190, LEFT = 40, RIGHT = 14, TOP = 8, BOTTOM = 24;
const TALLEST = 1.03; // of a curve, in heights of the frame

/** 3 to 6 round numbers from 0 to the peak. */
function rounded(peak) {
  const rough = peak / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 2.5, 5, 10].find((one) => one * power >= rough);
  return Array.from({ length: Math.floor(peak / step + 1e-9) + 1 }, (_, k) => k * step);
}

/** Where values stand between 0 and 1, and the ticks. */
export function scale(peak, log) {
  if (!(peak > 0)) return { place: () => 0, ticks: [] };
  if (!log) return { place: (v) => v / peak, ticks: rounded(peak) };
  const top = Math.log10(peak), first = Math.ceil(top - DECADES);
  return {
    place: (v) => (v > 0 ? Math.max(1 + (Math.log10(v) - top) / DECADES, 0) : 0),
    ticks: Array.from({ length: Math.floor(top) - first + 1 }, (_, k) => 10 ** (first + k)),
  };
}

function readout(read, series, head, unit) {
  read.replaceChildren(h("b", {}, head), ...series.flatMap(({ name, colour, text }) => [
    h("i", { style: `background:${colour}`, title: name }), h("b", {}, text)]), unit);
}

/** Pointer and arrow keys move a cross along x; moved(x) for each place, moved(null) at the end. */
function pointed(plot, range, toX, moved) {
  let at = null;
  const show = (x) => { at = x === null ? null : Math.min(Math.max(x, range[0]), range[1]); moved(at); };
  plot.addEventListener("pointermove", (event) => {
    const box = plot.getBoundingClientRect();
    show(toX(((event.clientX - box.left) / box.width) * WIDTH, ((event.clientY - box.top) / box.height) * HEIGHT));
  });
  plot.addEventListener("pointerleave", () => show(null));
  plot.addEventListener("blur", () => show(null));
  plot.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    show((at ?? (range[0] + range[1]) / 2) + step * (event.shiftKey ? 10 : 1));
  });
  return () => at !== null && moved(at);
}

/** y over x in degrees. */
export function linePlot(title, { range, step, symbol, label, aside }) {
  const made = card(title, { label, aside });
  const svg = s("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none" });
  made.plot.append(svg);
  const toX = (x) => LEFT + ((x - range[0]) / (range[1] - range[0])) * (WIDTH - LEFT - RIGHT);
  const toY = (y) => HEIGHT - BOTTOM - y * (HEIGHT - BOTTOM - TOP);
  const cross = s("path", { class: "cross" });
  let now = { series: [], unit: "" };
  const refresh = pointed(made.plot, range, (px) => range[0] + ((px - LEFT) / (WIDTH - LEFT - RIGHT)) * (range[1] - range[0]), (x) => {
    cross.setAttribute("d", x === null ? "" : `M${toX(x)} ${TOP}V${HEIGHT - BOTTOM}`);
    if (x === null) return made.read.replaceChildren();
    const values = now.series.map((one) => ({ ...one, text: digits(one.at(x)) }));
    return readout(made.read, values, `${symbol} ${x.toFixed(1).replace("-", "−")}°`, now.unit);
  });
  return {
    ...made,
    draw(series, { xs, log, unit, sub, atLeast = 0, mark = null, within = Infinity }) {
      now = { series, unit };
      made.sub.textContent = sub;
      svg.setAttribute("preserveAspectRatio", "xMidYMid meet");
      const seen = (v, k) => (xs[k] <= within ? v : 0); // beyond, every f grows without bound
      const peak = Math.max(atLeast, ...series.map((one) => one.values.map(seen).reduce((a, b) => Math.max(a, b), 0)));
      const { place, ticks } = scale(peak * (log ? 1 : 1.04), log);
      const grid = ticks.map((tick) => `M${LEFT} ${toY(place(tick))}H${WIDTH - RIGHT}`).join("");
      const labels = ticks.map((tick) => s("text", { x: LEFT - 4, y: toY(place(tick)) + 4, "text-anchor": "end" }, digits(tick, 2)));
      for (let x = range[0]; x <= range[1]; x += step) {
        labels.push(s("text", { x: toX(x), y: HEIGHT - 9, "text-anchor": "middle" }, `${x}°`.replace("-", "−")));
      }
      const paths = series.map(({ colour, values }) => {
        const heights = values.map(place), inside = (k) => heights[k] <= TALLEST;
        const drawn = (k) => inside(k) || inside(k - 1) || inside(k + 1); // what leaves the frame ends there
        const point = (k) => `${toX(xs[k]).toFixed(1)} ${toY(Math.min(heights[k], TALLEST)).toFixed(1)}`;
        return s("path", {
          class: "curve", stroke: colour, d: Array.from(xs, (_, k) => drawn(k) ? (k && drawn(k - 1) ? "L" : "M") + point(k) : "").join(""),
        });
      });
      const light = mark === null ? null : s("path", { class: "cross", d: `M${toX(mark)} ${TOP}V${HEIGHT - BOTTOM}` });
      svg.replaceChildren(s("path", { class: "grid", d: grid }), ...labels, ...(light ? [light] : []), ...paths, cross,
        s("path", { class: "axis", d: `M${LEFT} ${TOP}V${HEIGHT - BOTTOM}H${WIDTH - RIGHT}` }));
      refresh();
    },
  };
}

/** The slice in the plane of incidence: angle from the normal, distance by value. Light comes from the left. */
export function polarPlot(title, label) {
  const made = card(title, { label });
  const svg = s("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}` });
  made.plot.append(svg);
  const [cx, cy, radius] = [WIDTH / 2, HEIGHT - 18, HEIGHT - 42];
  const at = (angle, r) => [cx + radius * r * Math.sin((angle * Math.PI) / 180), cy - radius * r * Math.cos((angle * Math.PI) / 180)];
  const ray = (angle, from, to) => `M${at(angle, from)}L${at(angle, to)}`;
  const cross = s("path", { class: "cross" });
  let now = { series: [], unit: "" };
  const refresh = pointed(made.plot, [-89.9, 89.9], (x, y) => (Math.atan2(x - cx, Math.max(cy - y, 0.01)) * 180) / Math.PI, (x) => {
    cross.setAttribute("d", x === null ? "" : ray(x, 0, 1));
    if (x === null) return made.read.replaceChildren();
    const values = now.series.map((one) => ({ ...one, text: digits(one.at(x)) }));
    return readout(made.read, values, `θo ${x.toFixed(1).replace("-", "−")}°`, now.unit);
  });
  return {
    ...made,
    draw(series, { xs, log, unit, sub, thetaI }) {
      now = { series, unit };
      made.sub.textContent = sub;
      const peak = Math.max(0, ...series.map((one) => one.values.reduce((a, b) => Math.max(a, b), 0)));
      const { place, ticks } = scale(peak, log);
      const ring = (r) => `M${cx - radius * r} ${cy}A${radius * r} ${radius * r} 0 0 1 ${cx + radius * r} ${cy}`;
      const spokes = [-60, -30, 0, 30, 60].map((angle) => ray(angle, 0, 1)).join("");
      const rings = ticks.map((tick) => ring(place(tick))).join("");
      const labels = ticks.filter((tick) => place(tick) > 0.15).map((tick) =>
        s("text", { x: cx + radius * place(tick), y: cy + 13, "text-anchor": "middle" }, digits(tick, 2)));
      for (const angle of [-60, -30, 0, 30, 60]) {
        const [x, y] = at(angle, 1.1);
        labels.push(s("text", { x, y: y + 3, "text-anchor": "middle" }, `${Math.abs(angle)}°`));
      }
      const paths = series.map(({ colour, values }) => s("path", {
        class: "curve", stroke: colour,
        d: values.map((v, k) => `${k ? "L" : "M"}${at(xs[k], place(v)).map((c) => c.toFixed(1)).join(" ")}`).join(""),
      }));
      const [lx, ly] = at(-thetaI, 0.99), [tx, ty] = at(-thetaI, 0.62);
      svg.replaceChildren(s("path", { class: "grid", d: rings + spokes + ring(1) }), ...labels,
        s("path", { class: "light", d: `M${lx} ${ly}L${tx} ${ty}` }),
        s("path", { class: "light", d: arrow(tx, ty, tx - lx, ty - ly) }),
        s("path", { class: "axis", d: `M${cx - radius} ${cy}H${cx + radius}` }),
        s("path", { class: "cross", d: ray(thetaI, 0, 1) }), ...paths, cross);
      refresh();
    },
  };
}

function arrow(x, y, dx, dy) {
  const length = Math.hypot(dx, dy) || 1, [ux, uy] = [(dx / length) * 7, (dy / length) * 7];
  return `M${x - ux - uy * 0.5} ${y - uy + ux * 0.5}L${x} ${y}L${x - ux + uy * 0.5} ${y - uy - ux * 0.5}`;
}
