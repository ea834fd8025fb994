// SPDX-License-Identifier: GPL-3.0-or-later
// Car paint: f = f_base + sum of s_k f_k over Cook-Torrance lobes. Source: Günther et al. 2005.

export function reference({ parameters }, { diffuse, ...lobes }) {
  const parts = Object.values(lobes), shares = parts.map((_, k) => parameters[`s_${k + 1}`]);
  return {
    evaluate: (wi, wo) => parts.reduce((f, lobe, k) => {
      const value = lobe.evaluate(wi, wo);
      return f.map((one, c) => one + shares[k] * value[c]);
    }, diffuse.evaluate(wi, wo)),
    slopes: parts.flatMap((lobe) => lobe.slopes),
  };
}
