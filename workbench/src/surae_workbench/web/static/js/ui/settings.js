// Model, priors, loss and the rest of what a fit may be given, as the server describes the settings.

import { field, h, replace, select } from "../core/dom.js";
import { _ } from "../core/words.js";

/** Draw the settings of a draft; `store(what, label)` keeps a change, made of the draft as it then is. */
export function settingsForm(main, more, models, draft, store, recordings) {
  const shown = models.settings.filter((one) => inPlace(one, draft));
  const fields = (first) => shown.filter((one) => one.first === first).map((one) => setting(one, draft, store));
  replace(main, fields(true), h("div", { class: "drives" }, models.drives.map((one) => drive(one, draft.parameters, store))));
  replace(more, fields(false), plate(draft, store), draft.normalise === "mvc" && contractions(recordings, draft, store));
}

/** Whether a setting has an effect, beside those that are set. */
export function inPlace({ needs }, draft) {
  const [name, value] = needs.split(/!?=/);
  return !needs || (draft[name] === value) !== needs.includes("!=");
}

/** What a draft says of a setting: null where that is nothing. */
export function valueOf({ path }, draft) {
  const [key, part] = path;
  return (part === undefined ? draft[key] : draft[key]?.[part]) ?? null;
}

/** The change of a draft that gives a setting a value; null: its default. */
export function changeOf({ path, default: usual }, value, draft) {
  const [key, part] = path;
  if (part !== undefined) {
    const made = { ...draft[key], [part]: value };
    if (value === null) delete made[part];
    return { [key]: made };
  }
  return { [key]: value ?? usual };
}

/** One setting: a choice, or a number with its default in grey. */
function setting(one, draft, store) {
  const now = valueOf(one, draft);
  const id = `set-${one.path.join("-")}`;
  const more = (value) => (one.path[0] === "normalise" && value !== "mvc" ? { mvc: [] } : {});
  const keep = (value, label) => store((now) => ({ ...changeOf(one, value, now), ...more(value) }), label);
  if (one.kind === "choice" || one.kind === "flag") {
    const flag = one.kind === "flag";
    const listed = one.choices.some(([value]) => value === now) || now === null ? now : one.default;
    const own = now?.name ? [["", now.name]] : []; // a table, known by its file
    const knob = select({ id }, [...own, ...one.choices.map(([value, text]) => [value, _(text)])], own.length ? "" : flag ? (now ? "yes" : "") : (listed ?? one.default ?? ""));
    knob.addEventListener("change", () => keep(flag ? knob.value === "yes" : knob.value || null, `${_(one.label)}: ${knob.selectedOptions[0].textContent}`));
    if (!one.file) return field(_(one.label), knob);
    const file = h("input", { type: "file", accept: ".csv,.txt", "aria-label": _("{label}: a file", { label: _(one.label) }) });
    file.addEventListener("change", async () => {
      const [picked] = file.files;
      if (picked) keep({ name: picked.name, text: await picked.text() }, `${_(one.label)}: ${picked.name}`);
    });
    return field(_(one.label), h("div", {}, knob, file));
  }
  if (one.kind === "record") return stated(one, now, id, keep);
  const off = one.optional && one.path[0] === "preparation"; // 0 switches it off
  const knob = h("input", {
    type: "number", step: one.kind === "whole" ? 1 : "any", id, min: off ? 0 : one.least, max: one.most,
    value: now === false ? 0 : now === one.default ? "" : (now ?? ""),
    placeholder: one.default ?? (off ? _("off") : one.path[0] === "knowledge" ? _("not known") : ""), title: off ? _("0: without this filter") : "",
  });
  knob.addEventListener("change", () => {
    if (!knob.checkValidity()) return knob.reportValidity();
    const value = knob.value === "" ? null : Number(knob.value);
    return keep(off && value === 0 ? false : value, `${_(one.label)} ${knob.value || _("default")}`);
  });
  return field(_(one.label), knob);
}

/** A number that was measured, how far it may be off, and perhaps what another reader said: the first two, or none. */
function stated(one, now, id, keep) {
  const number = (part, text, more) => h("input", { type: "number", step: "any", id: `${id}-${part}`, value: now?.[part] ?? "", placeholder: text, "aria-label": `${_(one.label)}: ${text}`, ...more });
  const [value, sd] = [number("value", _("not known"), {}), number("sd", "±", { min: 0.01 })];
  const again = one.parts.includes("again") ? [number("again", _("again"), {})] : [];
  const change = () => {
    const empty = [value, sd].filter((knob) => knob.value === "").length;
    if (empty === 1 || ![value, sd, ...again].every((knob) => knob.reportValidity())) return null;
    const more = again.filter((knob) => knob.value !== "").map((knob) => ["again", Number(knob.value)]);
    const said = empty ? null : { value: Number(value.value), sd: Number(sd.value), ...Object.fromEntries(more) };
    return keep(said, `${_(one.label)} ${said ? `${said.value}${"again" in said ? `, ${said.again}` : ""} ± ${said.sd}` : _("not known")}`);
  };
  for (const knob of [value, sd, ...again]) knob.addEventListener("change", change);
  return field(_(one.label), h("div", { class: "stated" }, value, sd, ...again));
}

/** The empty device, which is recorded with the trials, or was taken away before. */
function plate(draft, store) {
  const knob = select({ id: "set-knowledge-plate" }, [["", _("not known")], ["tared", _("taken away before (tared)")]], draft.knowledge?.plate ? "tared" : "");
  knob.addEventListener("change", () => store((now) => changeOf({ path: ["knowledge", "plate"] }, knob.value ? {} : null, now), `${_("Empty device")}: ${knob.selectedOptions[0].textContent}`));
  return field(_("Empty device"), knob);
}

/** Recordings of maximum contractions. */
function contractions(recordings, draft, store) {
  const knob = h("select", { id: "set-mvc", multiple: true }, recordings.map((one) => h("option", { value: one.id, selected: draft.mvc.includes(one.id) }, one.name)));
  knob.addEventListener("change", () => store({ mvc: [...knob.selectedOptions].map((one) => one.value) }, _("maximum contractions")));
  return field(_("Maximum contractions"), knob);
}

/** What may drive the muscles beside the EMG as it is: its parameters come and go together. */
function drive({ name, label, parameters: members }, values, store) {
  const knob = h("input", { type: "checkbox", id: `set-${name}`, checked: members.some((one) => values[one]) });
  knob.addEventListener("change", () => {
    const each = (value) => Object.fromEntries(members.map((one) => [one, value]));
    const change = knob.checked ? { parameters: each({ free: true }) } : { parameters: each(null), sliders: each(null) };
    store(change, `${_(label)}: ${knob.checked ? _("yes") : _("no")}`);
  });
  return h("label", { class: "check" }, knob, _(label));
}
