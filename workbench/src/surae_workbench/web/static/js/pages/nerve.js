// How much is nerve: recordings of one leg, and what their report says.

import { download, get, query } from "../core/api.js";
import { byId, html, replace } from "../core/dom.js";
import { attempt, onClick } from "../core/notice.js";
import { trialList } from "../ui/trials.js";

const id = byId("nerve").dataset.id;
const box = byId("error");
const chosen = new Set([id]);
const reports = ["html", "pdf"].map((kind) => byId(`report-${kind}`));
const asked = () => query({ recordings: [...chosen].join(","), by: new FormData(byId("ask")).get("by") });

function forget() {
  replace(byId("told"));
  for (const knob of reports) knob.hidden = true;
}

byId("ask").addEventListener("change", forget);
byId("ask").addEventListener("submit", async (event) => {
  event.preventDefault();
  forget();
  const answer = await attempt(box, () => get(`/api/nerve${asked()}`), byId("tell"));
  if (!answer) return;
  replace(byId("told"), html(answer.html));
  for (const knob of reports) knob.hidden = false;
});
for (const kind of ["html", "pdf"]) onClick(`report-${kind}`, box, () => download(`/api/nerve/report.${kind}${asked()}`, `nerve.${kind}`));

attempt(box, async () => {
  const { recordings } = await get("/api/recordings");
  const own = recordings.find((one) => one.id === id);
  const leg = recordings.filter((one) => one.subject === own.subject && one.side === own.side);
  const choose = (one, wanted) => (wanted ? chosen.add(one.id) : chosen.delete(one.id));
  replace(byId("recordings"), trialList(leg, chosen, choose, (one) => [one.trial, one.condition]));
  const { findings } = await get(`/api/recordings/${id}/quality`);
  byId("ask").elements.by.value = findings.some((one) => one.advice.includes("surae impedance")) ? "perturbations" : "stretches";
});
