// A table that sorts by any column.

import { remove } from "../core/api.js";
import { button, h, replace, scroll } from "../core/dom.js";
import { attempt, tell } from "../core/notice.js";
import { _, many } from "../core/words.js";

/** Rows that are shown at a time; what is looked for among more is found by its words. */
const SHOWN = 100;

/**
 * A sortable table.
 *
 * @param caption what it shows
 * @param columns [{title, value: row => number|string|null, show: row => node, numeric, look}]; `look` has classes
 * @returns {element, update(rows)}
 */
export function sortable(caption, columns) {
  let rows = [];
  let by = null;
  let direction = 1;
  const head = h("tr");
  const body = h("tbody");
  const table = h("table", {}, h("caption", {}, caption), h("thead", {}, head), body);

  for (const column of columns) {
    const title = column.value
      ? h("button", { type: "button", class: "sort", on: { click: () => order(column) } }, column.title)
      : column.title;
    column.look = [column.numeric && "num", column.look].filter(Boolean).join(" ") || null;
    column.head = h("th", { scope: "col", class: column.look }, title);
    if (!column.title) column.head.append(h("span", { class: "sr" }, column.label ?? _("Actions")));
    head.append(column.head);
  }

  function order(column) {
    direction = by === column ? -direction : 1;
    by = column;
    for (const other of columns) other.head.removeAttribute("aria-sort");
    column.head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
    draw();
  }

  function compare(a, b) {
    const [x, y] = [by.value(a), by.value(b)];
    if (x === null || x === undefined) return 1; // What is missing stays last.
    if (y === null || y === undefined) return -1;
    return direction * (typeof x === "number" ? x - y : String(x).localeCompare(String(y), undefined, { numeric: true }));
  }

  const find = h("input", { type: "search", "aria-label": _("Find in {table}", { table: caption }), placeholder: _("Find"), maxlength: 200, on: { input: () => draw() } });
  const said = h("span", { class: "muted small", role: "status" });
  const tools = h("div", { class: "button-row", hidden: true }, find, said);

  function draw() {
    const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
    const text = (row) => columns.map((column) => column.value?.(row) ?? "").join(" ").toLowerCase();
    const found = words.length ? rows.filter((row) => words.every((word) => text(row).includes(word))) : rows;
    tools.hidden = rows.length <= SHOWN;
    said.textContent = found.length > SHOWN ? _("The first {n} of {whole}", { n: SHOWN, whole: found.length }) : many("{n} found", "{n} found", found.length);
    const sorted = by ? [...found].sort(compare) : found;
    replace(
      body,
      sorted.slice(0, SHOWN).map((row) =>
        h(
          "tr",
          {},
          columns.map((column, index) =>
            h(index === 0 ? "th" : "td", { scope: index === 0 ? "row" : null, class: column.look }, column.show(row)),
          ),
        ),
      ),
    );
  }

  return {
    element: h("div", {}, tools, scroll(caption, table)),
    update(next) {
      rows = next;
      draw();
    },
  };
}

/** A button that deletes an entry; `done` is called then. */
export const deleteButton = (url, name, box, done) =>
  button(
    _("Delete"),
    () =>
      attempt(box, async () => {
        await remove(url);
        tell(_("Deleted {name}. Undo brings it back.", { name }));
        await done();
      }),
    { class: "small danger", "aria-label": _("Delete {name}", { name }) },
  );
