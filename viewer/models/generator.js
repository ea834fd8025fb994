// SPDX-License-Identifier: GPL-3.0-or-later
// Microfacet generator: f = albedo/pi + specular F(v.h) D(h) G / (4 (n.l)(n.v)) of any distribution D of facets.
// Source: Ashikhmin, Premoze & Shirley 2000.
import { BLACK, above, facetCosine, halfVector } from "../directions.js";
import { vgrooveG } from "../distributions.js";
import { distribution } from "../facet_distribution.js";
import { FRESNEL } from "../fresnel.js";

export function reference({ kind, parameters: { albedo, specular, ...numbers }, distribution: terms }) {
  const F = FRESNEL[kind](numbers), { density, slopes } = distribution(terms);
  return {
    evaluate(wi, wo) {
      if (!above(wi, wo)) return BLACK;
      const h = halfVector(wi, wo), mirrored = F(facetCosine(wi, wo, h));
      const lobe = (density(h) * (vgrooveG(wi, wo) / wi[2])) / (4 * wo[2]);
      return albedo.map((rho, c) => rho / Math.PI + specular[c] * mirrored[c] * lobe);
    },
    slopes: slopes.map((m) => ({ x: m, y: m, azimuth: 0 })),
  };
}
