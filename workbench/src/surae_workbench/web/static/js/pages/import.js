// From files to a recording: drop, confirm, import.

import { get, post, query, remove, upload } from "../core/api.js";
import { button, byId, h, replace, select, tick } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { EMG, bytes, roleText, seconds } from "../core/format.js";
import { attempt, calm, complain, tell } from "../core/notice.js";
import { latest, settled } from "../core/pace.js";
import { editSubject } from "../ui/dialog.js";
import { ranges } from "../ui/describe.js";
import { findingsTable } from "../ui/findings.js";
import { emptyMapping, mappingTable } from "../ui/mapping.js";
import { labelOf, mended, remediesOf, remedy, swapping } from "../ui/remedies.js";
import { forTrial, inOrder, legOf, trialsAmong, trialsWithin } from "../ui/trials.js";
import { _, many } from "../core/words.js";

const box = { upload: byId("upload-error"), inspect: byId("inspect-error"), mapping: byId("mapping-error") };
const KEPT = "surae.import";
/** Before the code of a subject that is made when its trials are imported. */
const NEW = "new:";

let uploads = [];
let included = new Set();
const inspected = new Map();
let mapping = emptyMapping();
let units = { roles: [], units: {} };
/** Side, day and code of the leg, as the names of files say. */
let guessed = {};
/** Trials, each a file or a part of one; empty where all are parts of one recording. */
let trials = [];
/** Whether it was said that nobody knows the day; whether the trials are on their way. */
let dayUnknown = false;
let leaving = false;

// What was chosen survives a reload, in this tab only.
const keep = () => {
  const entered = ["subject", "trial", "condition", "visit"].map((id) => [id, byId(id).value]);
  sessionStorage.setItem(KEPT, JSON.stringify({ included: [...included], mapping, entered }));
};
const kept = () => JSON.parse(sessionStorage.getItem(KEPT) ?? "null");

async function receive(files) {
  await ready; // else what was there before would come after these, and in their place
  if (!byId("earlier").hidden) await beginAnew(); // other files are another leg's
  calm(box.upload);
  if (files.some((file) => !/\.toml$/i.test(file.name))) forgetPerson();
  byId("upload-progress").textContent = _("Reading {files} …", { files: files.map((file) => `${file.name} (${bytes(file.size)})`).join(", ") });
  guessed = legOf(files.map((file) => file.webkitRelativePath || file.name));
  const sent = await Promise.all(files.map((file) => upload(`/api/uploads${query({ name: file.name })}`, file).catch((error) => complain(box.upload, error))));
  const arrived = sent.filter(Boolean);
  byId("upload-progress").textContent = arrived.length ? _("{files} received.", { files: arrived.map((one) => one.name).join(", ") }) : "";
  if (!arrived.length) return;
  await listUploads();
  included = new Set(inOrder(arrived).map((one) => one.id));
  await inspect();
}

/** What was said of the person and the day is of the files before, and of no others. */
function forgetPerson() {
  for (const one of [...byId("subject").options]) if (one.value.startsWith(NEW)) one.remove();
  for (const id of ["subject", "trial", "condition", "visit", "side"]) byId(id).value = "";
  dayUnknown = false;
}

async function listUploads() {
  uploads = (await get("/api/uploads")).uploads;
  included = new Set([...included].filter((id) => uploads.some((one) => one.id === id)));
  showUploads();
}

function showUploads() {
  byId("uploads-card").hidden = uploads.length === 0;
  replace(
    byId("uploads"),
    uploads.map((one) =>
      h(
        "li",
        {},
        tick(`${one.name} (${bytes(one.bytes)}${inspected.has(one.id) ? `, ${inspected.get(one.id).format}` : ""})`, included.has(one.id), (wanted) => include(one.id, wanted), { "data-focus": one.id }),
        button(_("Remove"), () => discard(one), { class: "small", "aria-label": _("Remove {name}", one) }),
      ),
    ),
  );
}

function include(id, wanted) {
  if (wanted) included.add(id);
  else included.delete(id);
  inspect();
}

async function discard(one) {
  await attempt(box.inspect, async () => {
    await remove(`/api/uploads/${one.id}`);
    await listUploads();
    await inspect();
  });
}

/** Look into the files that are chosen; several files make one mapping between them. */
async function inspect(given = null) {
  calm(box.inspect);
  byId("upload-progress").textContent = _("Looking into the files …");
  const seen = async (id) => {
    if (!inspected.has(id)) inspected.set(id, await get(`/api/uploads/${id}/inspect`));
    return inspected.get(id);
  };
  const read = (await Promise.all([...included].map((id) => seen(id).catch((error) => complain(box.inspect, error))))).filter(Boolean);
  showUploads();
  // A description beside several trials is of one of them, and serves all.
  const described = read.some((one) => isMapping(one.id));
  trials = inOrder(trialsAmong(read.filter((one) => !isMapping(one.id))));
  if (read.length === 1) trials = trialsWithin(read[0]);
  const together = trials.length && !described ? trials[0] : read.length > 1 ? await both() : read[0];
  const ofTrial = (one) => Object.values(together?.mapping.channels ?? {}).some((channel) => channel.upload === one.id);
  if (described) trials.sort((a, b) => ofTrial(b) - ofTrial(a));
  byId("upload-progress").textContent = "";
  const several = trials.length > 0 && _("The settings below apply to all: {names}.", { names: trials.map((one) => one.name).join(", ") });
  const notes = [several, ...(together?.notes ?? [])].filter(Boolean);
  byId("notes").hidden = notes.length === 0;
  replace(byId("notes"), notes.map((line) => h("li", {}, _(line))));
  byId("offer-card").hidden = true;
  byId("mapping-card").hidden = !together;
  if (!together) return keep();
  mapping = given ?? { ...emptyMapping(), ...together.mapping };
  if (!given) guess();
  await showMapping();
  check();
}

/** What the names say of the leg is filled in once, where nothing was chosen. */
function guess() {
  mapping.side ??= guessed.side ?? null;
  byId("visit").value ||= guessed.visit ?? "";
  if (!guessed.code || byId("subject").value) return;
  const known = [...byId("subject").options].find((one) => one.text === guessed.code);
  if (!known) byId("subject").append(h("option", { value: NEW + guessed.code }, _("{code} (new)", guessed)));
  byId("subject").value = known?.value ?? NEW + guessed.code;
}

const isMapping = (id) => inspected.get(id)?.format === "TOML mapping";

/** Several files as one recording; undefined where they are none. */
function both() {
  const [first, ...others] = [...included].sort((a, b) => isMapping(b) - isMapping(a)); // which says what the others hold
  return attempt(box.inspect, () => get(`/api/uploads/${first}/inspect?${others.map((id) => `also=${id}`).join("&")}`));
}

async function showMapping() {
  const files = trials.length ? [trials[0]] : [...inspected.values()].filter((one) => included.has(one.id) || uses(one.id));
  if (trials.length && trials.every((one) => one.ready)) byId("columns").open = false;
  byId("import").textContent = trials.length ? many("Import {n} recording", "Import {n} recordings", trials.length) : _("Import this recording");
  for (const own of ["name", "trial"]) byId(own).closest("label").hidden = trials.length > 0; // each has its own
  replace(byId("mapping"), mappingTable(mapping, files, units, changed));
  byId("name").value = mapping.name ?? "";
  byId("emg").value = mapping.emg ?? "";
  byId("side").value = mapping.side ?? "";
}

const uses = (id) => Object.values(mapping.channels).some((channel) => channel.upload === id);

const changed = (redraw = true) => {
  if (redraw) showMapping();
  check();
};

function body() {
  mapping.name = byId("name").value.trim();
  mapping.emg = byId("emg").value || null;
  mapping.side = byId("side").value || null;
  const person = byId("subject").value;
  return {
    mapping,
    subject: person && person !== "new" && !person.startsWith(NEW) ? person : null,
    trial: byId("trial").value.trim() || null,
    condition: byId("condition").value.trim() || null,
    visit: byId("visit").value || null,
  };
}

/** What was found, in a line, with the clicks that mend it. */
function offer(seen) {
  byId("offer-card").hidden = false;
  const offered = remediesOf(seen);
  const mend = offered.find((one) => /-sign$/.test(one.code))?.mend;
  const muscles = EMG.filter((role) => mapping.channels[role]);
  const turned = mend && Object.keys(mend.channels);
  const signs = turned && (turned.length > 1 ? _("both signs look turned") : turned[0] === "angle" ? _("the sign of the angle looks turned") : _("the sign of the torque looks turned"));
  const emg = muscles.length ? many("EMG of {n} muscle", "EMG of {n} muscles", muscles.length) : _("no EMG");
  byId("offer").textContent = `${[many("{n} trial found", "{n} trials found", trials.length || 1), emg, signs].filter(Boolean).join(", ")}.`;
  byId("analyse").className = offered.length ? "" : "primary";
  byId("analyse").textContent = offered.length ? _("Analyse as it is") : _("Analyse");
  const key = JSON.stringify([mapping.channels, offered.map((one) => [one.trial.name, labelOf(one.mend)])]);
  if (byId("remedies").dataset.key === key) return;
  byId("remedies").dataset.key = key;
  const look = (trial) => (change) => seenAs(trial.of, mended(body().mapping, change));
  const use = (change) => {
    mapping = { ...mapping, ...mended(mapping, change) };
    changed();
  };
  replace(byId("remedies"), offered.map((one) => remedy(one, look(one.trial), use)), swapping(mapping, seen[0], look(seen[0]), use));
}

/** What a trial, or the one recording, is with a mapping. */
async function seenAs(one, mapped) {
  const seen = await post("/api/imports/preview", { ...body(), mapping: one ? forTrial(one, mapped) : mapped });
  return { ...seen, name: one?.name, of: one };
}

let asked = 0;
/** Every trial is looked at, one after the other, and shown as it comes: what was found is of that file. */
const preview = latest(async () => {
  const request = body();
  const own = ++asked;
  keep();
  calm(box.mapping);
  const seen = [];
  const failed = [];
  const several = trials.length > 1;
  for (const one of trials.length ? trials : [null]) {
    try {
      seen.push(await seenAs(one, request.mapping));
    } catch (error) {
      if (!several) replace(byId("preview"));
      failed.push(several ? `${one.name}: ${error.message}` : error.message);
      complain(box.mapping, new Error(failed.join("; ")));
      continue;
    }
    if (own !== asked || leaving) return;
    replace(byId("preview"), seen.map((each) => shown(each, several)), several && seen.length + failed.length < trials.length ? h("p", { class: "muted" }, _("{done} of {total} looked at", { done: seen.length, total: trials.length })) : null);
    // A hold shows no sign: what is offered waits for a trial that moves.
    if (!several || seen.length + failed.length === trials.length || seen.some((each) => !each.findings.some((f) => f.code === "angle-still"))) offer(seen);
  }
});

/** One trial as it will be imported, with what was found in it. */
function shown(seen, several) {
  const wrong = seen.findings.filter((one) => one.severity !== "info").length;
  const content = [
    seen.twin && h("p", { class: "note" }, _("These files are in the project already. There, what they mean can be changed; to import them again makes a second recording:"), " ", h("a", { href: `/recordings/${seen.twin.id}` }, seen.twin.name)),
    ranges(seen.channels),
    findingsTable(seen.findings, null),
  ];
  const title = _("As it will be imported: {what}", { what: [seen.name, seconds(seen.duration_s)].filter(Boolean).join(", ") });
  if (!several) return [h("h3", {}, title), content];
  const count = wrong ? many("{n} finding", "{n} findings", wrong) : _("nothing to object to");
  return h("details", { class: "of-trial", open: seen.of === trials[0] }, h("summary", {}, h("strong", {}, seen.name), ` ${seconds(seen.duration_s)}, ${count}`), content);
}
const check = settled(() => byId("mapping-card").hidden || preview(), 350);

async function listSubjects(chosen = byId("subject").value) {
  const { subjects } = await get("/api/subjects");
  const made = select({}, [["", _("none")], ...subjects.map((one) => [one.id, one.code]), ["new", _("New subject …")]], chosen);
  byId("subject").replaceChildren(...made.children);
  byId("subject").value = subjects.some((one) => one.id === chosen) ? chosen : "";
}

byId("subject").addEventListener("change", async () => {
  if (byId("subject").value !== "new") return keep();
  byId("subject").value = "";
  const entered = await editSubject();
  if (entered) await attempt(box.mapping, async () => listSubjects((await post("/api/subjects", entered)).id));
  return keep();
});

/** Whoever the names speak of is made a subject now; false where that was refused. */
async function subjectMade() {
  const person = byId("subject").value;
  if (!person.startsWith(NEW)) return true;
  const made = await attempt(byId("offer-error"), () => post("/api/subjects", { code: person.slice(NEW.length) }));
  if (made) await listSubjects(made.id);
  return Boolean(made);
}

/** Whether the day of the visit is told, or said to be unknown; else it is asked for. */
function dayTold() {
  if (byId("visit").value || dayUnknown) return true;
  replace(byId("day-asked"), _("On which day was this measured? Visits are compared by their day."), " ", button(_("It is not known"), () => {
    dayUnknown = true;
    byId("day-asked").hidden = true;
  }, { class: "small" }));
  byId("day-asked").hidden = false;
  byId("visit").focus();
  return false;
}

/** Every trial by the one description; then they are analysed, or wait in the project. */
async function importTrials(analyse = false) {
  if (!dayTold() || !(await subjectMade())) return;
  leaving = true;
  const request = body();
  const failed = [];
  calm(box.mapping);
  byId("import").disabled = byId("analyse").disabled = true;
  byId("upload-progress").textContent = many("Importing {n} trial …", "Importing {n} trials …", trials.length);
  const made = await Promise.all(trials.map(async (one) => {
    const own = forTrial(one, request.mapping);
    try {
      const { id } = await post("/api/imports", { ...request, mapping: own, trial: own.name });
      included.delete(one.id);
      return id;
    } catch (error) {
      failed.push(`${one.name}: ${error.message}`);
      return null;
    }
  }));
  const recordings = made.filter(Boolean);
  byId("import").disabled = byId("analyse").disabled = leaving = false;
  byId("upload-progress").textContent = "";
  if (analyse && recordings.length && !(await attempt(byId("offer-error"), () => post("/api/sessions", { recordings })))) return;
  if (failed.length) {
    await inspect();
    return complain(box.mapping, new Error(failed.join("; ")));
  }
  sessionStorage.removeItem(KEPT);
  location.href = analyse ? "/analyse" : "/";
}

byId("mapping-card").addEventListener("submit", async (event) => {
  event.preventDefault();
  if (trials.length) return importTrials();
  if (!dayTold() || !(await subjectMade())) return;
  const made = await attempt(box.mapping, () => post("/api/imports", body()), byId("import"));
  if (!made) return;
  sessionStorage.removeItem(KEPT);
  tell(_("Imported {name}", made));
  location.href = `/recordings/${made.id}`;
});

/** One file has the same way to its answer as a folder. */
async function analyseOne() {
  if (!dayTold() || !(await subjectMade())) return;
  const made = await attempt(box.mapping, () => post("/api/imports", body()), byId("analyse"));
  if (!made || !(await attempt(byId("offer-error"), () => post("/api/sessions", { recordings: [made.id] })))) return;
  sessionStorage.removeItem(KEPT);
  location.href = "/analyse";
}
byId("analyse").addEventListener("click", () => (trials.length ? importTrials(true) : analyseOne()));
byId("check").addEventListener("click", () => preview());
for (const id of ["name", "emg", "side", "trial", "condition", "visit"]) byId(id).addEventListener("change", () => check());
for (const id of ["files", "folder"]) {
  byId(id).addEventListener("change", async (event) => {
    await receive([...event.target.files].filter((file) => !file.name.startsWith(".")));
    event.target.value = "";
  });
}

const drop = byId("drop");
for (const name of ["dragenter", "dragover"]) {
  addEventListener(name, (event) => {
    event.preventDefault();
    drop.classList.add("over");
  });
}
addEventListener("dragleave", (event) => event.relatedTarget || drop.classList.remove("over"));
addEventListener("drop", (event) => {
  event.preventDefault();
  drop.classList.remove("over");
  const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (entries.some((entry) => entry.isDirectory)) Promise.all(entries.map(filesOf)).then((found) => receive(found.flat()));
  else receive([...event.dataTransfer.files]);
});

/** The files of what was dropped, those of a folder too. */
async function filesOf(entry) {
  if (entry.isFile) return [await new Promise((resolve, fail) => entry.file(resolve, fail))];
  const reader = entry.createReader();
  const found = [];
  for (let some; (some = await new Promise((resolve, fail) => reader.readEntries(resolve, fail))).length; ) found.push(...some);
  return (await Promise.all(found.filter((one) => one.isFile && !one.name.startsWith(".")).map(filesOf))).flat();
}
onChanged(["subjects"], () => attempt(box.mapping, () => listSubjects()));

/** Files that were left here: they go on only if somebody says so, as they may be another leg's. */
function askOfEarlier() {
  byId("earlier").hidden = false;
  byId("uploads-card").hidden = true;
  const names = inOrder(uploads).map((one) => one.name);
  const shownNames = names.length > 4 ? [...names.slice(0, 3), "…", names.at(-1)] : names;
  replace(
    byId("earlier"),
    h("span", {}, many("{n} file is here from before: {names}.", "{n} files are here from before: {names}.", names.length, { names: shownNames.join(", ") })),
    button(_("Go on with them"), goOn, { class: "primary" }),
    button(_("Begin anew"), () => attempt(box.upload, beginAnew)),
  );
}

async function goOn() {
  const before = kept();
  byId("earlier").hidden = true;
  const known = (before?.included ?? []).filter((id) => uploads.some((one) => one.id === id));
  included = new Set(known.length ? known : inOrder(uploads).map((one) => one.id));
  for (const [id, value] of before?.entered ?? []) byId(id).value = value;
  showUploads();
  await inspect(known.length ? before.mapping : null);
}

/** Files from before go to the trash, and what was said of them with them. */
async function beginAnew() {
  byId("earlier").hidden = true;
  await Promise.all(uploads.map((one) => remove(`/api/uploads/${one.id}`)));
  sessionStorage.removeItem(KEPT);
  included = new Set();
  inspected.clear();
  forgetPerson();
  await listUploads();
}

const ready = attempt(box.upload, async () => {
  [units] = await Promise.all([get("/api/units"), listSubjects(), listUploads()]);
  if (uploads.length) askOfEarlier();
});
