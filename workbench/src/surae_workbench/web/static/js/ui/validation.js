// Do the parameters predict trials they were not fitted to?

import { post } from "../core/api.js";
import { byId, h, html, replace, tick } from "../core/dom.js";
import { attempt, complain } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { paged } from "./paged.js";

export function validation(id, { summary }) {
  const box = byId("validate-error");
  const ticked = () => [...byId("validate-list").querySelectorAll("input:checked")].map((input) => input.value);
  const pages = paged("recordings", () => list(), ticked);
  const list = latest(() => attempt(box, async () => {
    const chosen = ticked();
    const ranked = (await pages.read()).rows.sort((a, b) => Number(summary.recordings.includes(a.id)) - Number(summary.recordings.includes(b.id)));
    replace(
      byId("validate-list"),
      pages.element,
      h("ul", { class: "list" }, ranked.map((one) =>
        h("li", {}, tick([one.name, summary.recordings.includes(one.id) && h("span", { class: "muted small" }, "(fitted to: not a test)")], chosen.includes(one.id), null, { value: one.id })),
      )),
    );
  }));
  list();
  byId("validate-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const chosen = ticked();
    if (!chosen.length) {
      complain(box, "choose at least one recording");
      return;
    }
    const answer = await attempt(box, () => post(`/api/fits/${id}/validate`, { recordings: chosen }), byId("validate-start"));
    if (answer) replace(byId("predictions"), html(answer.html));
  });
}
