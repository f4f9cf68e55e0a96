// Analyse a leg: which trials, what each of them is, and the fits at work.

import { get, post } from "../core/api.js";
import { byId, empty, h, replace, select, table } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { seconds } from "../core/format.js";
import { attempt, complain } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { demoButton } from "../ui/demo.js";
import { active, jobControls, progressText } from "../ui/jobs.js";
import { trialList } from "../ui/trials.js";
import { _, language, many } from "../core/words.js";

const box = { page: byId("error"), fit: byId("new-error") };
let recordings = [];
let people = [];
let legs = [];
let chosen = null;
/** Efforts that were stated, by recording. */
const efforts = {};

/** What belongs together at first: the recordings of the newest visit of a leg. */
function leg() {
  const [first] = recordings;
  return recordings.filter((one) => ["subject", "side", "visit"].every((key) => one[key] === first[key])).map((one) => one.id);
}

function showRecordings() {
  const code = (id) => people.find((one) => one.id === id)?.code;
  replace(byId("recordings"), trialList(recordings, chosen, choose, (one) => [code(one.subject), one.side, seconds(one.duration_s)]));
}

function choose({ id }, wanted) {
  if (wanted) chosen.add(id);
  else chosen.delete(id);
  sort();
}

// What each trial is depends on the others: EMG is judged by the session's largest.
const sort = latest(async () => {
  byId("start").disabled = true;
  offerQuestion();
  if (!chosen.size) return replace(byId("trials"), h("p", { class: "muted" }, _("Choose the trials of one leg.")));
  byId("trials").setAttribute("aria-busy", "true");
  const answer = await attempt(box.fit, () => post("/api/sessions/trials", request()));
  byId("trials").removeAttribute("aria-busy");
  if (!answer) return replace(byId("trials"));
  byId("start").disabled = controls.busy() || !answer.trials.some((one) => one.fitted);
  return replace(byId("trials"), sorted(answer.trials));
});

const request = () => ({ recordings: recordings.map((one) => one.id).filter((id) => chosen.has(id)), efforts: Object.fromEntries(Object.entries(efforts).filter(([id]) => chosen.has(id))) });

const sorted = (trials) =>
  table(_("What each trial is"), [_("Trial"), _("What it is"), _("Effort"), _("Used for")], trials.map((one) => [
    one.name, h("td", { class: "what" }, one.problem || one.what.split(", ").map((word) => _(word)).join(", "), h("div", { class: "muted small", lang: "en" }, one.problem ? "" : one.why)), effort(one), _(one.use),
  ]), { class: "narrow", caption: _("What each trial is, and what it is used for") });

function effort(one) {
  const options = [["", one.stated ? _("as its signals say") : _("{effort}, by its signals", { effort: _(one.effort) })], ...["passive", "active", "maximal", "empty device", "one muscle at a time"].map((name) => [name, _(name)])];
  const knob = select({ "aria-label": _("Effort of {name}", { name: one.name }), "data-focus": `effort-${one.recording}` }, options, efforts[one.recording] ?? "");
  knob.addEventListener("change", () => {
    if (knob.value) efforts[one.recording] = knob.value;
    else delete efforts[one.recording];
    sort();
  });
  return knob;
}

/** How long it still takes, as the command line says it; nothing while nobody knows. */
function left(time) {
  if (time === null || time === undefined) return "";
  return time >= 90 ? many("about {n} min left", "about {n} min left", Math.round(time / 60)) : _("about {s} s left", { s: Math.max(Math.round(time), 1) });
}

const controls = jobControls({ start: byId("start"), stop: byId("stop"), said: byId("said"), bar: byId("progress") }, box.fit, {
  progress: (report) => {
    byId("first").textContent = report.first?.[language] ?? "";
    if (report.answers) replace(byId("answers"), Object.entries(report.answers).map(([question, answer]) => h("div", {}, h("dt", {}, question), h("dd", {}, answer))));
    replace(byId("ended"), (report.lines ?? []).map((one) => h("li", {}, h("strong", {}, _(one.what)), ` ${_(one.outcome)} `, h("span", { class: "muted small" }, seconds(one.seconds)))));
    return report.total ? [`${_(report.what)}: ${_("{done} of {total} steps are done", report)}`, left(report.left_s)].filter(Boolean).join("; ") : progressText(report, "");
  },
  ended: (now) => {
    if (now.state === "done") location.href = `/sessions/${now.result}`;
    const words = { cancelled: _("Stopped."), interrupted: _("The server was stopped meanwhile.") };
    return [words[now.state] ?? "", now.result && h("a", { href: `/sessions/${now.result}` }, ` ${_("What was complete is kept.")}`)];
  },
  done: () => sort(),
});

/** What can be asked beforehand, where an earlier visit of this leg was analysed. */
const QUESTIONS = [
  ["", _("nothing in particular: everything is explored")], ["curve_size", _("Is it stiffer or softer, over its whole curve?")], ["end_stiffness", _("Is it stiffer or softer, at the end of the range?")], ["slow_stiffness", _("Is it stiffer or softer, slowly stretched?")],
  ["end_torque", _("Does it resist more or less, at the end of the range?")], ["range_at_torque", _("Does it go further at the same torque?")],
  ["maximal_torque_tri", _("Is the calf stronger or weaker?")], ["maximal_torque_tib", _("Is the tibialis stronger or weaker?")],
];
replace(byId("question"), QUESTIONS.map(([value, text]) => h("option", { value }, text)));
function offerQuestion() {
  const first = recordings.find((one) => chosen.has(one.id));
  byId("question-field").hidden = !first?.subject || !legs.some((one) => one.subject === first.subject && one.side === first.side && one.visit !== (first.visit ?? ""));
}
byId("start").addEventListener("click", () => attempt(box.fit, async () => {
  const question = byId("question-field").hidden ? null : byId("question").value || null;
  controls.watch(await post("/api/sessions", { ...request(), question }));
}));

const refresh = latest(() => attempt(box.page, async () => {
  [{ recordings }, { subjects: people }, { sessions: legs }] = await Promise.all([get("/api/recordings"), get("/api/subjects"), get("/api/sessions")]);
  const none = !recordings.length;
  byId("new").hidden = none;
  byId("empty").hidden = !none;
  if (none) return replace(byId("empty"), empty(_("No trials yet."), _("Add those of a leg."), h("a", { class: "button primary", href: "/import" }, _("Add trials")), demoButton(box.page)));
  const known = new Set(recordings.map((one) => one.id));
  chosen = new Set(chosen ? [...chosen].filter((id) => known.has(id)) : leg());
  showRecordings();
  return sort();
}));

onChanged(["recordings", "subjects"], () => refresh());
attempt(box.page, async () => {
  const [models, { draft }] = await Promise.all([get("/api/models"), get("/api/draft")]);
  const title = Object.fromEntries(models.settings.find((one) => one.path[0] === "model").choices)[draft.model] ?? draft.model;
  replace(byId("asked"), _("Model: {title}, {starts} starts, as chosen on this page:", { title: _(title), starts: draft.starts }), " ", h("a", { href: "/fit" }, _("Fit")));
  await refresh();
  const mine = (await active("session")).find((one) => one.mine);
  if (mine) controls.watch(mine);
});
