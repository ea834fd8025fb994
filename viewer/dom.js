// SPDX-License-Identifier: GPL-3.0-or-later
// Elements in one call: h("button", {class: "x", onclick: f}, "text", child).

const SVG = "http://www.w3.org/2000/svg";

const fill = (element, attributes, children) => {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
};

export const h = (tag, attributes = {}, ...children) => fill(document.createElement(tag), attributes, children);
export const s = (tag, attributes = {}, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);

/** A figure with a title, a place for the plot, and a line for the values under the pointer. */
export function card(title, { wide = false, label, aside = null } = {}) {
  const plot = h("div", { class: "plot", tabindex: 0, role: "img", "aria-label": label ?? title });
  const sub = h("small"), read = h("output", { class: "read", "aria-live": "polite" });
  const caption = h("figcaption", {}, title, sub, aside);
  return { plot, sub, read, figure: h("figure", { class: wide ? "card wide" : "card" }, caption, plot, read) };
}

export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
