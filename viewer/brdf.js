// SPDX-License-Identifier: GPL-3.0-or-later
// From a form (model, kind, flags, parameters, distribution) to its BRDF, by the files of models/.
import { measured } from "./measured.js";

/** {evaluate(wi, wo) -> f in 1/sr [R, G, B], slopes: of lobes to draw facets from} of a form. */
export function brdf(form, specs, models) {
  if (form.table) return measured(form.table);
  const spec = specs[form.model], parts = {};
  const part = (model, parameters) => {
    const kinds = Object.keys(specs[model].kinds);
    return brdf({ ...form, model, parameters, kind: kinds.includes(form.kind) ? form.kind : kinds[0] }, specs, models);
  };
  for (const [name, model] of spec.parts) parts[name] = part(model, form.parameters);
  for (let k = 1; `${spec.lobes[0]?.name}_${k}` in form.parameters; k++) {
    const own = Object.entries(form.parameters).filter(([name]) => name.endsWith(`_${k}`));
    parts[`lobe ${k}`] = part(spec.lobe_model, Object.fromEntries(own.map(([name, v]) => [name.slice(0, -2), v])));
  }
  return models[form.model].reference(form, parts);
}
