// SPDX-License-Identifier: GPL-3.0-or-later
// Glass, as seen from outside: what the facets of an interface, or of a thin sheet, reflect. What they transmit leaves
// below the surface, where the page draws nothing.
import { FRESNEL, pane } from "../fresnel.js";
import { cookTorrance, smooth } from "./cook_torrance.js";

export function reference({ kind, parameters: { m, eta } }) {
  const face = FRESNEL.dielectric({ eta });
  const F = kind === "thin" ? (cos) => face(cos).map(pane) : face;
  if (m === 0) return smooth(F);
  return { evaluate: (wi, wo) => cookTorrance(wi, wo, m, F), slopes: [{ x: m, y: m, azimuth: 0 }] };
}
