// SPDX-License-Identifier: GPL-3.0-or-later
// A body that scatters light below its surface, under a brushed coat.
export { reference } from "./translucent.js";
