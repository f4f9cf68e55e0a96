// The project: what there is, what runs, and who.

import { get, patch, post } from "../core/api.js";
import { button, byId, empty, h, replace, select } from "../core/dom.js";
import { change } from "../core/draft.js";
import { onChanged } from "../core/events.js";
import { quantity, seconds, r2, when } from "../core/format.js";
import { attempt, complain } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { demoButton } from "../ui/demo.js";
import { active, cancel } from "../ui/jobs.js";
import { mark, older, status } from "../ui/marks.js";
import { editSubject } from "../ui/dialog.js";
import { deleteButton, sortable } from "../ui/table.js";
import { _, many } from "../core/words.js";

const boxes = Object.fromEntries(["sessions", "recordings", "fits", "subjects", "running"].map((k) => [k, byId(`${k}-error`)]));
let people = [];
const code = (id) => people.find((one) => one.id === id)?.code ?? null;

function subjectOf(recording) {
  const options = [["", _("none")], ...people.map((one) => [one.id, one.code])];
  const knob = select({ "aria-label": _("Subject of {name}", recording), "data-focus": `subject-${recording.id}` }, options, recording.subject ?? "");
  knob.addEventListener("change", () =>
    attempt(boxes.recordings, () => patch(`/api/recordings/${recording.id}`, { subject: knob.value || null })),
  );
  return knob;
}

async function useForFit(recording) {
  await attempt(boxes.recordings, async () => {
    await change({ recordings: [recording.id] }, _("fit {name}", recording));
    location.href = "/fit";
  });
}

const drop = (kind, entry, label) => deleteButton(`/api/${kind}/${entry.id}`, label, boxes[kind], () => refresh());

const recordingsTable = sortable(_("Trials of the project"), [
  { title: _("Trial"), value: (r) => r.name, show: (r) => h("a", { href: `/recordings/${r.id}` }, r.name) },
  { title: _("Subject"), value: (r) => code(r.subject), show: subjectOf },
  { look: "minor", title: _("Side"), value: (r) => r.side, show: (r) => r.side ? _(r.side) : "—" },
  { look: "minor", title: _("Number, condition"), value: (r) => r.trial, show: (r) => [r.trial, r.condition].filter(Boolean).join(", ") || "—" },
  { title: _("Length"), numeric: true, value: (r) => r.duration_s, show: (r) => seconds(r.duration_s) },
  { look: "research", title: _("Fits"), numeric: true, value: (r) => r.fits, show: (r) => String(r.fits) },
  { look: "minor", title: _("Imported"), value: (r) => r.created, show: (r) => when(r.created) },
  {
    title: "",
    show: (r) =>
      h("div", { class: "button-row" }, button(_("Fit"), () => useForFit(r), { class: "small research", "aria-label": _("Fit {name}", r) }), drop("recordings", r, r.name)),
  },
]);

const legsTable = sortable(_("Legs of the project"), [
  { title: _("Leg and visit"), value: (s) => s.name, show: (s) => h("a", { href: `/sessions/${s.id}` }, s.name) },
  { title: _("Subject"), value: (s) => code(s.subject), show: (s) => code(s.subject) ?? "—" },
  { look: "minor", title: _("Side"), value: (s) => s.side, show: (s) => s.side ? _(s.side) : "—" },
  { title: _("Visit"), value: (s) => s.visit, show: (s) => s.visit || _("not known") },
  { look: "minor", title: _("Trials"), numeric: true, value: (s) => s.trials, show: (s) => String(s.trials) },
  { title: _("Fit"), value: (s) => s.grade, show: (s) => (s.grade ? mark(s.grade) : _("none")) },
  { title: "", show: (s) => drop("sessions", s, s.name) },
]);

const fitsTable = sortable(_("Fits of the project"), [
  { title: _("Fit"), value: (f) => f.name, show: (f) => h("a", { href: `/fits/${f.id}` }, f.name) },
  { title: _("Model"), value: (f) => f.title, show: (f) => _(f.title) },
  { title: _("Subject"), value: (f) => code(f.subject), show: (f) => code(f.subject) ?? "—" },
  { title: _("Status"), value: (f) => f.status, show: (f) => [status(f.status), older(f)] },
  { title: "R²", numeric: true, value: (f) => f.r2, show: (f) => r2(f.r2) },
  { title: _("Made"), value: (f) => f.created, show: (f) => when(f.created) },
  { title: "", show: (f) => drop("fits", f, f.name) },
]);

const subjectsTable = sortable(_("All subjects of the project"), [
  { title: _("Code"), value: (p) => p.code, show: (p) => p.code },
  { title: _("Group"), value: (p) => p.group, show: (p) => _(p.group) || "—" },
  { title: _("Body mass"), numeric: true, value: (p) => p.body_mass, show: (p) => quantity(p.body_mass, "kg", 3) },
  { title: _("Recordings"), numeric: true, value: (p) => p.recordings, show: (p) => String(p.recordings) },
  { look: "research", title: _("Fits"), numeric: true, value: (p) => p.fits, show: (p) => String(p.fits) },
  { title: _("Notes"), value: (p) => p.notes, show: (p) => p.notes || "—" },
  {
    title: "",
    show: (p) =>
      h(
        "div",
        { class: "button-row" },
        button(_("Edit"), () => edit(p), { class: "small", "aria-label": _("Edit {code}", p) }),
        drop("subjects", p, p.code),
      ),
  },
]);

async function edit(person) {
  const entered = await editSubject(person);
  if (!entered) return;
  await attempt(boxes.subjects, async () => {
    if (person) await patch(`/api/subjects/${person.id}`, entered);
    else await post("/api/subjects", entered);
    await refresh();
  });
}

const nothing = {
  sessions: () => empty(_("No legs yet."), _("Add the trials of a leg, and analyse them.")),
  recordings: () => empty(_("No trials yet."), _("Drop the folder of a leg, or look around with a made-up one."), h("a", { class: "button primary", href: "/import" }, _("Add trials")), demoButton(boxes.recordings)),
  fits: () => empty(_("No fits yet."), _("Open a recording, check it, and choose “Fit this recording”.")),
  subjects: () => empty(_("No subjects yet."), _("Add one under a code, for example S01; names of people do not belong here.")),
};

const shown = {};
function show(kind, table, rows) {
  const now = JSON.stringify([rows, people]);
  if (shown[kind] === now) return; // what has not changed is not drawn anew under somebody's hand
  shown[kind] = now;
  if (!rows.length) replace(byId(kind), nothing[kind]());
  else {
    table.update(rows);
    if (byId(kind).lastElementChild !== table.element) replace(byId(kind), table.element);
  }
}

// One at a time: an answer that is late never takes the place of a later one.
const refresh = latest(() =>
  attempt(boxes.recordings, async () => {
    const kinds = ["subjects", "sessions", "recordings", "fits"];
    const [{ subjects }, { sessions }, { recordings }, { fits }] = await Promise.all(kinds.map((kind) => get(`/api/${kind}`)));
    people = subjects;
    show("sessions", legsTable, sessions);
    show("subjects", subjectsTable, people);
    show("recordings", recordingsTable, recordings);
    show("fits", fitsTable, fits);
  }),
);

const showJobs = latest(async () => {
  const jobs = await active();
  byId("running").hidden = jobs.length === 0;
  replace(
    byId("running-list"),
    jobs.map((one) =>
      h(
        "li",
        {},
        mark(one.state),
        h("span", {}, one.label),
        one.kind === "fit" && one.mine && h("a", { href: "/fit" }, _("Watch")),
        button(_("Stop"), () => attempt(boxes.running, () => cancel(one.id)), { class: "small", "aria-label": _("Stop {label}", one) }),
      ),
    ),
  );
});

byId("add-subject").addEventListener("click", () => edit(null));
onChanged(["sessions", "recordings", "fits", "subjects"], () => refresh());
onChanged(["jobs"], () => showJobs().catch(() => null));
attempt(boxes.recordings, async () => {
  await refresh();
  const { damaged } = await get("/api/damaged");
  if (damaged.length) {
    const kinds = [...new Set(damaged.map((one) => one.kind))].join(", ");
    complain(byId("damaged"), many("{n} entry is damaged and left out ({kinds}): surae project check tells more. All else is whole.", "{n} entries are damaged and left out ({kinds}): surae project check tells more. All else is whole.", damaged.length, { kinds }));
  }
  await showJobs();
});
