// Do the parameters predict trials they were not fitted to?

import { get, post } from "../core/api.js";
import { byId, html, replace } from "../core/dom.js";
import { attempt, complain } from "../core/notice.js";
import { trialList } from "./trials.js";
import { _ } from "../core/words.js";

export async function validation(id, { summary }) {
  const box = byId("validate-error");
  const chosen = new Set();
  const fitted = (one) => summary.recordings.includes(one.id);
  byId("validate-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    if (!chosen.size) {
      complain(box, _("choose at least one recording"));
      return;
    }
    const answer = await attempt(box, () => post(`/api/fits/${id}/validate`, { recordings: [...chosen] }), byId("validate-start"));
    if (answer) replace(byId("predictions"), html(answer.html));
  });
  await attempt(box, async () => {
    const { recordings } = await get("/api/recordings");
    const ranked = recordings.sort((a, b) => Number(fitted(a)) - Number(fitted(b)));
    const choose = (one, wanted) => (wanted ? chosen.add(one.id) : chosen.delete(one.id));
    replace(byId("validate-list"), trialList(ranked, chosen, choose, (one) => [fitted(one) && _("fitted to: not a test")]));
  });
}
