// SPDX-License-Identifier: GPL-3.0-or-later
// The list of BRDFs and the parameters of the selected one, with ranges and tips from the registry.
import { h } from "./dom.js";
import { MOST, digits, entry } from "./state.js";

const toSrgb = (x) => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * Math.min(x, 1) ** (1 / 2.4) - 0.055));

/** Parameters of a form, in order: [parameter, key]. */
function parametersOf(form, { specs, fresnel }) {
  const spec = specs[form.model];
  const own = spec.hasFresnel ? [...spec.parameters, ...fresnel[form.kind].parameters] : spec.parameters;
  const lobes = [];
  for (let k = 1; spec.lobes.length && `${spec.lobes[0].name}_${k}` in form.parameters; k++) {
    for (const one of spec.lobes) lobes.push([{ ...one, label: `${one.label} ${k}` }, `${one.name}_${k}`]);
  }
  return [...own.map((one) => [one, one.name]), ...lobes];
}

function stopOf(stops, value) {
  let best = 0;
  stops.forEach((stop, k) => { if (Math.abs(stop - value) < Math.abs(stops[best] - value)) best = k; });
  return best;
}

/** A slider over stops and a box for any number within the range. */
function slider(parameter, value, changed, name = parameter.label) {
  const { stops, low, high, zero, tip } = parameter;
  const box = h("input", { type: "number", min: zero ? 0 : low, max: high, step: "any", value: Number(value.toPrecision(4)), "aria-label": name, title: tip });
  const range = h("input", { type: "range", min: 0, max: stops.length - 1, value: stopOf(stops, value), "aria-label": `${name}, slider`, title: tip });
  range.addEventListener("input", () => { const v = stops[range.value]; box.value = v; changed(v); });
  box.addEventListener("change", () => {
    const v = Number(box.value), held = zero && v === 0 ? 0 : Math.min(Math.max(v, low), high);
    if (box.value === "" || !Number.isFinite(v)) return;
    box.value = held;
    range.value = stopOf(stops, held);
    changed(held);
  });
  return { box, range };
}

function row(parameter, value, changed) {
  const label = h("span", { class: "label", title: parameter.tip }, parameter.label, parameter.unit ? h("small", {}, ` ${parameter.unit}`) : "");
  if (!parameter.rgb) {
    const { box, range } = slider(parameter, value, changed);
    return h("div", { class: "row" }, label, box, range);
  }
  const swatch = () => (parameter.high <= 1 ? `background:rgb(${value.map(toSrgb)});width:84px;height:14px;border-radius:4px;border:1px solid var(--line)` : "");
  const shown = h("span", { style: swatch() });
  const channels = ["red", "green", "blue"].map((name, c) => {
    const { box, range } = slider(parameter, value[c], (v) => {
      value = value.map((one, k) => (k === c ? v : one));
      shown.setAttribute("style", swatch());
      changed(value);
    }, `${parameter.label}, ${name}`);
    return h("div", {}, range, box);
  });
  return h("div", { class: "row" }, label, shown, h("div", { class: "rgb" }, ...channels));
}

function geometric(low, high) {
  return Array.from({ length: 201 }, (_, k) => Number((low * (high / low) ** (k / 200)).toPrecision(4)));
}

function distributionRows(form, formulas, changed) {
  return form.distribution.flatMap((term, index) => {
    const title = h("p", { class: "note" }, `Facets: ${term.kind}${term.kind === "points" ? `, ${term.numbers.length} values as measured` : ""}`);
    const rows = (formulas[term.kind] ?? []).map((one, k) => row(
      { label: one.name, tip: `${one.name} of ${term.kind}`, unit: "", low: one.low, high: one.high, stops: geometric(one.low, one.high) },
      term.numbers[k], (v) => {
        form.distribution[index] = { ...form.distribution[index], numbers: form.distribution[index].numbers.map((n, i) => (i === k ? v : n)) };
        changed();
      }));
    return [title, ...rows];
  });
}

export function panel(host, registry, presets, actions) {
  const list = h("div", { role: "list" }), parameters = h("div"), warning = h("p", { class: "note warn", role: "status" });

  function items(state) {
    list.replaceChildren(...state.brdfs.map((one, k) => h("div", { class: `item ${k === state.selected ? "on" : ""} ${one.shown ? "" : "off"}`, role: "listitem" },
      h("button", { class: "dot", style: `--c:${one.colour_}`, "aria-pressed": String(one.shown), title: `Show or hide (${k + 1})`, "aria-label": `Show ${one.name}`, onclick: () => actions.show(k) }),
      h("button", { class: "name", "aria-current": String(k === state.selected), title: registry.specs[one.form.model]?.label ?? "Measured", onclick: () => actions.select(k) }, one.name),
      h("button", { class: "solo", "aria-pressed": String(one.solo), title: `Solo (Shift ${k + 1})`, "aria-label": `Solo ${one.name}`, onclick: () => actions.solo(k) }, "S"),
      h("button", { class: "remove", title: "Remove", "aria-label": `Remove ${one.name}`, onclick: () => actions.remove(k) }, "×"))));
    if (state.brdfs.length >= MOST) return;
    const add = h("select", { class: "add", "aria-label": "Add a BRDF" }, h("option", { value: "" }, "Add a BRDF …"),
      ...presets.map((one, k) => h("option", { value: k }, one.name)));
    add.addEventListener("change", () => add.value !== "" && actions.add(entry(presets, Number(add.value), 0)));
    list.append(h("div", { class: "item" }, add));
  }

  function numbers(state) {
    const one = state.brdfs[state.selected];
    parameters.replaceChildren();
    if (!one) return;
    const { form } = one, spec = registry.specs[form.model], changed = () => actions.changed();
    const head = h("h2", {}, h("span", {}, one.name), h("small", {}, spec?.label ?? "Measured"));
    const group = h("section", { class: "group", "aria-label": `Parameters of ${one.name}` }, head);
    parameters.append(group);
    if (!spec) return group.append(h("p", { class: "note" }, "A table of measured values: it has no parameters."));
    const kinds = Object.entries(spec.kinds).filter(([, label]) => label);
    if (kinds.length > 1) {
      const kind = h("select", { "aria-label": spec.hasFresnel ? "Fresnel term" : "Form" },
        ...kinds.map(([name, label]) => h("option", { value: name, selected: name === form.kind }, label)));
      kind.addEventListener("change", () => {
        form.kind = kind.value;
        for (const [p, key] of parametersOf(form, registry)) form.parameters[key] ??= p.default;
        numbers(state);
        changed();
      });
      group.append(h("div", { class: "row" }, h("span", { class: "label" }, spec.hasFresnel ? "Fresnel term" : "Form"), kind));
    }
    for (const flag of spec.flags) {
      const box = h("input", { type: "checkbox", checked: form.flags.includes(flag) });
      box.addEventListener("change", () => {
        form.flags = box.checked ? [...form.flags, flag] : form.flags.filter((other) => other !== flag);
        changed();
      });
      group.append(h("label", { class: "row", title: "The diffuse part gets what the specular one leaves" }, h("span", { class: "label" }, flag), box));
    }
    for (const [parameter, key] of parametersOf(form, registry)) {
      group.append(row(parameter, form.parameters[key] ?? parameter.default, (v) => { form.parameters[key] = v; changed(); }));
    }
    group.append(...distributionRows(form, registry.formulas, changed), warning);
    return group.append(h("p", { class: "note" }, h("button", { class: "framed", onclick: () => actions.reset() }, "Reset")));
  }

  host.append(list, parameters, h("p", { class: "note" }, h("kbd", {}, "1"), "–", h("kbd", {}, "8"), " show, ", h("kbd", {}, "⇧"), " solo, ",
    h("kbd", {}, "L"), " logarithm, ", h("kbd", {}, "M"), " multiply, ", h("kbd", {}, "["), h("kbd", {}, "]"), " light"));
  return {
    items, numbers,
    warn: (albedo) => { warning.textContent = albedo > 1.005 ? `Sends back ${digits(albedo)} of the light that arrives.` : ""; },
  };
}
