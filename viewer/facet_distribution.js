// SPDX-License-Identifier: GPL-3.0-or-later
// Any isotropic distribution of facets, scaled so that the integral of D cos is 1; as in
// addon/reference/facet_distribution.py.
//
//     beckmann     exp(-tan^2/m^2) / (pi m^2 cos^4)
//     ggx          1 / (pi m^2 cos^4 (1 + tan^2/m^2)^2)
//     exponential  3 exp(-sqrt(6) tan/m) / (pi m^2 cos^4)
//     abc          ~ (1 + B (1 - cos))^-C
//     points       straight lines between values of D at (k/(N - 1))^2 90 degrees, k from 0 to N - 1
import { gaussLegendre } from "./quadrature.js";

const SHAPES = {
  beckmann: ([m]) => (sin2, c) => Math.exp(-sin2 / (c * c) / m ** 2) / c ** 4,
  ggx: ([m]) => (sin2, c) => (c * c + sin2 / m ** 2) ** -2,
  exponential: ([m]) => (sin2, c) => Math.exp((-Math.sqrt(6) * Math.sqrt(sin2)) / c / m) / c ** 4,
  abc: ([B, C]) => (sin2, c) => Math.exp(-C * Math.log1p((B * sin2) / (1 + c))),
  points: (values) => (sin2, c) => between(values, Math.sqrt((Math.atan2(Math.sqrt(sin2), c) * 2) / Math.PI)),
};

/** What gives D unit projected area. */
const SCALES = {
  beckmann: ([m]) => 1 / (Math.PI * m ** 2),
  ggx: ([m]) => 1 / (Math.PI * m ** 2),
  exponential: ([m]) => 3 / (Math.PI * m ** 2),
  abc: ([B, C]) => 1 / abcArea(B, C),
  points: (values) => 1 / pointsArea(values),
};

/** Slopes of Beckmann lobes that together lie about as wide, to draw facets from. */
const SLOPES = {
  beckmann: ([m]) => [m],
  ggx: ([m]) => [m, 4 * m],
  exponential: ([m]) => [m / 3, m],
  abc: ([B]) => [1, 3, 10].map((times) => times * Math.sqrt(2 / B)),
  points: () => [0.02, 0.1, 0.4],
};

export function distribution(terms) {
  const total = terms.reduce((sum, { weight }) => sum + weight, 0);
  const parts = terms.map(({ kind, numbers, weight }) => ({
    share: (weight / total) * SCALES[kind](numbers), shape: SHAPES[kind](numbers),
  }));
  return {
    density(h) {
      if (h[2] <= 1e-8) return 0;
      const sin2 = h[0] * h[0] + h[1] * h[1];
      return parts.reduce((D, { share, shape }) => D + share * shape(sin2, h[2]), 0);
    },
    slopes: terms.flatMap(({ kind, numbers }) => SLOPES[kind](numbers)).map((m) => Math.min(m, 1)),
  };
}

/** Value at x in [0, 1] of straight lines between evenly spaced values. */
function between(values, x) {
  const place = x * (values.length - 1), k = Math.min(Math.floor(place), values.length - 2);
  return values[k] + (place - k) * (values[k + 1] - values[k]);
}

/** Integral of D cos over the hemisphere, by Gauss's rule between points: t = x^2 pi/2, dt = pi x dx. */
function pointsArea(values) {
  const { points, weights } = gaussLegendre(32), width = 1 / (values.length - 1);
  let area = 0;
  for (let k = 0; k < values.length - 1; k++) {
    points.forEach((z, i) => {
      const x = width * (k + z), t = (x * x * Math.PI) / 2;
      area += between(values, x) * Math.cos(t) * Math.sin(t) * x * weights[i] * width;
    });
  }
  return 2 * Math.PI * Math.PI * area;
}

/** The same of (1 + B y)^-C, y = 1 - cos: 2 pi/B^2 ((1 + B) P(1 - C) - P(2 - C)), P(a) = ((1 + B)^a - 1)/a. */
function abcArea(B, C) {
  const length = Math.log1p(B);
  const power = (a) => (Math.abs(a) > 1e-12 ? Math.expm1(a * length) / a : length);
  return ((2 * Math.PI) / B ** 2) * ((1 + B) * power(1 - C) - power(2 - C));
}
