// All subjects in one table.

import { download, get, query } from "../core/api.js";
import { byId, empty, h, replace } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { NONE, estimate, number, unitText, vaf } from "../core/format.js";
import { attempt, onClick } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { status, verdict } from "../ui/marks.js";
import { sortable } from "../ui/table.js";

const box = byId("error");
const asked = () => query({ model: byId("model").value, which: byId("which").value });

const show = latest(async () => {
  const told = await attempt(box, () => get(`/api/cohort${asked()}`));
  if (!told) return;
  sessionStorage.setItem("surae.cohort", JSON.stringify([byId("model").value, byId("which").value]));
  byId("export").disabled = told.rows.length === 0;
  if (!told.rows.length) {
    replace(byId("table"), empty("No fits of this model yet.", "Fit recordings, and give them a subject on the Project page."));
    return;
  }
  const table = sortable(`${told.rows.length} ${told.rows.length === 1 ? "fit" : "fits"}.`, columns(told));
  table.update(told.rows);
  replace(byId("table"), table.element);
});

function columns({ columns: parameters }) {
  return [
    { title: "Subject", value: (r) => r.subject, show: (r) => h("a", { href: `/fits/${r.fit}` }, r.subject || r.name) },
    { title: "Group", value: (r) => r.group, show: (r) => r.group || NONE },
    { title: "Side", value: (r) => r.side, show: (r) => r.side ?? NONE },
    { title: "Trial", value: trial, show: trial },
    { title: "Status", value: (r) => r.status, show: (r) => status(r.status) },
    { title: "VAF", numeric: true, value: (r) => r.vaf, show: (r) => vaf(r.vaf) },
    { title: "IPDE", numeric: true, value: (r) => r.ipde, show: (r) => number(r.ipde, 3) },
    ...parameters.map((p) => ({
      title: unitText(p.unit) ? `${p.name} [${unitText(p.unit)}]` : p.name,
      numeric: true,
      value: (r) => r.parameters[p.name]?.value ?? null,
      show: (r) => cell(r.parameters[p.name]),
    })),
  ];
}

/** What tells rows of one leg apart: the trial as it was labelled, else its recordings. */
const trial = (r) => [r.trial, r.condition].filter(Boolean).join(", ") || (r.names.length > 2 ? `${r.names.length} recordings` : r.names.join(", "));

function cell(one) {
  if (!one || one.value === null) return NONE;
  return [
    estimate(one.value, one.sem),
    h("div", { class: "small" }, one.sem ? `± ${number(one.sem, 2)} ` : "", one.verdict !== "identified" && verdict(one.verdict)),
  ];
}

byId("model").addEventListener("change", show);
byId("which").addEventListener("change", show);
onClick("export", box, () => download(`/api/cohort.csv${asked()}`, "cohort.csv"));
onChanged(["fits", "subjects", "recordings"], show);

attempt(box, async () => {
  const { models } = await get("/api/models");
  replace(byId("model"), models.map((one) => h("option", { value: one.name }, one.title)));
  const [model, which] = JSON.parse(sessionStorage.getItem("surae.cohort") ?? "[null, null]");
  if (models.some((one) => one.name === model)) byId("model").value = model;
  if (which) byId("which").value = which;
  await show();
});
