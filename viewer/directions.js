// SPDX-License-Identifier: GPL-3.0-or-later
// Directions: unit vectors [x, y, z] away from the surface, whose normal is z. wi to the light, wo to the viewer.

// This close to the horizon a direction counts as tangent, as in addon/reference/directions.py.
const TANGENT = 1e-50;

export const BLACK = [0, 0, 0];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a) => Math.sqrt(dot(a, a)); // Math.hypot is ten times slower
export const across = (a) => Math.sqrt(a[0] * a[0] + a[1] * a[1]); // the sine of its polar angle
export const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
];
export const unit = (a) => times(a, 1 / norm(a));
export const luminance = (c) => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; // linear Rec.709
export const radians = (degrees) => (degrees * Math.PI) / 180;
export const degrees = (angle) => (angle * 180) / Math.PI;

/** Unit vector of polar angle theta and azimuth phi, in radians. */
export const spherical = (theta, phi = 0) => [
  Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta),
];

/** Whether both directions leave the upper side of the surface. */
export const above = (wi, wo) => wi[2] > TANGENT && wo[2] > TANGENT;

/** h = (wi + wo) / |wi + wo| of directions above the surface. */
export const halfVector = (wi, wo) => unit(plus(wi, wo));

/** v.h = wo . h, or |wi + wo| / 2 where wi and wo are all but opposite and wo . h is rounding. */
export function facetCosine(wi, wo, h) {
  const length = norm(plus(wi, wo));
  return length > 1e-7 ? dot(wo, h) : length / 2;
}

/** Mirror image of wo about h: 2 (wo . h) h - wo. */
export const reflect = (wo, h) => unit(plus(times(h, 2 * dot(wo, h)), times(wo, -1)));

/** w as seen from a frame that is turned by azimuth about z, in radians. */
export function turned(w, azimuth) {
  const c = Math.cos(azimuth), s = Math.sin(azimuth);
  return [c * w[0] + s * w[1], c * w[1] - s * w[0], w[2]];
}

/** Half and difference angles [theta_h, theta_d, phi_d] in radians. Source: Rusinkiewicz 1998. */
export function halfAndDifference(wi, wo) {
  const h = halfVector(wi, wo), sinH = across(h);
  const cosD = norm(plus(wi, wo)) / 2, sinD = norm(plus(wi, times(wo, -1))) / 2;
  const [cx, cy] = sinH > 0 ? [h[0] / sinH, h[1] / sinH] : [1, 0];
  const x = (wi[0] * cx + wi[1] * cy) * h[2] - wi[2] * sinH, y = wi[1] * cx - wi[0] * cy;
  return [Math.atan2(sinH, h[2]), Math.atan2(sinD, cosD), Math.atan2(y, x)];
}

/** wi and wo of these angles, with h in the plane of x and z. */
export function fromHalfAndDifference(thetaH, thetaD, phiD) {
  const s = Math.sin(thetaH), c = Math.cos(thetaH);
  const x = Math.sin(thetaD) * Math.cos(phiD), y = Math.sin(thetaD) * Math.sin(phiD), z = Math.cos(thetaD);
  return [[c * x + s * z, y, c * z - s * x], [s * z - c * x, -y, c * z + s * x]];
}
