// Questions that stop what one is doing.

import { button, field, h, select } from "../core/dom.js";
import { _ } from "../core/words.js";

/** A dialog with inputs; resolves to true when confirmed. */
export function ask(title, content, { confirm = "OK", cancel = _("Cancel"), danger = false } = {}) {
  return new Promise((resolve) => {
    const form = h(
      "form",
      { method: "dialog" },
      h("h2", { id: "dialog-title" }, title),
      content,
      h(
        "div",
        { class: "button-row" },
        h("button", { type: "submit", value: "yes", class: danger ? "danger" : "primary" }, confirm),
        button(cancel, () => box.close("no")),
      ),
    );
    const box = h("dialog", { "aria-labelledby": "dialog-title" }, form);
    box.addEventListener("close", () => {
      box.remove();
      resolve(box.returnValue === "yes");
    });
    document.body.append(box);
    box.showModal();
  });
}

/** Ask for a subject: a code, never a name; null when cancelled. */
export async function editSubject(person = null) {
  const code = h("input", { type: "text", required: true, maxlength: 40, value: person?.code ?? "" });
  const group = select({}, [["", _("unknown")], ["healthy", _("healthy")], ["patient", _("patient")]], person?.group ?? "");
  const mass = h("input", { type: "number", min: 10, max: 300, step: "any", value: person?.body_mass ?? "" });
  const notes = h("input", { type: "text", maxlength: 500, value: person?.notes ?? "" });
  const content = h(
    "div",
    { class: "fields" },
    field(_("Code, for example S01"), code),
    field(_("Group"), group),
    field(_("Body mass [kg]"), mass),
    field(_("Notes"), notes),
  );
  const sure = await ask(person ? _("Subject {code}", person) : _("New subject"), content, { confirm: _("Save") });
  if (!sure || !code.value.trim()) return null;
  return {
    code: code.value.trim(),
    group: group.value,
    notes: notes.value,
    body_mass: mass.value ? Number(mass.value) : null,
  };
}
