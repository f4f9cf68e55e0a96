// A recording described anew after its import: columns, units, signs, zeros, with a live check.

import { get, post } from "../core/api.js";
import { button, field, h, replace, select } from "../core/dom.js";
import { rate, roleText, shownRange } from "../core/format.js";
import { attempt, calm, complain, tell } from "../core/notice.js";
import { latest, settled } from "../core/pace.js";
import { findingsTable } from "./findings.js";
import { mappingTable } from "./mapping.js";
import { _, said } from "../core/words.js";

const UNDO = _("Undo takes it back.");

/** Change what one finding is about, at once. */
export async function mend(id, finding) {
  const { mapping } = await get(`/api/recordings/${id}/description`);
  for (const [role, change] of Object.entries(finding.mend.channels)) Object.assign(mapping.channels[role], change);
  await post("/api/descriptions", { recordings: [id], mapping });
  tell(`${said({ text: finding.mend.label, given: finding.mend.given })}: ${_("done")}. ${UNDO}`);
}

/** What a mapping makes of a recording, in a line. */
export const ranges = (channels) =>
  h("p", { class: "muted small" }, channels.map((c) => `${roleText(c.role)} ${shownRange(c.low, c.high, c.unit)}, ${rate(c.rate_hz)}`).join(" · "));

/** A form in `place` that describes a recording; `done` is called at its end, with what was said. */
export async function describe(id, place, box, done) {
  const [answer, units] = await Promise.all([get(`/api/recordings/${id}/description`), get("/api/units")]);
  const { mapping } = answer;
  const table = h("div");
  const seen = h("div", { "aria-live": "polite" });
  const emg = select({}, [["raw", _("raw")], ["envelope", _("envelope")]], mapping.emg ?? "raw");
  const gravity = h("input", { type: "checkbox", checked: mapping.fixed.m === 0 });
  const others = answer.alike.map((other) => [other.id, h("input", { type: "checkbox" }), other.name]);

  const body = () => {
    mapping.emg = emg.value;
    const { m: _, ...fixed } = mapping.fixed;
    mapping.fixed = gravity.checked ? { ...fixed, m: 0 } : mapping.fixed.m === 0 ? fixed : mapping.fixed;
    return { recordings: [id, ...others.filter(([, tick]) => tick.checked).map(([other]) => other)], mapping };
  };
  const look = latest(async () => {
    calm(box);
    try {
      const made = await post("/api/descriptions/preview", body());
      replace(seen, h("h3", {}, _("As it will be")), ranges(made.channels), findingsTable(made.findings, null));
    } catch (error) {
      replace(seen);
      complain(box, error);
    }
  });
  const check = settled(look, 350);
  const changed = () => {
    replace(table, mappingTable(mapping, answer.files, units, changed));
    check();
  };
  for (const input of [emg, gravity]) input.addEventListener("change", check);
  const save = h("button", { type: "submit", class: "primary" }, _("Save this description"));
  const form = h(
    "form",
    { class: "panel", on: { submit: async (event) => {
      event.preventDefault();
      const made = await attempt(box, () => post("/api/descriptions", body()), save);
      if (!made) return;
      tell(`${made.recordings.map((one) => one.name).join(", ")}: ${_("described anew.")} ${UNDO}`);
      replace(place);
      done();
    } } },
    table,
    h("p", { class: "muted small" }, _("For a column that was not imported, add the trial again.")),
    h("div", { class: "fields" }, field(_("EMG is"), emg)),
    h("label", { class: "check" }, gravity, _("Inertia and gravity are taken out of the torque already (inverse dynamics)")),
    others.length > 0 && h("fieldset", { class: "plain" }, h("legend", {}, _("The same for these, which have the same columns")), others.map(([, tick, name]) => h("label", { class: "check" }, tick, name))),
    seen,
    h("div", { class: "button-row" }, save, button(_("Cancel"), () => { calm(box); replace(place); done(); })),
  );
  replace(place, form);
  changed();
}
