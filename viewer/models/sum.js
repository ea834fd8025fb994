// SPDX-License-Identifier: GPL-3.0-or-later
// A diffuse part under a specular one: f = d f_diffuse + s f_specular (Cook & Torrance 1982).
// Coupled: f = d (1 - s E_s(wo)) f_diffuse + s f_specular, E_s the specular part's directional albedo.

export function sum(diffuse, specular, d, s, coupled) {
  return {
    evaluate(wi, wo) {
      const below = diffuse.evaluate(wi, wo), mirrored = specular.evaluate(wi, wo);
      const E = coupled && wo[2] > 0 ? specular.albedo(wo) : [0, 0, 0];
      return below.map((f, c) => d * (1 - s * E[c]) * f + s * mirrored[c]);
    },
    slopes: specular.slopes,
    mirror: specular.mirror && ((cos) => specular.mirror(cos).map((F) => s * F)),
  };
}

export function reference({ flags, parameters: { d, s } }, { diffuse, specular }) {
  return sum(diffuse, specular, d, s, flags.includes("coupled"));
}
