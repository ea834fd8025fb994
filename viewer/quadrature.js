// SPDX-License-Identifier: GPL-3.0-or-later
// Directional albedo by Gauss-Legendre panels whose edges lie on the kinks of the integrand, as in
// addon/reference/quadrature.py.
import { BLACK, across } from "./directions.js";

const NODES = 8;
const REACH = 6; // slopes beyond 6 m carry exp(-36) of the facets
const LADDER = [0.03, 0.1, 0.3, 1, 3, 10, 30];
const SPREAD = [0.5, 1, 1.5, 2, 3, 4.5];

/** Points and weights on [0, 1], by Newton's iteration on Legendre's polynomial. */
export function gaussLegendre(nodes) {
  const points = [], weights = [];
  for (let i = 0; i < nodes; i++) {
    let x = Math.cos((Math.PI * (i + 0.75)) / (nodes + 0.5)), slope = 1;
    for (let step = 0; step < 8; step++) {
      let [before, now] = [1, x];
      for (let k = 2; k <= nodes; k++) [before, now] = [now, ((2 * k - 1) * x * now - (k - 1) * before) / k];
      slope = (nodes * (x * now - before)) / (x * x - 1);
      x -= now / slope;
    }
    points.push((1 + x) / 2);
    weights.push(1 / ((1 - x * x) * slope * slope));
  }
  return { points, weights };
}

const RULE = (() => { // after the substitution 3 s^2 - 2 s^3, which flattens roots at both ends
  const { points, weights } = gaussLegendre(NODES);
  return points.map((s, i) => [s * s * (3 - 2 * s), weights[i] * 6 * s * (1 - s)]);
})();

/** Sum of weight f(x) over all panels between the edges within [low, high]. */
function integrate(edges, low, high, f) {
  const inside = edges.filter((edge) => edge > low && edge < high).sort((a, b) => a - b);
  let start = low;
  for (const end of [...inside, high]) {
    const width = end - start;
    if (width > 0) for (const [x, weight] of RULE) f(start + width * x, width * weight);
    start = end;
  }
}

/**
 * Directional albedo of Cook-Torrance toward one view, [R, G, B].
 *
 * With slopes p (in the plane of view) and q, A = v_x p + v_z and the Gaussian P of slopes:
 * E = 1/v_z  integral of  P(p, q) A G2 F dp dq,  G2 = min(1, 2 v_z/A, 4/(1 + p^2 + q^2) - 2 v_z/A)+.
 */
function albedoAt(vz, azimuth, F, mX, mY) {
  const vx = Math.sqrt((1 - vz) * (1 + vz)), cos = Math.cos(azimuth), sin = Math.sin(azimuth);
  const c = Math.hypot(sin / mX, cos / mY) ** 2;
  const b = cos * sin * (1 / mY - 1 / mX) * (1 / mY + 1 / mX);
  const along = Math.hypot(mX * cos, mY * sin), beside = c ** -0.5;
  const t = vx / vz, far = t + Math.sqrt(t * t + 1);
  const scales = [...LADDER, ...SPREAD.map((s) => s * along)];
  const outer = [0, t, ...scales, ...scales.map((s) => -s)];
  if (t > 0) outer.push(1 / t, ...LADDER.map((s) => (s - 1) / t), ...[1e-7, 1e-5, 1e-3].map((s) => (s - 1) / t));
  const E = [0, 0, 0];
  integrate(outer, Math.max(-1 / far, -REACH * along), Math.min(far, REACH * along), (p, pWeight) => {
    const A = vx * p + vz, centre = (-b / c) * p, middle = Math.abs(centre);
    const circle = (length2) => Math.sqrt(Math.max(length2 - 1 - p * p, 0));
    const end = Math.min(circle((2 * A) / vz), middle + REACH * beside);
    const shadow = circle(4 / (Math.min(1, (2 * vz) / A) + (2 * vz) / A));
    const spreads = b ? [...SPREAD.map((s) => -s), 0, ...SPREAD] : SPREAD;
    const even = (p / along) ** 2, peak = 1 / (Math.PI * mX * mY);
    integrate([...LADDER, shadow, ...spreads.map((s) => middle + s * beside)], 0, end, (q, qWeight) => {
      const density = Math.exp(-even - c * (q - centre) ** 2) + Math.exp(-even - c * (q + centre) ** 2);
      const length2 = 1 + p * p + q * q;
      const G2 = Math.max(Math.min(1, (2 * vz) / A, 4 / length2 - (2 * vz) / A), 0);
      const weight = ((peak * density * A) / vz) * G2 * pWeight * qWeight;
      if (weight > 0) F(Math.min(A / Math.sqrt(length2), 1)).forEach((value, k) => { E[k] += weight * value; });
    });
  });
  return E;
}

const AZIMUTHS = 24; // nodes from 0 to 180 degrees, where it repeats

/** wo -> E(wo) of Cook-Torrance, [R, G, B]: cubic between nodes of the quadrature, each computed where first needed. */
export function vgrooveAlbedo(F, mX, mY) {
  const nodes = new Map(), isRound = mX === mY;
  // Closer toward the horizon, where E changes fastest, and the more so the narrower the lobe
  const count = Math.min(Math.ceil(40 + 2.4 / Math.min(mX, mY)), 160);
  const node = (i, j) => {
    const key = isRound ? i : i * AZIMUTHS + j;
    if (!nodes.has(key)) {
      const up = (Math.max(i, 0.02) / count) ** 2 * (Math.PI / 2);
      nodes.set(key, albedoAt(Math.sin(up), (j / AZIMUTHS) * Math.PI, F, mX, mY));
    }
    return nodes.get(key);
  };
  return (wo) => {
    if (wo[2] <= 0) return BLACK;
    const s = Math.sqrt(Math.atan2(wo[2], across(wo)) / (Math.PI / 2)) * count;
    const turn = isRound ? 0 : (((Math.atan2(wo[1], wo[0]) / Math.PI) * AZIMUTHS) % AZIMUTHS + AZIMUTHS) % AZIMUTHS;
    const i = Math.min(Math.max(Math.floor(s) - 1, 0), count - 3), j = Math.floor(turn) - 1;
    const views = cubic(s - i), turns = isRound ? [1] : cubic(turn - j);
    const E = [0, 0, 0];
    turns.forEach((v, b) => views.forEach((u, a) => {
      const value = node(i + a, isRound ? 0 : (j + b + AZIMUTHS) % AZIMUTHS);
      for (let k = 0; k < 3; k++) E[k] += u * v * value[k];
    }));
    return E;
  };
}

/** Weights of four nodes at 0, 1, 2 and 3 for Lagrange's cubic at x. */
function cubic(x) {
  const [a, b, c, d] = [x, x - 1, x - 2, x - 3];
  return [(b * c * d) / -6, (a * c * d) / 2, (a * b * d) / -2, (a * b * c) / 6];
}
