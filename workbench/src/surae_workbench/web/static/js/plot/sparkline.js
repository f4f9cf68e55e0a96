// A small picture of a signal.

import { s } from "../core/dom.js";

/** Values over time as a path; `factor` and `offset` are applied first. */
export function sparkline({ t, v }, label, factor = 1, offset = 0) {
  const values = v.map((y) => (y === null ? null : factor * y + offset));
  const known = values.filter((y) => y !== null);
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const [first, last] = [t[0], t[t.length - 1]];
  const x = (i) => (100 * (t[i] - first)) / (last - first || 1);
  const y = (i) => 28 - (26 * (values[i] - low)) / (high - low || 1);
  let path = "";
  let pen = "M";
  for (let i = 0; i < t.length; i++) {
    if (values[i] === null) pen = "M";
    else {
      path += `${pen}${x(i).toFixed(2)} ${y(i).toFixed(2)}`;
      pen = "L";
    }
  }
  return s(
    "svg",
    { class: "sparkline", viewBox: "0 0 100 30", preserveAspectRatio: "none", role: "img", "aria-label": label },
    s("path", { d: path }),
  );
}
