// A small picture of a signal.

import { s } from "../core/dom.js";

/** Values over time as a path, each times a factor. */
export function sparkline({ t, v }, label, factor = 1) {
  const values = v.map((y) => factor * y);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const x = (i) => (100 * (t[i] - t[0])) / (t[t.length - 1] - t[0] || 1);
  const y = (i) => 28 - (26 * (values[i] - low)) / (high - low || 1);
  const path = t.map((_, i) => `${i ? "L" : "M"}${x(i).toFixed(2)} ${y(i).toFixed(2)}`).join("");
  return s(
    "svg",
    { class: "sparkline", viewBox: "0 0 100 30", preserveAspectRatio: "none", role: "img", "aria-label": label },
    s("path", { d: path }),
  );
}
