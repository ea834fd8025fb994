// SPDX-License-Identifier: GPL-3.0-or-later
// Cook-Torrance with another slope along the tangent than across it: m / s and m s, s^2 = 1 - 0.9 anisotropy.
import { turned } from "../directions.js";
import { FRESNEL } from "../fresnel.js";
import { vgrooveAlbedo } from "../quadrature.js";
import { cookTorrance, smooth } from "./cook_torrance.js";

const NARROWEST = 0.1; // (narrow / wide) at anisotropy 1

/** RMS slopes along the tangent and across it, and the tangent's azimuth in radians. */
export function slopes(m, anisotropy, rotation) {
  const aspect = Math.sqrt(1 - (1 - NARROWEST) * anisotropy);
  return { x: m / aspect, y: m * aspect, azimuth: 2 * Math.PI * rotation };
}

export function reference({ kind, parameters: { m, anisotropy, rotation, ...numbers } }) {
  const F = FRESNEL[kind](numbers);
  if (m === 0) return smooth(F);
  const { x, y, azimuth } = slopes(m, anisotropy, rotation), albedo = vgrooveAlbedo(F, x, y);
  return {
    evaluate: (wi, wo) => cookTorrance(turned(wi, azimuth), turned(wo, azimuth), x, F, y),
    albedo: (wo) => albedo(turned(wo, azimuth)),
    slopes: [{ x, y, azimuth }],
  };
}
