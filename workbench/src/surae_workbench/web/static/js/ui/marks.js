// States and verdicts: colour, shape and word, so that they are told apart in grey, too.

import { h } from "../core/dom.js";
import { verdictText } from "../core/format.js";
import { _ } from "../core/words.js";

export const verdict = (name, note = null) => h("span", { class: `mark ${name}`, title: note }, verdictText(name));
export const mark = (name, text = _(name)) => h("span", { class: `mark ${name}` }, text);
/** The status of a fit: only "converged" is good news. */
export const status = (name) => h("span", { class: `mark ${name === "converged" ? "converged" : "warning"}` }, name === "at-bounds" ? _("at a bound") : _(name));
/** A fit of recordings that mean something else now. */
export const older = (fit) =>
  fit.older.length > 0 && h("span", { class: "mark warning", title: _("Described anew since: {names}", { names: fit.older.join(", ") }) }, _("older description"));
