// SPDX-License-Identifier: GPL-3.0-or-later
// Oren-Nayar 1994: V-grooves whose facets are Lambertian. The full fit (eqs. 27 to 29) and the qualitative one (30).
//
// With a = max(theta_i, theta_o), b = min(theta_i, theta_o), p = phi_i - phi_o and s2 = sigma^2:
// f = albedo/pi [C1 + cos p C2 tan b + (1 - |cos p|) C3 tan((a + b)/2)]
//     + 0.17 albedo^2/pi s2/(s2 + 0.13) [1 - cos p (2b/pi)^2]
import { BLACK, above, across } from "../directions.js";

/** Lambert: f = albedo / pi. */
export const lambert = (albedo) => ({
  evaluate: (wi, wo) => (above(wi, wo) ? albedo.map((rho) => rho / Math.PI) : BLACK),
  slopes: [],
});

export function orenNayar(wi, wo, albedo, sigma, qualitative) {
  if (!above(wi, wo)) return BLACK;
  const s2 = sigma * sigma;
  const [low, high, tanB, cosP, aside] = angles(wi, wo);
  const C1 = 1 - (0.5 * s2) / (s2 + 0.33), slope = (0.45 * s2) / (s2 + 0.09);
  if (qualitative) {
    const shape = C1 + Math.max(cosP, 0) * slope * Math.cos(low) * tanB;
    return albedo.map((rho) => (rho / Math.PI) * shape);
  }
  const x = (2 * low) / Math.PI, y = (2 * high) / Math.PI; // 1 - 2a/pi, 1 - 2b/pi
  const behind = y * (3 - y * (3 - y)) - 2 * Math.sin(low / 2) ** 2; // sin a - (2b/pi)^3
  const C2 = slope * (cosP >= 0 ? Math.cos(low) : behind);
  const C3 = ((0.125 * s2) / (s2 + 0.09)) * ((1 - x) * (1 - y)) ** 2;
  const once = C1 + cosP * C2 * tanB + (aside * C3) / Math.tan((low + high) / 2);
  const twice = ((0.17 * s2) / (s2 + 0.13)) * (1 - cosP * (1 - y) ** 2);
  return albedo.map((rho) => (rho / Math.PI) * Math.max(once + rho * twice, 0));
}

/** Elevations pi/2 - a and pi/2 - b, tan b, and of the azimuths cos p and 1 - |cos p|. */
function angles(wi, wo) {
  const sinI = across(wi), sinO = across(wo);
  const upI = Math.atan2(wi[2], sinI), upO = Math.atan2(wo[2], sinO);
  const low = Math.min(upI, upO), high = Math.max(upI, upO), tanB = Math.min(sinI / wi[2], sinO / wo[2]);
  if (sinI === 0 || sinO === 0) return [low, high, tanB, 0, 1]; // along the normal b is 0, p is undefined
  const xi = wi[0] / sinI, yi = wi[1] / sinI, xo = wo[0] / sinO, yo = wo[1] / sinO;
  const cosP = Math.min(Math.max(xi * xo + yi * yo, -1), 1), sinP = xi * yo - yi * xo;
  return [low, high, tanB, cosP, (sinP * sinP) / (1 + Math.abs(cosP))];
}

export function reference({ kind, parameters: { albedo, sigma } }) {
  return { evaluate: (wi, wo) => orenNayar(wi, wo, albedo, sigma, kind === "qualitative"), slopes: [] };
}
