// One session: what each trial is, who predicts whom, each parameter by trial.

import { download, get } from "../core/api.js";
import { byId, h, num, replace, table } from "../core/dom.js";
import { when } from "../core/format.js";
import { attempt, headline, onClick } from "../core/notice.js";
import { mark, meant } from "../ui/marks.js";

const id = byId("session").dataset.id;

/** A number with what goes below it, as the report has it. */
const cell = ({ text, under, kind }) => h("td", { class: `num told ${kind}` }, text, under && h("span", { class: "under" }, under));

/** A table; columns are numbers from the one that `numbers` says. */
const results = (label, numbers, heads, rows) => table(label, heads, rows, { caption: h("caption", { class: "sr" }, label), numbers: [numbers, heads.length] });

function show({ summary, content, fits, paper }) {
  headline(summary.name, [content.about, when(summary.created)]);
  byId("report-pdf").hidden = !paper;
  byId("joint").hidden = !fits.joint;
  if (fits.joint) byId("joint").href = `/fits/${fits.joint.id}`;
  const judged = content.adequacy;
  byId("adequacy").hidden = !judged;
  if (judged) {
    byId("adequacy").className = `adequacy ${judged.grade}`;
    replace(byId("adequacy"), h("p", {}, h("span", { "aria-hidden": "true" }, `${judged.mark} `), `All together (${content.joined.length} trials): ${judged.sentence}`), judged.reasons.length > 0 && h("ul", {}, judged.reasons.map((reason) => h("li", {}, reason))));
  }
  const notes = [content.interrupted && "It was stopped: what follows is of the fits that were complete.", !judged && content.no_joint && `No fit of all together: ${content.no_joint}.`, ...content.common, ...content.contradictions];
  replace(byId("warnings"), notes.filter(Boolean).map((text) => h("p", { class: "note" }, text)), content.summary.map((text) => h("p", {}, text)));
  replace(byId("trials"), results("What each trial is, and how it is followed", 4, ["Trial", "What it is", "Used for", "Check", "Alone, R² [%]", "All together, R² [%]"], content.trials.map((row) => [
    fits[row.name] ? h("a", { href: `/fits/${fits[row.name].id}` }, row.name) : row.name,
    h("td", { class: "what" }, row.what, h("div", { class: "muted small" }, row.why), row.problem && h("div", { class: "small" }, row.problem)),
    row.use,
    [["error", "warning"].includes(row.worst) && mark(row.worst), h("div", { class: "muted small" }, row.findings)],
    cell(row.alone),
    cell(row.together),
  ])));
  part("crossed", content.crossed.length, () => results("Cross-prediction", 1, ["Parameters of", ...content.crossed_names], content.crossed.map(([name, cells]) => [name, ...cells.map(cell)])));
  part("parameters", content.parameters.length, () => results("Every parameter in every fit", 2, ["Parameter", "Unit", ...(judged ? ["All together"] : []), ...content.fitted, "Spread"], content.parameters.map((row) => [meant(row.name), row.unit, ...(judged ? [cell(row.joint)] : []), ...row.trials.map(cell), num(row.spread)])));
  part("holds", content.holds.length, () => results("Torque of trials that hold still", 2, ["Trial", "Effort", "Angle [°]", "Torque [Nm]", "Predicted by all together [Nm]"], content.holds.map(([name, effort, ...texts]) => [name, effort, ...texts.map(num)])));
  const found = content.findings.filter(([, rows]) => rows.length);
  replace(byId("found"), found.length ? found.map(([name, rows]) => h("div", {}, h("h3", {}, name), h("ul", {}, rows.map(([severity, , message, advice]) => h("li", {}, mark(severity), " ", message, " ", h("span", { class: "muted" }, advice)))))) : h("p", {}, "Nothing that speaks against them."));
}

function part(name, count, make) {
  byId(`${name}-card`).hidden = !count;
  if (count) replace(byId(name), make());
}

for (const kind of ["html", "pdf"]) {
  onClick(`report-${kind}`, byId("error"), () => download(`/api/sessions/${id}/report.${kind}`, `session.${kind}`));
}
attempt(byId("error"), async () => show(await get(`/api/sessions/${id}`)));
