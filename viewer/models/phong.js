// SPDX-License-Identifier: GPL-3.0-or-later
// Modified Phong: f = albedo/pi + specular (n + 2)/(2 pi) cos^n a, a from wi to the mirror image of wo.
// Source: Lafortune & Willems 1994.
import { BLACK, above, dot, norm, plus, times } from "../directions.js";

/** max(a . b, 0)^n of unit vectors: exp(-n/2 log(1 + tan^2)), as cos rounds away what high powers tell. */
export function cosinePower(a, b, n) {
  const cos = dot(a, b);
  if (cos <= 0) return 0;
  const tan = norm(plus(a, times(b, -cos))) / cos;
  return Math.exp(-0.5 * n * Math.log1p(tan * tan));
}

/** Slopes of a round lobe. */
export const round = (m) => ({ x: m, y: m, azimuth: 0 });

/** Lambert and a lobe in 1/sr, which is about as wide as that of Beckmann facets of these slopes. */
export const overLambert = (albedo, specular, lobe, slopes) => ({
  evaluate(wi, wo) {
    if (!above(wi, wo)) return BLACK;
    const value = lobe(wi, wo);
    return albedo.map((rho, c) => rho / Math.PI + specular[c] * value);
  },
  slopes: [slopes],
});

export function reference({ parameters: { albedo, specular, exponent: n } }) {
  const scale = (n + 2) / (2 * Math.PI);
  const lobe = (wi, wo) => scale * cosinePower(wi, [-wo[0], -wo[1], wo[2]], n);
  return overLambert(albedo, specular, lobe, round((2 * n + 1) ** -0.5));
}
