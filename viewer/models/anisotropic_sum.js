// SPDX-License-Identifier: GPL-3.0-or-later
// A diffuse part under a brushed specular one.
export { reference } from "./sum.js";
