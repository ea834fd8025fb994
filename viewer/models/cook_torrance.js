// SPDX-License-Identifier: GPL-3.0-or-later
// Cook-Torrance 1982: f = F(v.h) D(h) G(l, v, h) / (4 (n.l)(n.v)), Beckmann's D and the V-groove's G.
import { BLACK, above, facetCosine, halfVector, times } from "../directions.js";
import { beckmannD, vgrooveG } from "../distributions.js";
import { FRESNEL } from "../fresnel.js";
import { vgrooveAlbedo } from "../quadrature.js";

/** f in 1/sr, [R, G, B]; m: RMS slope along x, mY along y. */
export function cookTorrance(wi, wo, m, fresnel, mY = m) {
  if (!above(wi, wo)) return BLACK;
  const h = halfVector(wi, wo);
  const D = beckmannD(h, m, mY), G = vgrooveG(wi, wo);
  return times(fresnel(facetCosine(wi, wo, h)), (D * (G / wi[2])) / (4 * wo[2]));
}

/** A smooth interface: all light is in one mirror direction, a Dirac delta that is given as 0. */
export const smooth = (fresnel) => ({
  evaluate: () => BLACK,
  albedo: (wo) => fresnel(wo[2]),
  slopes: [],
  mirror: fresnel,
});

export function reference({ kind, parameters: { m, ...numbers } }) {
  const F = FRESNEL[kind](numbers);
  if (m === 0) return smooth(F);
  return {
    evaluate: (wi, wo) => cookTorrance(wi, wo, m, F),
    albedo: vgrooveAlbedo(F, m, m),
    slopes: [{ x: m, y: m, azimuth: 0 }],
  };
}
