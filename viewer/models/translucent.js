// SPDX-License-Identifier: GPL-3.0-or-later
// A body that scatters light below its surface, under a coat: as a large body looks under even light.
import { lambert } from "./oren_nayar.js";
import { sum } from "./sum.js";

export function reference({ parameters: { reflectance } }, { specular }) {
  return sum(lambert(reflectance), specular, 1, 1, true);
}
