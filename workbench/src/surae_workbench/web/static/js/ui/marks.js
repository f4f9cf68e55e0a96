// States and verdicts: colour, shape and word, so that they are told apart in grey, too.

import { h } from "../core/dom.js";
import { verdictText } from "../core/format.js";

export const verdict = (name, note = null) => h("span", { class: `mark ${name}`, title: note }, verdictText(name));
export const mark = (name, text = name) => h("span", { class: `mark ${name}` }, text);
/** The status of a fit: only "converged" is good news. */
export const status = (name) => h("span", { class: `mark ${name === "converged" ? "converged" : "warning"}` }, name === "at-bounds" ? "at a bound" : name);
/** A fit of recordings that mean something else now. */
export const older = (fit) =>
  fit.older.length > 0 && h("span", { class: "mark warning", title: `Described anew since: ${fit.older.join(", ")}` }, "older description");
