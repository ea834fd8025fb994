// SPDX-License-Identifier: GPL-3.0-or-later
// F: the reflectance of one smooth facet for unpolarised light, as in addon/reference/fresnel.py. cos is v.h.

const EDGE = 1 / 7; // cosine of 82 degrees, where F82's tint applies

const clamp = (cos) => Math.min(Math.max(cos, 0), 1);

/** F = F0 + (1 - F0) (1 - cos)^5. Source: Schlick 1994, eq. 15. */
export function schlick(cos, f0) {
  return f0 + (1 - f0) * (1 - cos) ** 5;
}

/** Schlick's formula, multiplied by tint at cos = 1/7. Source: Kutz, Hasan & Edmondson 2021. */
export function f82(cos, f0, tint) {
  const b = (schlick(EDGE, f0) * (1 - tint)) / (EDGE * (1 - EDGE) ** 6);
  return Math.max(schlick(cos, f0) - b * cos * (1 - cos) ** 6, 0);
}

/** Exact F of a transparent medium, eta = index inside over outside. Source: Cook & Torrance 1982, with k = 0. */
export function fresnelDielectric(cos, eta) {
  const beyond = (eta - 1) * (eta + 1); // eta^2 - 1
  const g2 = beyond + cos * cos;
  if ((g2 <= 0 && beyond < 0) || (cos === 0 && beyond !== 0)) return 1; // total reflection, grazing
  const g = Math.sqrt(Math.max(g2, 0)), sum = g + cos > 0 ? g + cos : 1;
  const difference = beyond / sum; // g - c itself would cancel
  const p = (cos * sum - 1) / (cos * difference + 1);
  return Math.min(0.5 * (difference / sum) ** 2 * (1 + p * p), 1);
}

/** Exact F of an absorbing medium of index n + ik. Source: Born & Wolf 14.2 with 1.5.2. */
export function fresnelConductor(cos, n, k) {
  const re = (n - 1) * (n + 1) - k * k, im = 2 * n * k; // N^2 - 1
  if (re === 0 && im === 0) return 0;
  if (cos === 0) return 1;
  const n2 = [(n - k) * (n + k), im], sin2 = (1 - cos) * (1 + cos);
  const nearZero = 8 * Math.max(Math.abs(n2[0]), sin2) < Math.max(cos * cos, Math.abs(re));
  const g = complexRoot(nearZero ? n2[0] - sin2 : re + cos * cos, im);
  const sumS = [cos + g[0], g[1]], sumP = [n2[0] * cos + g[0], n2[1] * cos + g[1]];
  // r_s and r_p, multiplied out with these sums so that nothing cancels next to N = 1
  const absolute = Math.hypot(re, im);
  const s = absolute / (sumS[0] ** 2 + sumS[1] ** 2);
  const p = (absolute * Math.hypot(n2[0] * cos * cos - sin2, n2[1] * cos * cos)) / (sumP[0] ** 2 + sumP[1] ** 2);
  return Math.min(0.5 * (s * s + p * p), 1);
}

function complexRoot(re, im) {
  const size = Math.hypot(re, im), half = Math.sqrt((size + Math.abs(re)) / 2);
  if (half === 0) return [0, 0];
  return re >= 0 ? [half, im / (2 * half)] : [Math.abs(im) / (2 * half), im < 0 ? -half : half];
}

/** Reflectance of a thin sheet whose two faces reflect F each. */
export const pane = (F) => (2 * F) / (1 + F);

/** F of a form's parameters: cos -> [R, G, B]. */
export const FRESNEL = {
  schlick: ({ f0 }) => (cos) => f0.map((f) => schlick(clamp(cos), f)),
  f82: ({ f0, f82_tint }) => (cos) => f0.map((f, c) => f82(clamp(cos), f, f82_tint[c])),
  dielectric: ({ eta }) => (cos) => Array(3).fill(fresnelDielectric(clamp(cos), eta)),
  conductor: ({ n, k }) => (cos) => n.map((value, c) => fresnelConductor(clamp(cos), value, k[c])),
};
