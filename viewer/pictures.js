// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures made pixel by pixel, in steps, so that the page stays responsive: the slice of half and difference angles,
// and spheres in a studio and under one light.
import { fromHalfAndDifference, radians, times, unit } from "./directions.js";
import { card, h } from "./dom.js";
import { frame, into, lit, outOf, studio } from "./light.js";
import { DECADES, TIMES, digits, light, value } from "./state.js";

const SLICE = 72, SPHERES = 132; // pixels along a side
const RING = Math.PI / 360; // normals of a sphere lie on rings of half a degree, as a coat's albedo is kept by angle
const FACETS = 32, EVEN = 192; // directions of light for each pixel

/** sRGB of linear light, 0 to 255; brighter than 1 rolls off. */
function encoded(x) {
  const held = x <= 0.8 ? x : 1 - 0.2 * Math.exp(-(x - 0.8) / 0.2);
  return 255 * (held <= 0.0031308 ? 12.92 * held : 1.055 * held ** (1 / 2.4) - 0.055);
}

const put = (image, x, y, rgb, alpha = 255) =>
  image.data.set([encoded(Math.max(rgb[0], 0)), encoded(Math.max(rgb[1], 0)), encoded(Math.max(rgb[2], 0)), alpha], 4 * (y * image.width + x));

/** theta_h along x, as its root, and theta_d along y, of one model. */
export function slicePlot(aside) {
  const made = card("Image slice", { label: "f over half and difference angles", aside });
  const canvas = h("canvas", { width: SLICE, height: SLICE, style: "image-rendering:auto;object-fit:fill" });
  made.plot.append(canvas);
  let now = null;
  const angles = (x, y) => [(x * x * Math.PI) / 2, (y * Math.PI) / 2];
  const at = (x, y) => {
    const [thetaH, thetaD] = angles(x, y);
    return { thetaH, thetaD, pair: fromHalfAndDifference(thetaH, thetaD, radians(now.state.phiD)) };
  };
  made.plot.addEventListener("pointermove", (event) => {
    if (!now) return;
    const box = made.plot.getBoundingClientRect();
    const { thetaH, thetaD, pair } = at((event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height);
    const below = pair[0][2] <= 0 || pair[1][2] <= 0;
    made.read.replaceChildren(`θh ${((thetaH * 180) / Math.PI).toFixed(1)}° θd ${((thetaD * 180) / Math.PI).toFixed(1)}° `,
      h("b", {}, below ? "below the horizon" : digits(value(now.state, now.model, ...pair))), below ? "" : "1/sr");
  });
  made.plot.addEventListener("pointerleave", () => made.read.replaceChildren("θh → (root scale)   θd ↑"));
  made.read.append("θh → (root scale)   θd ↑");
  return {
    ...made,
    * draw(state, { model, name }) {
      now = { state, model };
      made.sub.textContent = name;
      const context = canvas.getContext("2d"), image = context.createImageData(SLICE, SLICE);
      const factor = TIMES[state.times].factor, values = [];
      for (let y = 0; y < SLICE; y++) {
        for (let x = 0; x < SLICE; x++) {
          const { pair: [wi, wo] } = at((x + 0.5) / SLICE, 1 - (y + 0.5) / SLICE);
          const f = wi[2] > 0 && wo[2] > 0 ? times(model.evaluate(wi, wo), factor(wi, wo)) : null;
          values.push(f);
        }
        yield;
      }
      const sorted = values.filter(Boolean).map((f) => Math.max(...f)).sort((a, b) => a - b);
      const peak = sorted[sorted.length - 1], white = sorted[Math.floor(0.95 * sorted.length)] || 1;
      values.forEach((f, k) => {
        const x = k % SLICE, y = Math.floor(k / SLICE);
        if (!f) return put(image, x, y, [0, 0, 0], 0);
        const shown = state.log ? f.map((v) => (v > 0 ? Math.max(1 + Math.log10(v / peak) / DECADES, 0) ** 2.2 : 0)) : times(f, 1 / white);
        return put(image, x, y, shown);
      });
      context.putImageData(image, 0, 0);
    },
  };
}

/** Spheres of all models that are shown, side by side. */
export function spherePlot(title, label, isStudio) {
  const made = card(title, { label });
  const canvas = h("canvas", { class: "plate", style: "object-fit:contain" });
  made.plot.append(canvas);
  let drawn = [];
  return {
    ...made,
    * draw(state, models) {
      if (isStudio && models.length === drawn.length && models.every(({ model }, k) => model === drawn[k])) return;
      const columns = Math.min(Math.max(models.length, 1), models.length > 4 ? 4 : 3), rows = Math.ceil(models.length / columns) || 1;
      const side = Math.floor(SPHERES * Math.min(1.4 / Math.sqrt(columns * rows), 1));
      made.sub.textContent = isStudio ? "three softboxes" : `light at θi ${Math.round(state.thetaI)}° from the viewer`;
      const image = new ImageData(side * columns, side * rows);
      const l = light(state), wiWorld = unit([-l[0], l[1] + 1e-9, l[2]]); // from the left, as in the other plots
      for (let k = 0; k < models.length; k++) {
        const { model } = models[k], left = side * (k % columns), top = side * Math.floor(k / columns);
        for (let y = 0; y < side; y++) {
          for (let x = 0; x < side; x++) {
            const px = ((x + 0.5) / side) * 2.08 - 1.04, py = 1.04 - ((y + 0.5) / side) * 2.08, r = Math.hypot(px, py);
            if (r >= 1) continue;
            const theta = Math.max(Math.round(Math.asin(r) / RING), 1) * RING;
            const ring = Math.min(Math.sin(theta), 0.99999) / Math.max(r, 1e-9);
            const n = [px * ring, py * ring, Math.sqrt(Math.max(1 - (r * ring) ** 2, 1e-9))];
            const axes = frame(n), wo = into(axes, [0, 0, 1]);
            let L;
            if (isStudio) L = lit(model, wo, (w) => studio(outOf(axes, w)), FACETS, EVEN);
            else {
              const wi = into(axes, wiWorld);
              L = wi[2] > 0 ? times(model.evaluate(wi, wo), wi[2] * Math.PI) : [0, 0, 0];
            }
            put(image, left + x, top + y, L, 255 * Math.min((1 - r) * side * 0.5, 1));
          }
          yield;
        }
      }
      Object.assign(canvas, { width: image.width, height: image.height });
      canvas.getContext("2d").putImageData(image, 0, 0);
      drawn = models.map(({ model }) => model);
    },
  };
}
