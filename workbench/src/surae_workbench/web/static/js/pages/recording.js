// One recording: its signals, what the check found, what is left out.

import { get, patch, query } from "../core/api.js";
import { button, byId, field, h, replace, select, table } from "../core/dom.js";
import { change, draft, onDraft } from "../core/draft.js";
import { onChanged } from "../core/events.js";
import { number, rate, roleText, seconds, span, unitText, r2 } from "../core/format.js";
import { attempt, calm, complain, headline, onClick } from "../core/notice.js";
import { signalPlots } from "../plot/signals.js";
import { describe, mend } from "../ui/describe.js";
import { ask } from "../ui/dialog.js";
import { findingsTable, part } from "../ui/findings.js";
import { older, status } from "../ui/marks.js";
import { _, language } from "../core/words.js";

const id = byId("recording").dataset.id;
let recording = null;
let findings = [];
let plots = null;

const excluded = () => draft()?.exclusions[id] ?? [];

function spans() {
  return [
    ...findings.filter((one) => part(one, recording.duration_s)).map((one) => ({ start: one.start_s, end: one.end_s, kind: one.severity, role: one.channel })),
    ...excluded().map(([start, end]) => ({ start, end, kind: "excluded" })),
  ];
}

/** Leave a window out; windows that touch become one. */
async function exclude(start, end) {
  const box = byId("exclude-error");
  const [from, to] = [Math.max(0, Math.min(start, end)), Math.min(recording.duration_s, Math.max(start, end))].map((x) => Number(x.toFixed(4)));
  if (!(to > from)) {
    complain(box, _("“From” must be before “To”, both between 0 and {s} s", { s: number(recording.duration_s) }));
    return;
  }
  const merged = [];
  for (const [a, b] of [...excluded(), [from, to]].sort((x, y) => x[0] - y[0])) {
    const last = merged[merged.length - 1];
    if (last && a <= last[1]) last[1] = Math.max(last[1], b);
    else merged.push([a, b]);
  }
  await attempt(box, () => change({ exclusions: { [id]: merged } }, _("exclude {span}", { span: span(from, to) })));
}

async function include(index) {
  const left = excluded().filter((_, i) => i !== index);
  const [start, end] = excluded()[index];
  await attempt(byId("exclude-error"), () => change({ exclusions: { [id]: left.length ? left : null } }, _("include {span} again", { span: span(start, end) })));
}

function showExclusions() {
  replace(
    byId("exclusions"),
    excluded().length
      ? excluded().map(([start, end], index) =>
          h("li", {}, span(start, end), button(_("Include again"), () => include(index), { class: "small", "aria-label": _("Include {span} again", { span: span(start, end) }) })),
        )
      : h("li", { class: "muted" }, _("Nothing. Choose “Drag to exclude” above the plots and drag, or type the times.")),
  );
  plots?.redraw();
}

function showFindings() {
  replace(
    byId("findings"),
    findingsTable(findings, {
      show: (one) => {
        const margin = Math.max(0.5 * (one.end_s - one.start_s), 0.25);
        plots.go([one.start_s - margin, one.end_s + margin]);
        byId("plots").scrollIntoView({ block: "start" });
      },
      exclude: (one) => exclude(one.start_s, one.end_s),
      mend: (one) => attempt(byId("quality-error"), () => mend(id, one)),
      duration: () => recording.duration_s,
    }),
  );
  plots?.redraw();
}

function showAbout() {
  headline(recording.name, [
    seconds(recording.duration_s),
    recording.side && (recording.side === "left" ? _("left leg") : _("right leg")),
    recording.trial,
    recording.condition,
    recording.emg && `EMG: ${_(recording.emg)}`,
  ]);
  replace(
    byId("files"),
    table(
      _("Channels"),
      [_("Signal"), _("Unit"), _("Samples"), _("Rate"), _("Column")],
      recording.channels.map((c) => [roleText(c.role), unitText(c.unit) || "—", c.n.toLocaleString(language), rate(c.rate_hz), c.source ?? "—"]),
      { caption: _("Channels as they were imported") },
    ),
    h("ul", { class: "list small muted" }, recording.files.map((file) => h("li", {}, file.name, h("code", { title: `sha256 ${file.sha256}` }, `sha256 ${file.sha256.slice(0, 12)}…`)))),
  );
}

function makePlots() {
  plots = signalPlots({
    duration: () => recording.duration_s,
    spans,
    onExclude: exclude,
    label: _("Signals of {name}", recording),
    roles: recording.channels.map((c) => c.role),
    fetch: (range, signal) =>
      get(
        `/api/recordings/${id}/window${query({ start: range?.[0], end: range?.[1], points: Math.min(2000, Math.max(400, byId("plots").clientWidth * 2)), view: byId("view").value })}`,
        signal,
      ),
    failed: (error) => complain(byId("plots-error"), error),
    done: () => calm(byId("plots-error")),
  });
  replace(byId("plots"), plots.element);
  plots.reload();
}

async function showFits() {
  const { fits } = await get(`/api/fits?recording=${id}`);
  replace(
    byId("fits"),
    fits.length
      ? h("ul", { class: "list" }, fits.map((fit) => h("li", {}, h("a", { href: `/fits/${fit.id}` }, fit.name), status(fit.status), older(fit), h("span", { class: "muted" }, `R² ${r2(fit.r2)}`))))
      : h("p", { class: "muted" }, _("None yet: choose “Fit this recording”.")),
  );
}

async function edit() {
  const { subjects } = await get("/api/subjects");
  const name = h("input", { type: "text", required: true, maxlength: 120, value: recording.name });
  const person = select({}, [["", _("none")], ...subjects.map((one) => [one.id, one.code])], recording.subject ?? "");
  const side = select({}, [["", _("unknown")], ["left", _("left")], ["right", _("right")]], recording.side ?? "");
  const trial = h("input", { type: "text", maxlength: 60, value: recording.trial ?? "" });
  const condition = h("input", { type: "text", maxlength: 60, value: recording.condition ?? "" });
  const content = h("div", { class: "fields" }, field(_("Name"), name), field(_("Subject"), person), field(_("Side"), side), field(_("Trial"), trial), field(_("Condition"), condition));
  if (!(await ask(_("Edit the recording"), content, { confirm: _("Save") }))) return;
  await attempt(byId("error"), async () => {
    recording = await patch(`/api/recordings/${id}`, {
      name: name.value.trim(),
      subject: person.value || null,
      side: side.value || null,
      trial: trial.value,
      condition: condition.value,
    });
    showAbout();
  });
}

byId("edit").addEventListener("click", edit);
byId("view").addEventListener("change", makePlots);
byId("exclude").addEventListener("submit", (event) => {
  event.preventDefault();
  exclude(Number(byId("from").value), Number(byId("to").value));
});
onClick("use", byId("error"), async () => {
  await change({ recordings: [id] }, _("fit {name}", recording));
  location.href = "/fit";
});
byId("describe").addEventListener("click", () => {
  byId("describe").hidden = true;
  attempt(byId("description-error"), () => describe(id, byId("description"), byId("description-error"), () => (byId("describe").hidden = false)), byId("describe"));
});
onChanged(["fits"], () => showFits().catch(() => null));
onChanged(["recordings"], () => attempt(byId("error"), async () => {
  const { version } = recording;
  recording = await get(`/api/recordings/${id}`);
  showAbout();
  if (recording.version === version) return;
  makePlots();
  await Promise.all([check(), showFits()]);
}));

const check = () => attempt(byId("quality-error"), async () => {
  try {
    findings = (await get(`/api/recordings/${id}/quality`)).findings;
  } catch (error) {
    replace(byId("findings"));
    throw error;
  }
  showFindings();
});

attempt(byId("error"), async () => {
  recording = await get(`/api/recordings/${id}`);
  showAbout();
  makePlots();
  onDraft(showExclusions);
  await Promise.all([check(), showFits()]);
});
