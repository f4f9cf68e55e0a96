// All legs in one table, a row for each visit.

import { download, get } from "../core/api.js";
import { byId, empty, h, replace } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { NONE, estimate, number, r2, unitText } from "../core/format.js";
import { attempt, onClick } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { mark, verdict } from "../ui/marks.js";
import { sortable } from "../ui/table.js";
import { _, many } from "../core/words.js";

const box = byId("error");
const request = () => `?which=${byId("all").checked ? "all" : "legs"}`;

const show = latest(async () => {
  const answer = await attempt(box, () => get(`/api/cohort${request()}`));
  if (!answer) return;
  const { measures, columns: parameters, rows } = answer;
  byId("export").disabled = rows.length === 0;
  if (!rows.length) return replace(byId("table"), empty(_("No legs yet."), _("Analyse the trials of a leg; give them a subject to see whose it is.")));
  const table = sortable(many("{n} row", "{n} rows", rows.length), columns(measures, parameters));
  table.update(rows);
  return replace(byId("table"), table.element);
});

const columns = (measures, parameters) => [
  { title: _("Leg"), value: (r) => r.name, show: (r) => h("a", { href: r.page }, r.name) },
  { title: _("Subject"), value: (r) => r.subject, show: (r) => r.subject || NONE },
  { look: "minor", title: _("Group"), value: (r) => r.group, show: (r) => _(r.group) || NONE },
  { look: "minor", title: _("Side"), value: (r) => r.side, show: (r) => r.side ? _(r.side) : NONE },
  { title: _("Visit"), value: (r) => r.visit, show: (r) => r.visit },
  ...measures.map((m) => ({
    title: unitText(m.unit) ? `${_(m.title)} [${unitText(m.unit).replace("deg", "°")}]` : _(m.title),
    numeric: true,
    value: (r) => r.measures[m.name]?.value ?? null,
    show: (r) => measured(r.measures[m.name]),
  })),
  { title: _("Fit"), value: (r) => r.grade, show: (r) => (r.grade ? mark(r.grade) : NONE) },
  { title: "R²", numeric: true, value: (r) => r.r2, show: (r) => r2(r.r2) },
  { look: "research", title: _("Model"), value: (r) => r.model_title, show: (r) => _(r.model_title) },
  ...parameters.map((p) => ({
    look: "research",
    title: unitText(p.unit) ? `${p.name} [${unitText(p.unit)}]` : p.name,
    numeric: true,
    value: (r) => r.parameters[p.name]?.value ?? null,
    show: (r) => cell(r.parameters[p.name]),
  })),
];

/** A number of so many digits as its interval tells, the interval below. */
function measured(one) {
  if (!one || one.value === null || one.low === null) return NONE;
  if (one.verdict === "undetermined") return verdict(one.verdict);
  const half = (one.high - one.low) / 2;
  return [estimate(one.value, half / 2), h("div", { class: "small" }, `${estimate(one.low, half / 2)} … ${estimate(one.high, half / 2)} `, one.verdict !== "identified" && verdict(one.verdict))];
}

function cell(one) {
  if (!one || one.value === null) return NONE;
  return [
    estimate(one.value, one.sem),
    h("div", { class: "small" }, one.sem ? `± ${number(one.sem, 2)} ` : "", one.verdict !== "identified" && verdict(one.verdict)),
  ];
}

byId("all").addEventListener("change", show);
onClick("export", box, () => download(`/api/cohort.csv${request()}`, "cohort.csv"));
onChanged(["fits", "sessions", "subjects", "recordings"], show);
show();
