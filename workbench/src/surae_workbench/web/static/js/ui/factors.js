// The factors of a study as a form, which writes the TOML.

import { field, h } from "../core/dom.js";
import { _ } from "../core/words.js";

/** Numbers that may be varied: what they are called, what they are, and where one begins. */
const NUMBERS = [
  ["chirp_amplitude", _("Amplitude of the chirp [rad]"), "0, 0.1, 0.2"],
  ["chirp_rate", _("Rise of its frequency [Hz/s]"), "0.159"],
  ["noise", _("Noise, part of each signal"), "0.05"],
];
const COUNTS = [["subjects", _("Virtual legs"), "2"], ["repeats", _("Trials of each"), "1"]];
/** What may be chosen: its key among the choices, and what it is called. */
const CHOICES = [
  ["protocol", "profiles", _("Movement"), ["multiple-holds"]],
  ["task", "tasks", _("Effort"), ["part-passive"]],
  ["population", "populations", _("Population"), ["healthy"]],
  ["model", "models", _("Model that is fitted"), ["muscle"]],
];

/**
 * The form.
 *
 * @param choices what the server offers
 * @param changed called with the TOML and the number of fits, or null where an entry is wrong
 */
export function factors(choices, changed) {
  const name = h("input", { type: "text", required: true, maxlength: 60, value: "chirp" });
  const numbers = NUMBERS.map(([key, label, value]) => [key, h("input", { type: "text", required: true, value, inputmode: "decimal", "aria-label": label }), label]);
  const counts = COUNTS.map(([key, label, value]) => [key, h("input", { type: "number", required: true, min: 1, max: 10000, step: 1, value }), label]);
  const lists = CHOICES.map(([key, from, label, chosen]) => [
    key,
    choices[from].map((one) => one.name ?? one).map((value) => [value, h("input", { type: "checkbox", checked: chosen.includes(value) })]),
    label,
  ]);

  function write() {
    const lines = [`name = ${JSON.stringify(name.value.trim() || "study")}`];
    let fits = 1;
    let good = true;
    const add = (key, values) => {
      fits *= values.length;
      lines.push(`${key} = ${values.length === 1 ? values[0] : `[${values.join(", ")}]`}`);
    };
    for (const [key, ticks] of lists) {
      const values = ticks.filter(([, tick]) => tick.checked).map(([value]) => JSON.stringify(value));
      ticks[0][1].setCustomValidity(values.length ? "" : _("choose at least one"));
      good &&= values.length > 0;
      add(key, values);
    }
    for (const [key, input] of numbers) {
      const values = input.value.split(/[,;\s]+/).filter(Boolean).map(Number);
      const fine = values.length > 0 && values.every((value) => Number.isFinite(value) && value >= 0);
      input.setCustomValidity(fine ? "" : _("numbers of 0 or more, with commas between them"));
      good &&= fine;
      // TOML tells whole numbers from others: these are all others.
      add(key, values.map((value) => (Number.isInteger(value) ? value.toFixed(1) : String(value))));
    }
    for (const [key, input] of counts) {
      good &&= input.checkValidity();
      fits *= input.valueAsNumber || 0;
      lines.push(`${key} = ${input.valueAsNumber || 1}`);
    }
    if (good) changed(`${lines.join("\n")}\n`, fits);
    else changed(null, 0);
  }

  const element = h(
    "div",
    { class: "panel", on: { input: write } },
    h("div", { class: "fields" }, field(_("Name"), name), counts.map(([, input, label]) => field(label, input))),
    h("div", { class: "fields" }, numbers.map(([, input, label]) => field(label, input, _("several with commas")))),
    lists.map(([, ticks, label]) => h("fieldset", { class: "plain" }, h("legend", {}, label), ticks.map(([value, tick]) => h("label", { class: "check" }, tick, value)))),
  );
  return { element, write };
}
