// Elements made of text and attributes only: nothing from a file is ever read as HTML.

const SVG = "http://www.w3.org/2000/svg";

/** An element; `on` holds listeners, null and false attributes are left out. */
export function h(tag, props = {}, ...children) {
  return fill(document.createElement(tag), props, children);
}

/** An element of a drawing. */
export function s(tag, props = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), props, children);
}

function fill(element, props, children) {
  for (const [name, value] of Object.entries(props)) {
    if (value === null || value === undefined || value === false) continue;
    if (name === "on") {
      for (const [event, listener] of Object.entries(value)) element.addEventListener(event, listener);
    } else if (name === "value") element.value = value;
    else if (name === "checked") element.checked = true;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  return element;
}

export const byId = (id) => document.getElementById(id);

/** Put other children in the place of those an element has; the focus stays where it can. */
export function replace(element, ...children) {
  const focused = element.contains(document.activeElement) ? document.activeElement : null;
  const key = focused?.id || focused?.dataset?.focus;
  element.replaceChildren(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  if (key) {
    const again = [...element.querySelectorAll("[id], [data-focus]")].find(
      (e) => e.id === key || e.dataset.focus === key,
    );
    again?.focus();
  }
}

/** An element with its options: [value, text] each. */
export function select(props, options, chosen) {
  const made = h(
    "select",
    props,
    options.map(([value, text]) => h("option", { value }, text)),
  );
  made.value = chosen ?? "";
  return made;
}

/** A labelled input. */
export function field(label, input, hint = null) {
  return h("label", { class: "field" }, h("span", {}, label), input, hint && h("small", { class: "muted" }, hint));
}

export const button = (text, click, props = {}) =>
  h("button", { type: "button", ...props, on: { click } }, text);

/** A table that scrolls within itself can be scrolled with the keyboard, too. */
export const scroll = (label, ...children) =>
  h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, children);
