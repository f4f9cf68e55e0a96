// The bench: recordings, model, sliders, and the fit as it converges.

import { get, post } from "../core/api.js";
import { byId, empty, h, replace } from "../core/dom.js";
import { change, draft, onDraft } from "../core/draft.js";
import { onChanged } from "../core/events.js";
import { number, seconds, r2 } from "../core/format.js";
import { attempt, calm, complain } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { torquePlot } from "../plot/torque.js";
import { demoButton } from "../ui/demo.js";
import { active, jobControls, progressText } from "../ui/jobs.js";
import { parameterTable } from "../ui/parameters.js";
import { settingsForm } from "../ui/settings.js";
import { trialList } from "../ui/trials.js";
import { _ } from "../core/words.js";

const box = { page: byId("error"), fit: byId("fit-error"), parameters: byId("parameters-error") };
let models = null;
let recordings = [];
let sorted = false; // whether those that are chosen stand first
let shown = null; // which recording is drawn

const plot = torquePlot();
replace(byId("plot"), plot.element);
const table = parameterTable({
  slide: (name, value) => live({ [name]: value }),
  settle: (name, value) => store({ sliders: { [name]: value } }, _("slide {name}", { name }), true),
  set: (name, changes, label) => store({ parameters: { [name]: changes } }, label),
});
replace(byId("parameters"), table.element);

const store = (what, label, merge = false) => attempt(box.parameters, () => change(what, label, { merge }));

// --- the modelled torque at the sliders

let slid = {};
/** The model and the values that the fit is at, until a slider is moved. */
let reached = null;
const draw = latest(async () => {
  if (!shown || (controls.busy() && !reached)) return;
  try {
    const seen = await post("/api/live", { recording: shown, points: 2000, ...(reached ?? { values: slid }) });
    plot.show(seen.t, seen.measured, seen.modelled);
    byId("live-figures").textContent = [
      seen.r2 === null ? "" : `R² ${r2(seen.r2)}`,
      seen.rmse === null ? "" : `RMSE ${number(seen.rmse, 3)} Nm`,
    ].filter(Boolean).join(" · ");
    calm(box.parameters);
  } catch (error) {
    complain(box.parameters, error);
  }
});

function live(values) {
  slid = { ...slid, ...values };
  reached = null;
  draw();
}

// --- what is fitted

function showRecordings() {
  const chosen = draft().recordings;
  if (!sorted) recordings.sort((a, b) => chosen.includes(b.id) - chosen.includes(a.id));
  sorted = true;
  replace(byId("recordings"), trialList(recordings, new Set(chosen), choose, (one) => [seconds(one.duration_s), excludedText(one.id)]));
  const known = chosen.filter((id) => recordings.some((one) => one.id === id));
  shown = known.includes(shown) ? shown : (known[0] ?? null);
  byId("which-field").hidden = known.length < 2;
  replace(byId("which"), known.map((id) => h("option", { value: id }, recordings.find((one) => one.id === id).name)));
  byId("which").value = shown ?? "";
}

function excludedText(id) {
  const spans = draft().exclusions[id] ?? [];
  return spans.length ? _("{s} s left out", { s: number(spans.reduce((sum, [a, b]) => sum + b - a, 0), 3) }) : "";
}

function choose(recording, wanted) {
  const others = draft().recordings.filter((id) => id !== recording.id);
  store({ recordings: wanted ? [...others, recording.id] : others }, wanted ? _("fit {name}", recording) : _("leave out {name}", recording));
}

const showTable = latest(async () => {
  const report = await attempt(box.parameters, () => get("/api/draft/parameters"));
  if (!report) return;
  table.update(report.parameters);
  const chosen = draft().recordings.length > 0;
  byId("plot").hidden = !chosen;
  if (report.problem && chosen) complain(box.fit, report.problem);
  else calm(box.fit);
  if (!controls.busy()) byId("live-figures").textContent = chosen ? "" : _("Choose a recording above.");
  byId("start").disabled = Boolean(report.problem) || controls.busy();
  slid = {};
  if (!controls.busy()) reached = null;
  draw();
});

function showDraft() {
  if (!models) return;
  showRecordings();
  settingsForm(byId("settings"), byId("more-settings"), models, draft(), (what, label) => store(what, label), recordings);
  showTable();
}

// --- the fit

const elements = { start: byId("start"), stop: byId("cancel"), bar: byId("progress"), line: byId("job-line"), said: byId("job-said") };
const controls = jobControls(elements, box.fit, {
  progress: (report) => {
    if (report.values) {
      reached = { model: report.model, values: report.values };
      table.move(report.values);
      draw();
    }
    return report.total ? _("start {n} of {total} · iteration {iteration}", { ...report, n: Math.min(report.done + 1, report.total) }) : progressText(report, "");
  },
  ended: (now) => {
    const words = { done: _("The fit is done."), cancelled: now.result ? _("Stopped; the best so far is kept.") : _("Stopped before there was anything to keep."), interrupted: _("The server was stopped during the fit. Choose Fit to do it again.") };
    return [words[now.state] ?? "", " ", now.result && h("a", { href: `/fits/${now.result}`, class: "button small primary" }, _("Open the result"))];
  },
  done: (now) => {
    table.lock(false);
    if (now.result) draw();
    else if (now.state !== "failed") showTable(); // which would take the reason away
  },
});

function watch(found) {
  reached = null;
  table.lock(true);
  controls.watch(found);
}

byId("start").addEventListener("click", () => attempt(box.fit, async () => watch(await post("/api/fits"))));
byId("which").addEventListener("change", () => {
  shown = byId("which").value;
  draw();
});
/** What takes all entries of a part of the draft away. */
const none = (key) => Object.fromEntries(Object.keys(draft()[key]).map((name) => [name, null]));
byId("centre").addEventListener("click", () => store({ sliders: none("sliders") }, _("reset the sliders")));
byId("defaults").addEventListener("click", () => store({ parameters: none("parameters"), sliders: none("sliders") }, _("defaults for all parameters")));
byId("adopt").addEventListener("click", () => {
  const now = draft();
  const report = Object.fromEntries(Object.entries(now.sliders).map(([name, value]) => [name, { ...now.parameters[name], value }]));
  if (Object.keys(report).length) store({ parameters: report }, _("start from the sliders"));
});

const refresh = latest(() => attempt(box.page, async () => {
  ({ recordings } = await get("/api/recordings"));
  sorted = false;
  const none = !recordings.length;
  byId("bench").hidden = none;
  byId("empty").hidden = !none;
  if (none) {
    replace(byId("empty"), empty(_("No recordings yet."), _("A fit needs one."), h("a", { class: "button primary", href: "/import" }, _("Import a file")), demoButton(box.page)));
  }
  if (draft()) showDraft();
}));

onChanged(["recordings"], () => refresh());
attempt(box.page, async () => {
  models = await get("/api/models");
  await refresh();
  onDraft(showDraft);
  const mine = (await active("fit")).find((one) => one.mine);
  if (mine) watch(mine);
});
