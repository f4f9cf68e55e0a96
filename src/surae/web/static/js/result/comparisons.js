// Rigid against compliant tendons: start a comparison of models, show what it says.

import { get, post } from "../core/api.js";
import { byId, h, num, table } from "../core/dom.js";
import { NONE, number, quantity, vaf, when } from "../core/format.js";
import { attempt } from "../core/notice.js";
import { status } from "../ui/marks.js";
import { active, jobControls, progressText } from "../ui/jobs.js";

export function showComparisons(result) {
  const box = byId("models-error");
  const watch = jobControls({ start: byId("models-start"), stop: byId("models-stop"), said: byId("models-said") }, box, {
    progress: (told) => progressText(told, told.what),
    ended: ({ state }) => ({ done: "The comparison is done.", cancelled: "Stopped." })[state] ?? "",
    done: (job) => job.result && attempt(box, () => draw([job.result])),
  });

  const shown = new Set();
  async function draw(ids) {
    for (const id of ids) {
      if (shown.has(id)) continue;
      shown.add(id);
      byId("comparisons").prepend(comparison(await get(`/api/comparisons/${id}`)));
    }
  }

  byId("models-start").addEventListener("click", () => attempt(box, async () => watch(await post("/api/comparisons", { draft: result.settings, models: null, fit: result.summary.id }))));
  attempt(box, async () => {
    await draw(result.comparisons.map((one) => one.id));
    const running = (await active("compare")).find((one) => one.fit === result.summary.id);
    if (running) watch(running);
  });
}

function comparison(told) {
  return h(
    "article",
    { class: "panel" },
    h("h3", {}, `Comparison of ${when(told.created)}`),
    h("p", {}, h("strong", {}, told.conclusion)),
    told.cautions.map((line) => h("p", { class: "note" }, line)),
    models(told.models),
    told.changes.length > 0 && changes(told),
    h("details", {}, h("summary", {}, "How this is decided"), h("p", { class: "muted" }, told.rule)),
  );
}

const models = (rows) =>
  table(
    "Models compared",
    ["Model", "Status", "Free", "VAF", "RMSE", "ΔAICc", "VAF, held out", "Gain of it"],
    rows.map((one) => [
      one.title,
      h("td", { title: one.message }, status(one.status)),
      num(String(one.n_free)),
      num(vaf(one.vaf)),
      num(`${number(one.rmse, 3)} Nm`),
      num(number(one.delta, 4)),
      num(one.held_out ? vaf(one.held_out.vaf) : (one.held_out_note || NONE)),
      num(one.held_out && !one.rigid ? `${number(one.held_out.gain, 2)} ± ${number(one.held_out.gain_se, 2)} %` : NONE),
    ]),
    { caption: "ΔAICc: above the best model's. Held out: the VAF of stretches that were not fitted to.", numbers: [2, 7] },
  );

function changes({ changes: rows, models: fitted }) {
  const title = Object.fromEntries(fitted.map((one) => [one.model, one.title]));
  return table(
    "What changes with the tendon",
    ["Parameter", "Model", "Rigid", "Compliant", "Change"],
    rows.map((one) => [
      one.parameter,
      title[one.model],
      num(quantity(one.rigid, one.unit, 3)),
      num(quantity(one.compliant, one.unit, 3)),
      num(one.percent === null ? NONE : `${one.percent > 0 ? "+" : ""}${number(one.percent, 2)} %`),
    ]),
    { caption: "What compliant tendons change in the other parameters", numbers: [2, 4] },
  );
}
