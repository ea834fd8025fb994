// SPDX-License-Identifier: GPL-3.0-or-later
// A measured BRDF: a grid over half and difference angles, RGB in 1/sr as 16-bit floats, written by viewer/content.py.
import { BLACK, above, halfAndDifference } from "./directions.js";

/** Value of a 16-bit float that is not negative. */
function ofHalf(bits) {
  const exponent = bits >> 10, fraction = (bits & 1023) / 1024;
  return exponent ? 2 ** (exponent - 15) * (1 + fraction) : 2 ** -14 * fraction;
}

/** Linear between the centres of the cells of (theta_h)^(1/2), theta_d and phi_d, which repeats after 180 degrees. */
export function measured({ size: [nh, nd, np], data }) {
  const bytes = atob(data);
  const values = Float32Array.from({ length: bytes.length / 2 }, (_, i) =>
    ofHalf(bytes.charCodeAt(2 * i) + 256 * bytes.charCodeAt(2 * i + 1)));
  const place = (x, count) => {
    const held = Math.min(Math.max(x * count - 0.5, 0), count - 1), first = Math.min(Math.floor(held), count - 2);
    return [first, held - first];
  };
  return {
    evaluate(wi, wo) {
      if (!above(wi, wo)) return BLACK;
      const [thetaH, thetaD, phiD] = halfAndDifference(wi, wo);
      const [i, a] = place(Math.sqrt(thetaH / (Math.PI / 2)), nh), [j, b] = place(thetaD / (Math.PI / 2), nd);
      const turn = (phiD / Math.PI) * np - 0.5, k = Math.floor(turn), c = turn - k;
      const f = [0, 0, 0];
      for (let corner = 0; corner < 8; corner++) {
        const [x, y, z] = [corner & 1, (corner >> 1) & 1, corner >> 2];
        const weight = (x ? a : 1 - a) * (y ? b : 1 - b) * (z ? c : 1 - c);
        const at = (((i + x) * nd + j + y) * np + (((k + z) % np) + np) % np) * 3;
        for (let channel = 0; channel < 3; channel++) f[channel] += weight * values[at + channel];
      }
      return f;
    },
    slopes: [0.02, 0.1, 0.4].map((m) => ({ x: m, y: m, azimuth: 0 })),
  };
}
