// What the check of a recording found, in words.

import { button, h, table } from "../core/dom.js";
import { roleText, span } from "../core/format.js";
import { mark } from "./marks.js";

/** A list of findings; `act` gives {show, exclude, mend} of a finding, and the trial's `duration`; null: nothing to do. */
export function findingsTable(findings, act) {
  if (!findings.length) return h("p", { class: "muted" }, "The check found nothing to object to.");
  const ranked = [...findings].sort((a, b) => order(a) - order(b) || (a.start_s ?? -1) - (b.start_s ?? -1));
  return table(
    "Findings",
    ["Severity", "Signal", "When", "What, and what to do", ...(act ? [h("span", { class: "sr" }, "Actions")] : [])],
    ranked.map((one) => row(one, act)),
    { class: "findings", caption: `${findings.length} ${findings.length === 1 ? "finding" : "findings"} of the check` },
  );
}

const order = (one) => ["error", "warning", "info"].indexOf(one.severity);
const timed = (one) => one.start_s !== null && one.start_s !== undefined && one.end_s !== null && one.end_s !== undefined;

/** Whether it is about a part of the trial: to leave out the whole would mend nothing. */
export const part = (one, duration) => timed(one) && one.end_s - one.start_s < 0.9 * duration;

function row(one, act) {
  const what = `${one.message}`;
  return h(
    "tr",
    {},
    h("td", {}, mark(one.severity)),
    h("td", {}, one.channel ? roleText(one.channel) : "—"),
    h("td", { class: "nowrap" }, timed(one) ? span(one.start_s, one.end_s) : "—"),
    h("td", {}, what, one.advice && h("div", { class: "muted small" }, one.advice)),
    act &&
      h(
        "td",
        {},
        timed(one) &&
          h(
            "div",
            { class: "button-row" },
            button("Show", () => act.show(one), { class: "small", "aria-label": `Show ${what}` }),
            part(one, act.duration()) && button("Exclude", () => act.exclude(one), { class: "small", "aria-label": `Exclude ${span(one.start_s, one.end_s)}` }),
            one.mend && button(one.mend.label, () => act.mend(one), { class: "small primary" }),
          ),
      ),
  );
}
