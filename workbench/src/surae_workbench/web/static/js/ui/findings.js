// What the check of a recording found, in words.

import { button, h, table } from "../core/dom.js";
import { roleText, span } from "../core/format.js";
import { mark } from "./marks.js";
import { _, many, said } from "../core/words.js";

/** A list of findings; `act` gives {show, exclude, mend} of a finding, and the trial's `duration`; null: nothing to do. */
export function findingsTable(findings, act) {
  if (!findings.length) return h("p", { class: "muted" }, _("The check found nothing to object to."));
  const ranked = [...findings].sort((a, b) => order(a) - order(b) || (a.start_s ?? -1) - (b.start_s ?? -1));
  return table(
    _("Findings"),
    [_("Severity"), _("Signal"), _("When"), _("What, and what to do"), ...(act ? [h("span", { class: "sr" }, _("Actions"))] : [])],
    ranked.map((one) => row(one, act, ranked.some((other) => other.mend && one.channel in other.mend.channels))),
    { class: "findings", caption: many("{n} finding of the check", "{n} findings of the check", findings.length) },
  );
}

const order = (one) => ["error", "warning", "info"].indexOf(one.severity);
const timed = (one) => one.start_s !== null && one.start_s !== undefined && one.end_s !== null && one.end_s !== undefined;

/** Whether it is about a part of the trial: to leave out the whole would mend nothing. */
export const part = (one, duration) => timed(one) && one.end_s - one.start_s < 0.9 * duration;

function row(one, act, mends) {
  const what = said({ text: one.message, ...one.said });
  return h(
    "tr",
    {},
    h("td", {}, mark(one.severity)),
    h("td", {}, one.channel ? roleText(one.channel) : "—"),
    h("td", { class: "nowrap" }, timed(one) ? span(one.start_s, one.end_s) : "—"),
    // Where a button does it, nobody has to write a mapping.
    h("td", {}, what, !mends && h("div", { class: "muted small" }, said({ text: one.advice, ...one.advised }))),
    act &&
      h(
        "td",
        {},
        timed(one) &&
          h(
            "div",
            { class: "button-row" },
            button(_("Show"), () => act.show(one), { class: "small", "aria-label": _("Show {what}", { what }) }),
            part(one, act.duration()) && button(_("Exclude"), () => act.exclude(one), { class: "small", "aria-label": _("Exclude {span}", { span: span(one.start_s, one.end_s) }) }),
            one.mend && button(said({ text: one.mend.label, given: one.mend.given }), () => act.mend(one), { class: "small primary" }),
          ),
      ),
  );
}
