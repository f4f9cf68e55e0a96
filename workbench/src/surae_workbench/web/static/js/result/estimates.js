// The table of estimates: value, interval, verdict, and what it rests on.

import { h, num, table } from "../core/dom.js";
import { NONE, estimate, interval, number, quantity, unitText } from "../core/format.js";
import { ranges } from "../plot/ranges.js";
import { meant, verdict } from "../ui/marks.js";

const KINDS = { robust: "Intervals allow for correlated residuals", thesis: "Intervals as in the thesis", marginal: "About the intervals" };

/** Imperfections of the laboratory that had nothing to act on. */
const UNFELT = /^(xt_|emg_|pt_|axis_|emd$|torque_zero$|angle_zero$)/;

export function estimates({ fit }) {
  const head = ["Parameter", "Estimate", meant("sem", "Standard error"), meant("interval-95", "95 % interval"), "Repeatable", h("span", {}, meant("identified", "Verdict"), ", and why"), "Interval and bounds"];
  const known = Object.entries(fit.parameters).filter(([name, p]) => p.free || !(fit.family && UNFELT.test(name)));
  const caption = ["Estimates. In the drawings: the dot is the estimate, the bar its 95 % interval, dashed lines the bounds of the fit. Repeatable: a repeat should agree within 10 %; both could be biased.", fit.interval_note ? ` ${KINDS[fit.interval] ?? "Intervals"}: ${fit.interval_note}.` : ""];
  return table("Estimates", head, known.map(([name, p]) => cells(name, p)), { caption, numbers: [1, 2] });
}

function cells(name, p) {
  const known = p.free ? p : { ...p, ci95: null };
  const sem = (p.interval === "robust" && p.sem_robust) || p.sem;
  return [
    meant(name),
    num(`${estimate(p.value, sem)} ${unitText(p.unit)}`),
    num(sem ? quantity(sem, p.unit, 2) : NONE),
    h("td", { class: "nowrap" }, p.free ? interval(p.ci95, sem, p.value) : NONE),
    p.ci95_repeat ? (p.repeatable ? "yes" : "no") : NONE,
    h("td", { class: "why" }, verdict(p.verdict), p.note && h("div", {}, p.note)),
    h("td", { class: "range-cell" }, ranges([known], { lower: p.lower, upper: p.upper }, `${name} is ${number(p.value, 3)}`)),
  ];
}
