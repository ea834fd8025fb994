// SPDX-License-Identifier: GPL-3.0-or-later
// Ashikhmin & Shirley 2000: p(h) F / (4 (v.h) max(n.l, n.v)) + 28 Rd (1 - Rs) / (23 pi) a(n.l) a(n.v),
// p(h) = ((n_u + 1)(n_v + 1))^(1/2) / (2 pi) (n.h)^(n_u cos^2 + n_v sin^2), a(c) = 1 - (1 - c/2)^5, F = Schlick's of Rs.
// Of kind lambert an amplitude times the first part, over Rd / pi.
import { BLACK, above, facetCosine, halfVector, turned } from "../directions.js";
import { FRESNEL } from "../fresnel.js";
import { slopes } from "./anisotropic.js";

const entering = (w) => 1 - (1 - w[2] / 2) ** 5;

export function reference({ kind, parameters: { albedo, specular, amplitude, sharpness, anisotropy, rotation } }) {
  const under = kind === "lambert" ? () => 1 / Math.PI
    : (wi, wo, rs) => (28 / (23 * Math.PI)) * entering(wi) * entering(wo) * (1 - rs);
  const narrow = 1 - 0.9 * anisotropy; // of n + 2; as 1/s^2 of the slopes
  const [nu, nv] = [narrow, 1 / narrow].map((share) => Math.max((sharpness + 2) * share - 2, 0));
  const scale = Math.sqrt((nu + 1) * (nv + 1)) / (2 * Math.PI);
  const F = FRESNEL.schlick({ f0: specular });
  const of = slopes(Math.sqrt(2 / (sharpness + 2)), anisotropy, rotation);
  const density = (h) => {
    const [x, y] = [h[0] / h[2], h[1] / h[2]], t2 = x * x + y * y;
    const flat = t2 > 0 ? Math.log1p(t2) / t2 : 1;
    return scale * Math.exp(-0.5 * (nu * x * x + nv * y * y) * flat);
  };
  return {
    evaluate(wi, wo) {
      if (!above(wi, wo)) return BLACK;
      const h = halfVector(wi, wo), vh = facetCosine(wi, wo, h), reflectance = F(vh);
      const lobe = density(turned(h, of.azimuth)) / (4 * vh * Math.max(wi[2], wo[2]));
      return albedo.map((rd, i) => amplitude[i] * lobe * reflectance[i] + rd * under(wi, wo, specular[i]));
    },
    slopes: [of],
  };
}
