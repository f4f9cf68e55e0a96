// One leg: its report, and what changed since another visit.

import { download, get, query } from "../core/api.js";
import { byId, h, html, replace, select } from "../core/dom.js";
import { when } from "../core/format.js";
import { attempt, headline, onClick } from "../core/notice.js";

const id = byId("session").dataset.id;

function show({ summary, visits, paper }) {
  headline(summary.name, [`${summary.trials} trials`, when(summary.created)]);
  byId("report-pdf").hidden = !paper;
  byId("joint").hidden = !summary.fit;
  byId("joint").href = `/fits/${summary.fit}`;
  const place = document.querySelector(".report [aria-labelledby=change]");
  if (!place || !visits.length) return;
  const changed = h("div", { role: "status" }, [...place.querySelectorAll(":scope > :not(h2)")]);
  const knob = select({ "aria-label": "Compare with" }, [["", "Compare with …"], ...visits.map((v) => [v.id, `${v.name}, ${when(v.created)}`])], "");
  knob.addEventListener("change", () => knob.value && attempt(byId("error"), async () =>
    replace(changed, html((await get(`/api/sessions/${id}/change${query({ before: knob.value })}`)).html)), knob));
  place.append(changed, knob);
}

for (const kind of ["html", "pdf"]) {
  onClick(`report-${kind}`, byId("error"), () => {
    const language = byId("language").value;
    return download(`/api/sessions/${id}/report.${kind}${query({ language })}`, `session.${kind}`);
  });
}
attempt(byId("error"), async () => show(await get(`/api/sessions/${id}`)));
