// Estimates with their intervals: one small drawing per parameter.

import { s } from "../core/dom.js";
import { number } from "../core/format.js";

const WIDTH = 160;
const MARGIN = 6;

/**
 * @param estimates [{value, ci95, dash}] one line each
 * @param limits {lower, upper}: the axis covers all of them and the estimates
 */
export function ranges(estimates, limits, label) {
  const rows = estimates.length;
  const height = Math.max(24, 12 + 12 * rows);
  const known = estimates.filter((one) => one && one.value !== null && one.value !== undefined);
  const points = known.flatMap((one) => [one.value, ...inside(one.ci95, limits)]);
  if (!points.length) return "—";
  let [low, high] = [Math.min(...points), Math.max(...points)];
  const pad = 0.12 * (high - low) || 0.3 * Math.abs(high) || 1;
  [low, high] = [low - pad, high + pad];
  const x = (value) => MARGIN + ((WIDTH - 2 * MARGIN) * (Math.min(Math.max(value, low), high) - low)) / (high - low);

  const drawing = s("svg", { class: "chart", width: WIDTH, height, viewBox: `0 0 ${WIDTH} ${height}`, role: "img", "aria-label": label });
  drawing.append(s("line", { class: "axis", x1: MARGIN, x2: WIDTH - MARGIN, y1: height - 2, y2: height - 2 }));
  for (const [name, at] of [["lower", limits.lower], ["upper", limits.upper]]) {
    if (at !== null && at !== undefined && at >= low && at <= high) {
      drawing.append(s("line", { class: "bounds", x1: x(at), x2: x(at), y1: 2, y2: height - 2, "stroke-dasharray": "2 2" }, s("title", {}, `${name} bound ${number(at)}`)));
    }
  }
  estimates.forEach((one, row) => {
    if (!one || one.value === null || one.value === undefined) return;
    const y = rows === 1 ? height / 2 - 1 : 9 + 12 * row;
    if (one.ci95 && one.ci95[0] !== null) {
      const [a, b] = one.ci95.map(x);
      drawing.append(s("line", { class: "ci", x1: a, x2: b, y1: y, y2: y }));
      for (const end of [a, b]) drawing.append(s("line", { class: "ci", x1: end, x2: end, y1: y - 3, y2: y + 3 }));
    }
    drawing.append(marker(x(one.value), y, row));
  });
  return drawing;
}

/** An interval may be far wider than what is possible: the axis stops at the bounds. */
function inside(ci95, { lower, upper }) {
  if (!ci95 || ci95[0] === null) return [];
  return [Math.max(ci95[0], lower ?? ci95[0]), Math.min(ci95[1], upper ?? ci95[1])];
}

const SHAPES = [
  (x, y) => s("circle", { class: "dot", cx: x, cy: y, r: 4.5 }),
  (x, y) => s("rect", { class: "dot", x: x - 4, y: y - 4, width: 8, height: 8 }),
  (x, y) => s("path", { class: "dot", d: `M${x} ${y - 5}l5 9h-10z` }),
  (x, y) => s("path", { class: "dot", d: `M${x} ${y - 5.5}l5 5.5l-5 5.5l-5 -5.5z` }),
];
const marker = (x, y, row) => SHAPES[row % SHAPES.length](x, y);
