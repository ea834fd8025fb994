// SPDX-License-Identifier: GPL-3.0-or-later
// Blinn-Phong: f = albedo/pi + specular (n + 2)(n + 4)/(8 pi (2^(-n/2) + n)) (n.h)^n.
// Source: Blinn 1977; scaled as Mallett & Yuksel 2020.
import { halfVector } from "../directions.js";
import { cosinePower, overLambert, round } from "./phong.js";

const NORMAL = [0, 0, 1];

export function reference({ parameters: { albedo, specular, shininess: n } }) {
  const scale = ((n + 2) * (n + 4)) / (8 * Math.PI * (2 ** (-n / 2) + n));
  const lobe = (wi, wo) => scale * cosinePower(halfVector(wi, wo), NORMAL, n);
  return overLambert(albedo, specular, lobe, round((2 / (n + 2)) ** 0.5));
}
