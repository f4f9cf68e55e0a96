// The protocol designer: every change is previewed at once.

import { download, get, post } from "../core/api.js";
import { button, byId, field, figures, h, num, replace, table } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { EMG_SHORT, number, percent, quantity, seconds, when } from "../core/format.js";
import { attempt, calm, complain } from "../core/notice.js";
import { latest, settled } from "../core/pace.js";
import { onTheme } from "../core/theme.js";
import { lines } from "../plot/lines.js";
import { ask } from "../ui/dialog.js";
import { active, jobControls, progressText } from "../ui/jobs.js";
import { verdict } from "../ui/marks.js";
import { deleteButton, sortable } from "../ui/table.js";
import { _, said } from "../core/words.js";

const KEPT = "surae.protocol.4";
const box = byId("error");
let choices = null;
const numbers = () => choices.settings.filter((one) => one.kind === "number");
const DEGREES = 180 / Math.PI;
/** Angles are entered in degrees; what is asked for, and kept, is in radians. */
const factor = (label) => (label.includes("[rad]") ? DEGREES : 1);
const entry = (value, by = DEGREES) => (value === null || value === undefined ? "" : by === 1 ? value : Number((value * by).toFixed(1)));

/** Put a value into a field, as it is shown; `read` gives it back to the last digit unless it was typed over. */
function put(id, value, by = DEGREES) {
  const field = byId(id);
  field.value = entry(value, by);
  [field.dataset.shown, field.dataset.own] = [field.value, value ?? ""];
}

function read(id, by = DEGREES) {
  const { value, dataset } = byId(id);
  if (value === "") return null;
  return value === dataset.shown && dataset.own !== "" ? Number(dataset.own) : Number(value) / by;
}
/** A kept design that is shown: its plan and limits go with the settings. */
let kept = null;

const plots = [
  lines({ title: _("Angle, dorsiflexion positive"), unit: "°", height: 170, series: [{ label: _("angle"), colour: "series-1" }] }, { sync: "protocol", bottom: false }),
  lines({ title: _("Angular velocity"), unit: "°/s", height: 120, series: [{ label: _("velocity"), colour: "series-1" }] }, { sync: "protocol", bottom: false }),
  lines({ title: _("Requested effort"), unit: "%", height: 130, series: EMG_SHORT.map((label, i) => ({ label, colour: ["series-2", "series-1", "series-5", "series-4"][i], dash: [null, null, "dash", "dot"][i] })) }, { sync: "protocol" }),
];
replace(byId("plots"), plots.map((plot) => plot.element));
onTheme(() => plots.forEach((plot) => plot.redraw()));

function entered() {
  const settings = {
    profile: kept ? "designed" : byId("profile").value,
    ...(kept ?? {}),
    task: byId("task").value,
    device: byId("device").value || null,
    angle_range: [read("low"), read("high")],
    adapt: byId("adapt").checked,
  };
  for (const { path: [key], label } of numbers()) settings[key] = read(key, factor(label));
  return { settings, model: byId("model").value, population: byId("population").value, noise: Number(byId("noise").value), film: byId("film").value };
}

function fill({ settings, model, population, noise, film }) {
  kept = settings.plan ? { plan: settings.plan, limits: settings.limits } : null;
  showKept();
  for (const key of ["profile", "task"]) byId(key).value = settings[key] ?? "";
  for (const { path: [key], label } of numbers()) put(key, settings[key], factor(label));
  byId("device").value = settings.device ?? "";
  put("low", settings.angle_range[0]);
  put("high", settings.angle_range[1]);
  byId("adapt").checked = settings.adapt;
  if (model) byId("model").value = model;
  if (population) byId("population").value = population;
  if (noise) byId("noise").value = noise;
  byId("film").value = film ?? "";
}

/** A designed protocol is an option of its own while it is shown. */
function showKept() {
  byId("profile").querySelector("[value=designed]")?.remove();
  if (kept) byId("profile").append(option("designed", kept.plan.name));
}

const preview = latest(async () => {
  const request = entered();
  localStorage.setItem(KEPT, JSON.stringify(request));
  for (const [id, list] of [["profile", choices.profiles], ["task", choices.tasks]]) byId(`${id}-said`).textContent = _(list.find((one) => one.name === byId(id).value)?.description);
  byId("adapt").disabled = request.settings.device === null;
  const whole = kept !== null || choices.profiles.find((one) => one.name === byId("profile").value)?.designed;
  byId("chirp_amplitude").disabled = byId("chirp_rate").disabled = whole; // a designed movement has none
  byId("said").textContent = _("Working it out …");
  try {
    draw(await post("/api/protocols/preview", { ...request, predict: false })); // seen at once, before what it tells
    show(await post("/api/protocols/preview", request));
    calm(box);
  } catch (error) {
    complain(box, error);
    byId("said").textContent = "";
  }
});

/** The movement, and what it asks of the device. */
function draw(seen) {
  const scaled = (values, factor) => values.map((x) => x * factor);
  plots[0].show([seen.t, scaled(seen.angle, DEGREES)], null);
  plots[1].show([seen.t, scaled(seen.velocity, DEGREES)], null);
  plots[2].show([seen.t, ...seen.effort.map((one) => scaled(one, 100))], null);
  replace(
    byId("adaptation"),
    h("ul", {}, seen.adaptation.map((one) => h("li", {}, said(one))), seen.limits.filter((one) => !one.exceeded).map((one) => h("li", {}, said(one)))),
  );
  const exceeded = seen.limits.filter((one) => one.exceeded);
  byId("limits").hidden = byId("reason-field").hidden = exceeded.length === 0;
  replace(byId("limits"), exceeded.map((one) => h("li", {}, said(one))));
}

/** The movement, and what it would tell. */
function show(seen) {
  draw(seen);
  const { prediction, caution } = seen;
  const entries = [
    [_("Length"), seconds(seen.seconds)],
    [_("Identified"), _("{n} of {whole}", { n: prediction.identified, whole: Object.keys(prediction.parameters).length })],
    [_("Largest error"), `${part(prediction.worst)} (${prediction.weakest})`],
    [_("Geometric mean"), part(prediction.geometric_mean)],
    ...atRest(prediction),
    ...(prediction.load ? [[_("Torque on the device, all virtual legs"), `${number(prediction.load.torque[0], 2)} … ${number(prediction.load.torque[1], 2)} Nm`]] : []),
  ];
  replace(byId("figures"), figures(entries));
  replace(byId("prediction"), predicted(Object.entries(prediction.parameters), seen.notes));
  byId("said").textContent = [_("Worked out in {s} s, over {legs}", { s: number(seen.milliseconds / 1000, 2), legs: said(seen.legs) }), caution && said(caution)].filter(Boolean).join("; ") + ".";
}

/** What it would tell of the relaxed leg's stiffness, and which change of it two such visits would show. */
function atRest({ at_rest: rest, measures }) {
  const told = rest.end_stiffness;
  const change = measures.end_stiffness?.would_show;
  return [
    [_("Stiffness of the relaxed leg, end of the range"), told ? `±${part(told.half_width)}` : _("not known")],
    ...(change ? [[_("Change of it that two visits would show"), part(change)]] : []),
  ];
}

const part = (x) => (x === null ? "—" : percent(100 * x, 2));

const predicted = (parameters, notes) =>
  table(
    _("Predicted uncertainty"),
    [_("Parameter"), _("Typical value"), _("Standard error"), _("95 % within"), _("Identified in"), _("Verdict"), _("Why")],
    parameters.map(([name, p]) => [
      name,
      num(quantity(p.value, p.unit, 3)),
      num(p.relative_sem === null ? "—" : [part(p.relative_sem), " ", h("meter", { min: 0, max: 0.2, high: 0.1, low: 0.05, optimum: 0, value: Math.min(p.relative_sem, 0.2), "aria-label": _("Relative standard error of {name}", { name }) })]),
      num(p.relative_half_width === null ? "—" : `±${part(p.relative_half_width)}`),
      num(percent(100 * p.identified_share, 2)),
      verdict(p.verdict),
      h("td", { class: "why" }, said(notes[name])),
    ]),
    { caption: _("Predicted standard errors; the bar ends at 20 %"), numbers: [1, 4] },
  );

const savedTable = sortable(_("Protocols of this project"), [
  { title: _("Name"), value: (p) => p.name, show: (p) => p.name },
  { title: _("Profile"), value: (p) => p.settings.profile, show: (p) => p.settings.profile },
  { title: _("Chirp"), value: (p) => p.settings.chirp_amplitude, show: (p) => p.settings.plan ? "—" : `${number(p.settings.chirp_amplitude * DEGREES, 3)}°, ${number(p.settings.chirp_rate, 3)} Hz/s` },
  { title: _("Device"), value: (p) => p.settings.device, show: (p) => p.settings.device ?? _("none") },
  { title: _("Saved"), value: (p) => p.created, show: (p) => when(p.created) },
  {
    title: "",
    show: (p) =>
      h(
        "div",
        { class: "button-row" },
        button(_("Open"), () => { fill({ settings: p.settings }); preview(); }, { class: "small", "aria-label": _("Open {name}", p) }),
        button("CSV", () => attempt(box, () => exportCsv(p.settings, p.name)), { class: "small", "aria-label": _("CSV of {name}", p) }),
        deleteButton(`/api/protocols/${p.id}`, p.name, box, () => showSaved()),
      ),
  },
]);

const exportCsv = (settings, name = "") => download("/api/protocols/csv", "protocol.csv", { settings, name, reason: byId("reason").value });

async function showSaved() {
  const { protocols } = await get("/api/protocols");
  savedTable.update(protocols);
  replace(byId("saved"), protocols.length ? savedTable.element : h("p", { class: "muted" }, _("None yet. Save keeps a design under a name.")));
}

const soon = settled(() => byId("settings").checkValidity() && preview(), 250);
byId("settings").addEventListener("input", soon);
byId("settings").addEventListener("submit", (event) => {
  event.preventDefault();
  preview();
});
byId("export").addEventListener("click", () => byId("settings").reportValidity() && attempt(box, () => exportCsv(entered().settings), byId("export")));
byId("save").addEventListener("click", async () => {
  if (!byId("settings").reportValidity()) return;
  const name = h("input", { type: "text", required: true, maxlength: 120, value: byId("profile").value });
  if (!(await ask(_("Save the protocol"), field(_("Name"), name), { confirm: _("Save") }))) return;
  await attempt(box, async () => {
    await post("/api/protocols", { name: name.value.trim(), settings: entered().settings });
    await showSaved();
  });
});
onChanged(["protocols"], () => attempt(box, showSaved));

byId("profile").addEventListener("input", () => {
  if (byId("profile").value !== "designed") kept = null;
  showKept();
});
byId("population").addEventListener("input", () => {
  if (byId("population").value !== "patient") return;
  byId("low").value = byId("high").value = "";
  byId("said").textContent = _("A patient's range is not that of a healthy leg: measure it, and give it.");
  byId("low").focus();
});

const { watch } = jobControls({ start: byId("search"), stop: byId("stop"), said: byId("search-said") }, box, {
  progress: (now) => progressText(now, _("Plans judged")),
  ended: (now) => {
    const how = { cancelled: _("Stopped"), done: _("Done"), failed: _("Failed") }[now.state] ?? now.state;
    const where = now.result ? _("Kept below under Saved protocols.") : _("Nothing is kept.");
    return `${how}: ${now.message}. ${where}`;
  },
});
byId("search").addEventListener("click", () => {
  if (!byId("settings").reportValidity()) return;
  attempt(box, async () => {
    const { settings, model, population, noise, film } = entered();
    const durations = byId("durations").value.split(",").map(Number).filter((value) => value > 0);
    watch(await post("/api/protocols/design", { device: settings.device, angle_range: settings.angle_range, rate_hz: settings.rate_hz, model, population, noise, film, durations, aim: byId("aim").value.trim(), effort: byId("effort").value, evaluations: Number(byId("evaluations").value) }));
  });
});

const option = (value, text = value) => h("option", { value }, text);
attempt(box, async () => {
  const known = (choices = await get("/api/protocols/choices"));
  replace(byId("profile"), known.profiles.map((one) => option(one.name)));
  replace(byId("task"), known.tasks.map((one) => option(one.name)));
  replace(byId("device"), option("", _("none")), known.devices.map((one) => option(one.name)));
  replace(byId("population"), known.populations.map((one) => option(one.name ?? one, _(one.name ?? one))));
  replace(byId("model"), known.models.map((one) => option(one.name, _(one.title))));
  replace(byId("numbers"), numbers().map((one) => field(_(one.label).replace("[rad]", "[°]"), h("input", { id: one.path[0], type: "number", min: one.least === null ? null : entry(one.least, factor(one.label)), max: one.most === null ? null : entry(one.most, factor(one.label)), step: "any", required: !one.optional, placeholder: one.optional && _("usual") }))));
  fill(JSON.parse(localStorage.getItem(KEPT) ?? "null") ?? known.start);
  const [job] = await active("design");
  if (job) watch(job);
  await Promise.all([preview(), showSaved()]);
});
