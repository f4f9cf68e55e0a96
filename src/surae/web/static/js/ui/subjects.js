// Who: a code, never a name.

import { field, h, select } from "../core/dom.js";
import { ask } from "./dialog.js";

/** Ask for a subject; null when cancelled. */
export async function editSubject(person = null) {
  const code = h("input", { type: "text", required: true, maxlength: 40, value: person?.code ?? "" });
  const group = select({}, [["", "not told"], ["healthy", "healthy"], ["patient", "patient"]], person?.group ?? "");
  const mass = h("input", { type: "number", min: 10, max: 300, step: "any", value: person?.body_mass ?? "" });
  const notes = h("input", { type: "text", maxlength: 500, value: person?.notes ?? "" });
  const content = h(
    "div",
    { class: "fields" },
    field("Code, for example S01", code),
    field("Group", group),
    field("Body mass [kg]", mass),
    field("Notes", notes),
  );
  const sure = await ask(person ? `Subject ${person.code}` : "New subject", content, { confirm: "Save" });
  if (!sure || !code.value.trim()) return null;
  return {
    code: code.value.trim(),
    group: group.value,
    notes: notes.value,
    body_mass: mass.value ? Number(mass.value) : null,
  };
}
