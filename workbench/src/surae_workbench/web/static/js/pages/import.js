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
import { forTrial, legOf, trialsAmong, trialsWithin } from "../ui/trials.js";
import { _, many, said } from "../core/words.js";

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

// What was chosen survives a reload, in this tab only.
const keep = () => {
  const entered = ["subject", "trial", "condition", "visit"].map((id) => [id, byId(id).value]);
  sessionStorage.setItem(KEPT, JSON.stringify({ included: [...included], mapping, entered }));
};
const kept = () => JSON.parse(sessionStorage.getItem(KEPT) ?? "null");

async function receive(files) {
  await ready; // else what was there before would come after these, and in their place
  calm(box.upload);
  byId("upload-progress").textContent = _("Reading {files} …", { files: files.map((file) => `${file.name} (${bytes(file.size)})`).join(", ") });
  guessed = legOf(files.map((file) => file.webkitRelativePath || file.name));
  const sent = await Promise.all(files.map((file) => upload(`/api/uploads${query({ name: file.name })}`, file).catch((error) => complain(box.upload, error))));
  const arrived = sent.filter(Boolean);
  byId("upload-progress").textContent = arrived.length ? _("{files} received.", { files: arrived.map((one) => one.name).join(", ") }) : "";
  if (!arrived.length) return;
  await listUploads();
  included = new Set(arrived.map((one) => one.id));
  await inspect();
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
  trials = trialsAmong(read.filter((one) => !isMapping(one.id)));
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

/** What was found, in a line, with the one click that mends it. */
function offer(findings) {
  byId("offer-card").hidden = false;
  const mend = findings.find((one) => /-sign$/.test(one.code) && one.mend)?.mend;
  const muscles = EMG.filter((role) => mapping.channels[role]);
  const turned = mend && Object.keys(mend.channels);
  const signs = turned && (turned.length > 1 ? _("both signs look turned") : turned[0] === "angle" ? _("the sign of the angle looks turned") : _("the sign of the torque looks turned"));
  const emg = muscles.length ? many("EMG of {n} muscle", "EMG of {n} muscles", muscles.length) : _("no EMG");
  byId("offer").textContent = `${[many("{n} trial found", "{n} trials found", trials.length || 1), emg, signs].filter(Boolean).join(", ")}.`;
  byId("turn").hidden = !mend;
  byId("turn").textContent = mend ? said({ text: mend.label, given: mend.given }) : "";
  byId("turn").className = mend ? "primary" : "";
  byId("analyse").className = mend ? "" : "primary";
  byId("analyse").textContent = mend ? _("Analyse as it is") : _("Analyse");
  byId("turn").onclick = () => {
    for (const [role, change] of Object.entries(mend.channels)) Object.assign(mapping.channels[role], change);
    byId("turn").hidden = true;
    changed();
  };
}

/** Of several trials the first that moves: a hold shows no sign. */
async function seenAs(request) {
  let seen = null;
  for (const one of trials.length ? trials : [null]) {
    const mapped = one ? forTrial(one, request.mapping) : request.mapping;
    const here = await post("/api/imports/preview", { ...request, mapping: mapped });
    seen ??= { ...here, name: one?.name };
    if (!one || !here.findings.some((f) => f.code === "angle-still")) return { ...here, name: one?.name };
  }
  return seen;
}

const preview = latest(async () => {
  const request = body();
  keep();
  calm(box.mapping);
  try {
    const seen = await seenAs(request);
    offer(seen.findings);
    replace(
      byId("preview"),
      h("h3", {}, _("As it will be imported: {what}", { what: [seen.name, seconds(seen.duration_s)].filter(Boolean).join(", ") })),
      seen.twin && h("p", { class: "note" }, _("These files are in the project already. There, what they mean can be changed; to import them again makes a second recording:"), " ", h("a", { href: `/recordings/${seen.twin.id}` }, seen.twin.name)),
      ranges(seen.channels),
      findingsTable(seen.findings, null),
    );
  } catch (error) {
    replace(byId("preview"));
    complain(box.mapping, error);
  }
});
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

/** Every trial by the one description; then they are analysed, or wait in the project. */
async function importTrials(analyse = false) {
  if (!(await subjectMade())) return;
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
  byId("import").disabled = byId("analyse").disabled = false;
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
  if (!(await subjectMade())) return;
  const made = await attempt(box.mapping, () => post("/api/imports", body()), byId("import"));
  if (!made) return;
  sessionStorage.removeItem(KEPT);
  tell(_("Imported {name}", made));
  location.href = `/recordings/${made.id}`;
});

/** One file has the same way to its answer as a folder. */
async function analyseOne() {
  if (!(await subjectMade())) return;
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

const ready = attempt(box.upload, async () => {
  const before = kept();
  [units] = await Promise.all([get("/api/units"), listSubjects(), listUploads()]);
  if (!uploads.length) return;
  included = new Set((before?.included ?? [uploads[uploads.length - 1].id]).filter((id) => uploads.some((one) => one.id === id)));
  for (const [id, value] of before?.entered ?? []) byId(id).value = value;
  await inspect(included.size && before ? before.mapping : null);
});
