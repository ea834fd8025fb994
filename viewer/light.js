// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over light from all around: albedo, and a sphere in a studio. Directions come from facets of the model's own
// slopes and from the cosine, weighed together by Veach's balance heuristic; the points are a fixed sequence.
import { dot, plus, reflect, times, turned, unit, halfVector } from "./directions.js";
import { beckmannD } from "./distributions.js";

const point = (k) => [(0.5 + k * 0.7548776662466927) % 1, (0.5 + k * 0.5698402909980532) % 1]; // Roberts' R2

function facet({ x, y, azimuth }, [u, v]) {
  const radius = Math.sqrt(-Math.log1p(-u)), phi = 2 * Math.PI * v;
  return turned(unit([x * radius * Math.cos(phi), y * radius * Math.sin(phi), 1]), -azimuth);
}

function density({ x, y, azimuth }, wi, wo) {
  const h = halfVector(wi, wo);
  return (beckmannD(turned(h, azimuth), x, y) * h[2]) / (4 * Math.max(dot(wo, h), 1e-9));
}

/**
 * Integral of f cos(theta_i) L(wi) over wi for one view, [R, G, B]; radiance: wi -> [R, G, B].
 * count: directions from each lobe's facets; even: by the cosine, which diffuse parts need.
 */
export function lit(model, wo, radiance, count, even) {
  const sum = [0, 0, 0];
  const add = (wi) => {
    if (wi[2] <= 0) return;
    let pdf = (even * wi[2]) / Math.PI;
    for (const slope of model.slopes) pdf += count * density(slope, wi, wo);
    const f = model.evaluate(wi, wo), L = radiance(wi);
    for (let c = 0; c < 3; c++) sum[c] += (f[c] * wi[2] * L[c]) / pdf;
  };
  for (const slope of model.slopes) {
    for (let k = 0; k < count; k++) {
      const h = facet(slope, point(k));
      if (dot(h, wo) > 0) add(reflect(wo, h));
    }
  }
  for (let k = 0; k < even; k++) {
    const [u, v] = point(k), r = Math.sqrt(u), phi = 2 * Math.PI * v;
    add([r * Math.cos(phi), r * Math.sin(phi), Math.sqrt(1 - u)]);
  }
  if (model.mirror && wo[2] > 0) {
    const F = model.mirror(wo[2]), L = radiance([-wo[0], -wo[1], wo[2]]);
    for (let c = 0; c < 3; c++) sum[c] += F[c] * L[c];
  }
  return sum;
}

const WHITE = [1, 1, 1];
/** Directional albedo E(wo): the integral of f cos over wi, within 0.003. */
export const albedo = (model, wo) => lit(model, wo, () => WHITE, 1024, 4096);

// The studio: a gradient from the floor to the ceiling, and three softboxes with soft edges. y is up, z to the viewer.
const BOXES = [
  { to: unit([-0.7, 0.75, 0.6]), inner: 0.97, outer: 0.84, L: [6, 5.7, 5.3] },
  { to: unit([0.95, 0.25, 0.25]), inner: 0.985, outer: 0.9, L: [2.4, 2.6, 3] },
  { to: unit([0.2, 0.55, -0.9]), inner: 0.97, outer: 0.84, L: [3.5, 3.5, 3.5] },
];
const smooth = (x) => { const t = Math.min(Math.max(x, 0), 1); return t * t * (3 - 2 * t); };

export function studio(w) {
  const up = smooth(0.5 + w[1] * 1.4), base = 0.04 + 0.3 * up, L = [base * 0.97, base, base * 1.04];
  for (const box of BOXES) {
    const share = smooth((dot(w, box.to) - box.outer) / (box.inner - box.outer));
    for (let c = 0; c < 3; c++) L[c] += share * box.L[c];
  }
  return L;
}

/** Frame of a sphere's point whose normal is n, seen along z: [tangent, bitangent, normal]. The tangent runs around y. */
export function frame(n) {
  const T = unit(Math.abs(n[1]) < 0.999 ? [n[2], 0, -n[0]] : [1, 0, 0]);
  const B = [n[1] * T[2] - n[2] * T[1], n[2] * T[0] - n[0] * T[2], n[0] * T[1] - n[1] * T[0]];
  return [T, B, n];
}
export const into = ([T, B, N], w) => [dot(T, w), dot(B, w), dot(N, w)];
export const outOf = ([T, B, N], w) => plus(plus(times(T, w[0]), times(B, w[1])), times(N, w[2]));
