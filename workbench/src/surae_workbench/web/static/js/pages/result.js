// One fit: what came out, how sure it is, and what else the data say.

import { download, get, patch, query } from "../core/api.js";
import { byId, field, figures, h, replace } from "../core/dom.js";
import { change, draftState, loadDraft } from "../core/draft.js";
import { onChanged } from "../core/events.js";
import { number, seconds, vaf, when } from "../core/format.js";
import { attempt, headline, onClick } from "../core/notice.js";
import { torquePlot } from "../plot/torque.js";
import { showCorrelations } from "../result/correlations.js";
import { showDetails } from "../result/details.js";
import { estimates } from "../result/estimates.js";
import { profiles } from "../result/profiles.js";
import { showShort } from "../result/short.js";
import { traces } from "../result/traces.js";
import { showUnsure } from "../result/unsure.js";
import { validation } from "../result/validation.js";
import { ask } from "../ui/dialog.js";
import { meant, older, status } from "../ui/marks.js";
import { tabs } from "../ui/tabs.js";

const id = byId("fit").dataset.id;
let result = null;

function showHead() {
  const { summary, fit } = result;
  const what = `${summary.title} · ${summary.names.join(", ")}`;
  headline(summary.name, [summary.name === what ? "" : what, when(summary.created)]);
  const { grade, mark, sentence, reasons } = result.adequacy;
  byId("adequacy").className = `adequacy ${grade}`;
  byId("adequacy").hidden = false;
  replace(byId("adequacy"), h("p", {}, h("span", { "aria-hidden": "true" }, `${mark} `), sentence), reasons.length > 0 && h("ul", {}, reasons.map((reason) => h("li", {}, reason))));
  const entries = [
    ["Status", [status(fit.status), " ", older(summary)]],
    ["Centred R²", vaf(fit.adequacy.r2)],
    [meant("vaf", "VAF"), vaf(fit.vaf)],
    [meant("residual", "RMSE"), `${number(fit.rmse_Nm, 3)} Nm`],
    [meant("ipde", "IPDE"), h("span", { title: fit.ipde_note || null }, number(summary.ipde, 3))],
    ["Starts that agree", `${summary.agreeing} of ${summary.starts}`],
    ["Took", seconds(summary.seconds)],
  ];
  replace(byId("figures"), figures(entries));
}

async function overview() {
  const plot = torquePlot();
  const several = result.fit.recordings.length > 1;
  const seen = await attempt(byId("overview-error"), () => get(`/api/fits/${id}/traces?recording=0&points=2000`));
  if (!seen) return;
  replace(byId("overview"), several && h("p", { class: "muted small" }, `${seen.name}; the others are under “Torque and its parts”.`), plot.element);
  plot.show(seen.t, seen.measured, seen.modelled);
}

async function read() {
  result = await get(`/api/fits/${id}`);
  showHead();
  replace(byId("parameter-table"), estimates(result));
  showUnsure(result, id);
  showCorrelations(result);
  showDetails(result);
}

function file(knob, url, name) {
  const label = byId(knob).textContent;
  byId(knob).addEventListener("click", async () => {
    byId(knob).textContent = "Making it …";
    await attempt(byId("error"), () => download(url, name), byId(knob));
    byId(knob).textContent = label;
  });
}

file("report-html", `/api/fits/${id}/report.html`, "report.html");
file("report-pdf", `/api/fits/${id}/report.pdf`, "report.pdf");
byId("language").addEventListener("change", () => showShort(id));
onClick("clinical-html", byId("short-error"), () => download(`/api/fits/${id}/clinical.html${query({ language: byId("language").value })}`, "page.html"));
file("save-json", `/api/fits/${id}/fit.json`, "fit.json");

byId("rename").addEventListener("click", async () => {
  const name = h("input", { type: "text", required: true, maxlength: 120, value: result.summary.name });
  if (!(await ask("Rename the fit", field("Name", name), { confirm: "Save" }))) return;
  await attempt(byId("error"), async () => {
    await patch(`/api/fits/${id}`, { name: name.value.trim() });
    await read();
  });
});

onClick("resume", byId("error"), async () => {
  const values = Object.fromEntries(
    Object.entries(result.fit.parameters).filter(([, p]) => p.value !== null).map(([name, p]) => [name, p.value]),
  );
  const { parameters, exclusions, sliders, ...asked } = result.settings;
  // Entries that this browser has and the fit had not are taken away.
  const now = draftState()?.draft ?? (await loadDraft()).draft;
  const only = (key, wanted) => ({ ...Object.fromEntries(Object.keys(now[key]).map((name) => [name, null])), ...wanted });
  await change(
    { ...asked, exclusions: only("exclusions", exclusions), sliders: only("sliders", values) },
    `settings of ${result.summary.name}`,
  );
  location.href = "/fit";
});

byId("report-show").addEventListener("click", () =>
  replace(byId("report-place"), h("iframe", { class: "report-frame", title: "Report of the fit", src: `/api/fits/${id}/report.html?inline=true` })),
);

// Tabs open at once; what is in them comes with the fit.
const ready = attempt(byId("error"), read);
const filled = (work) => () => ready.then(() => result && work());
tabs(byId("tabs"), {
  short: filled(() => showShort(id)),
  parameters: filled(overview),
  torque: filled(() => traces(id, result)),
  profiles: filled(() => profiles(id, () => result, read)),
  validation: filled(() => validation(id, result)),
});
onChanged(["fits"], () => attempt(byId("error"), read));
