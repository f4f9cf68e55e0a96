// A long list, part by part, as the server gives it.

import { get, query } from "../core/api.js";
import { button, h } from "../core/dom.js";
import { settled } from "../core/pace.js";

const COUNT = 100;

/**
 * The part of a list that is looked at, and what leads to its other parts.
 *
 * @param kind "recordings" or "fits"
 * @param changed called when another part is wanted
 * @param also gives the ids of those that are wanted whatever is looked at
 * @returns {element, order(key, down), read()}; what is read has `rows`, those of `also` first
 */
export function paged(kind, changed, also = () => []) {
  let [start, sort, down] = [0, "created", true];
  const go = (to) => {
    start = to;
    changed();
  };
  const find = h("input", { type: "search", "aria-label": `Find ${kind}`, placeholder: "Find", maxlength: 200, "data-focus": `find-${kind}` });
  const said = h("span", { class: "muted small", role: "status" });
  const back = button("Previous", () => go(Math.max(start - COUNT, 0)), { class: "small", "aria-label": `Previous ${kind}`, "data-focus": `previous-${kind}` });
  const on = button("Next", () => go(start + COUNT), { class: "small", "aria-label": `Next ${kind}`, "data-focus": `next-${kind}` });
  const element = h("div", { class: "button-row", hidden: true }, find, said, back, on);
  find.addEventListener("input", settled(() => go(0), 150));

  async function read() {
    const request = query({ start, count: COUNT, find: find.value, sort, down, also: also().join(",") });
    const answer = await get(`/api/${kind}${request}`);
    const page = answer[kind];
    if (!page.length && start) {
      start = 0;
      return read();
    }
    const known = new Set((answer.also ?? []).map((one) => one.id));
    element.hidden = (answer.total ?? page.length) <= COUNT && !find.value;
    said.textContent = page.length ? `${start + 1} to ${start + page.length} of ${answer.total}` : "none found";
    back.disabled = start === 0;
    on.disabled = start + page.length >= answer.total;
    return { rows: [...(answer.also ?? []), ...page.filter((one) => !known.has(one.id))], none: !page.length && !find.value };
  }

  return {
    element,
    read,
    order(key, wanted) {
      [sort, down] = [key, wanted];
      go(0);
    },
  };
}
