// Rigid against compliant tendons: start a comparison of models, show what it says.

import { get, post } from "../core/api.js";
import { byId, h, replace, scroll } from "../core/dom.js";
import { NONE, number, quantity, vaf, when } from "../core/format.js";
import { attempt, complain } from "../core/notice.js";
import { status } from "../ui/marks.js";
import { active, cancel, follow, progressText } from "../ui/jobs.js";

export function showComparisons(result) {
  const box = byId("models-error");
  let job = null;

  function watch(found) {
    job = found;
    byId("models-start").disabled = true;
    byId("models-stop").hidden = false;
    follow(found.id, {
      progress: (told) => {
        byId("models-said").textContent = progressText(told, told.what);
      },
      end: async (ended) => {
        job = null;
        byId("models-start").disabled = false;
        byId("models-stop").hidden = true;
        byId("models-said").textContent = ended.state === "done" ? "The comparison is done." : ended.state === "cancelled" ? "Stopped." : "";
        if (ended.state === "failed") complain(box, ended.message);
        if (ended.result) await attempt(box, () => draw([ended.result]));
      },
    });
  }

  const shown = new Set();
  async function draw(ids) {
    for (const id of ids) {
      if (shown.has(id)) continue;
      shown.add(id);
      const told = await get(`/api/comparisons/${id}`);
      const card = comparison(told);
      byId("comparisons").prepend(card);
    }
  }

  byId("models-start").addEventListener("click", () => attempt(box, async () => watch(await post("/api/comparisons", { draft: result.settings, models: null, fit: result.summary.id }))));
  byId("models-stop").addEventListener("click", () => job && attempt(box, () => cancel(job.id)));
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
    scroll("Models compared", models(told.models)),
    told.changes.length > 0 && scroll("What changes with the tendon", changes(told)),
    h("details", {}, h("summary", {}, "How this is decided"), h("p", { class: "muted" }, told.rule)),
  );
}

const head = (texts) => h("thead", {}, h("tr", {}, texts.map((text, i) => h("th", { scope: "col", class: i > 1 ? "num" : null }, text))));
const num = (text) => h("td", { class: "num" }, text);

function models(rows) {
  return h(
    "table",
    {},
    h("caption", {}, "ΔAICc: above the best model's. Held out: the VAF of stretches that were not fitted to."),
    head(["Model", "Status", "Free", "VAF", "RMSE", "ΔAICc", "VAF, held out", "Gain of it"]),
    h(
      "tbody",
      {},
      rows.map((one) =>
        h(
          "tr",
          {},
          h("th", { scope: "row" }, one.title),
          h("td", { title: one.message }, status(one.status)),
          num(String(one.n_free)),
          num(vaf(one.vaf)),
          num(`${number(one.rmse, 3)} Nm`),
          num(number(one.delta, 4)),
          num(one.held_out ? vaf(one.held_out.vaf) : (one.held_out_note || NONE)),
          num(one.held_out && !one.rigid ? `${number(one.held_out.gain, 2)} ± ${number(one.held_out.gain_se, 2)} %` : NONE),
        ),
      ),
    ),
  );
}

function changes({ changes: rows, models: fitted }) {
  const title = Object.fromEntries(fitted.map((one) => [one.model, one.title]));
  return h(
    "table",
    {},
    h("caption", {}, "What compliant tendons change in the other parameters"),
    head(["Parameter", "Model", "Rigid", "Compliant", "Change"]),
    h(
      "tbody",
      {},
      rows.map((one) =>
        h(
          "tr",
          {},
          h("th", { scope: "row" }, one.parameter),
          h("td", {}, title[one.model]),
          num(quantity(one.rigid, one.unit, 3)),
          num(quantity(one.compliant, one.unit, 3)),
          num(one.percent === null ? NONE : `${one.percent > 0 ? "+" : ""}${number(one.percent, 2)} %`),
        ),
      ),
    ),
  );
}
