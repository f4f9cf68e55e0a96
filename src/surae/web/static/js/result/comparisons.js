// Rigid against compliant tendons: start a comparison of models, show what it says.

import { get, post } from "../core/api.js";
import { byId, h, replace, scroll } from "../core/dom.js";
import { number, vaf, when } from "../core/format.js";
import { attempt, complain } from "../core/notice.js";
import { active, cancel, follow } from "../ui/jobs.js";

export function showComparisons(result) {
  const box = byId("models-error");
  let job = null;

  function watch(found) {
    job = found;
    byId("models-start").disabled = true;
    byId("models-stop").hidden = false;
    follow(found.id, {
      progress: (told) => {
        byId("models-said").textContent = `${told.what}: ${told.done} of ${told.total}`;
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

  byId("models-start").addEventListener("click", () => attempt(box, async () => watch(await post("/api/comparisons", { draft: result.settings, models: null }))));
  byId("models-stop").addEventListener("click", () => job && attempt(box, () => cancel(job.id)));
  attempt(box, async () => {
    await draw(result.comparisons.map((one) => one.id));
    const running = (await active("compare")).find((one) => one.mine);
    if (running) watch(running);
  });
}

function comparison(told) {
  const models = Array.isArray(told.models) ? told.models : Object.entries(told.models ?? {}).map(([name, one]) => ({ name, ...one }));
  return h(
    "article",
    { class: "panel" },
    h("h3", {}, `Comparison of ${when(told.created)}`),
    h("p", {}, h("strong", {}, told.conclusion)),
    (told.cautions ?? []).length > 0 && h("ul", { class: "note" }, told.cautions.map((line) => h("li", {}, line))),
    models.length > 0 && scroll("Models compared", table(models)),
  );
}

const WORDS = { model: "Model", name: "Model", vaf: "VAF", rmse_Nm: "RMSE [Nm]", status: "Status", aic: "AIC", aicc: "AICc", bic: "BIC", free: "Free", weight: "Weight" };

/** What a comparison knows of each model: its plain numbers and words. */
function table(models) {
  const keys = Object.keys(models[0]).filter((key) => models.every((one) => one[key] === null || typeof one[key] !== "object"));
  return h(
    "table",
    {},
    h("caption", {}, "The models on the same recordings"),
    h("thead", {}, h("tr", {}, keys.map((key) => h("th", { scope: "col" }, WORDS[key] ?? key.replaceAll("_", " "))))),
    h(
      "tbody",
      {},
      models.map((one) => h("tr", {}, keys.map((key, i) => h(i ? "td" : "th", { scope: i ? null : "row" }, key.endsWith("vaf") ? vaf(one[key]) : typeof one[key] === "number" ? number(one[key], 5) : String(one[key] ?? "—"))))),
    ),
  );
}
