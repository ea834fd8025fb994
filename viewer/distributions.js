// SPDX-License-Identifier: GPL-3.0-or-later
// D and G: how the facets of a rough surface are turned and hide each other, as in addon/reference/distributions.py.
import { dot, facetCosine, halfVector } from "./directions.js";

/** D(h) = exp(-tan^2 / m^2) / (pi m^2 cos^4) in 1/sr; with slopes m along x and mY along y. Source: Walter et al. 2007. */
export function beckmannD(h, m, mY = m) {
  const z = h[2];
  if (z <= 1e-8) return 0;
  const tan2 = (h[0] / z) ** 2 + ((h[1] / z) * (m / mY)) ** 2;
  return Math.exp(-tan2 / m / m) / (Math.PI * m * mY * z ** 4);
}

/** G = min(1, 2 (n.h)(n.v) / (v.h), 2 (n.h)(n.l) / (v.h)) of a V-groove. Source: Cook & Torrance 1982. */
export function vgrooveG(wi, wo) {
  const h = halfVector(wi, wo);
  return Math.min(1, (2 * h[2] * Math.min(wi[2], wo[2])) / facetCosine(wi, wo, h));
}

/** G1 = min(1, 2 (n.h)(n.v) / (v.h)): the share of a facet that wo sees; 0 for v.h <= 0. */
export function vgrooveG1(wo, h) {
  const vh = dot(wo, h);
  return vh > 0 && h[2] > 0 && wo[2] > 0 ? Math.min(1, (2 * h[2] * wo[2]) / vh) : 0;
}
