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
    } else if (name === "value") {
      if (element.defaultValue !== undefined) element.defaultValue = value;
      element.value = value;
    } else if (name === "checked") element.checked = true;
    else element.setAttribute(name, value === true ? "" : String(value));
  }
  element.append(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  return element;
}

export const byId = (id) => document.getElementById(id);

/** Put other children in the place of those an element has; focus, and what is being typed, stay where they can. */
export function replace(element, ...children) {
  const focused = element.contains(document.activeElement) ? document.activeElement : null;
  const key = focused?.id || focused?.dataset?.focus;
  element.replaceChildren(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  if (key) {
    const again = [...element.querySelectorAll("[id], [data-focus]")].find(
      (e) => e.id === key || e.dataset.focus === key,
    );
    again?.focus();
    if (again?.matches("input") && ![focused.defaultValue, again.value].includes(focused.value)) {
      again.value = focused.value;
      again.addEventListener("blur", () => again.dispatchEvent(new Event("change")), { once: true });
    }
  }
}

/** What the server made of a report's blocks, in which it escaped every text. */
export const html = (text) => [...new DOMParser().parseFromString(text, "text/html").body.childNodes];

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

/** A box to tick, with what it is of; `change` is called with whether it is ticked. */
export const tick = (text, checked, change = null, props = {}) =>
  h("label", { class: "check" }, h("input", { type: "checkbox", checked, ...props, on: change ? { change: (event) => change(event.target.checked) } : {} }), text);

/** What stands where there is nothing yet, and what to do about it. */
export const empty = (what, text, ...ways) =>
  h("div", { class: "empty" }, h("p", {}, h("strong", {}, what), ` ${text}`), ways.length > 1 ? h("div", { class: "button-row" }, ways) : ways);

/** What is wide scrolls within itself, with the keyboard, too. */
export const scroll = (label, ...children) =>
  h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": label }, children);

export const num = (content) => h("td", { class: "num" }, content);

/** A row of a table: what it is of, then its cells, each a td or what is in one. */
export const row = (first, ...cells) =>
  h("tr", {}, h("th", { scope: "row" }, first), cells.map((cell) => (cell instanceof HTMLTableCellElement ? cell : h("td", {}, cell))));

/**
 * A table.
 *
 * @param label what it shows; its caption, too, unless there is another
 * @param rows the cells of each, as `row` takes them, or rows that are made already
 * @param options {caption, numbers: the first and last column of numbers}, and attributes
 */
export function table(label, heads, rows, { caption = label, numbers: [from, to] = [], ...props } = {}) {
  return scroll(
    label,
    h(
      "table",
      props,
      caption && (caption instanceof Node ? caption : h("caption", {}, caption)),
      h("thead", {}, h("tr", {}, heads.map((text, i) => h("th", { scope: "col", class: i >= from && i <= to ? "num" : null }, text)))),
      h("tbody", {}, rows.map((cells) => (Array.isArray(cells) ? row(...cells) : cells))),
    ),
  );
}

/** Names and figures, side by side. */
export const figures = (entries) => entries.map(([term, text]) => h("div", {}, h("dt", {}, term), h("dd", {}, text)));
