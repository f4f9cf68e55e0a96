// Duration against precision: a point for each protocol, and the front of those that none beats.

import { h, s } from "../core/dom.js";
import { percent, seconds } from "../core/format.js";

const [WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT] = [640, 260, 58, 40, 12, 16];

/** Rows that no shorter or equally long one beats, by length. */
export function front(rows) {
  const sorted = [...rows].sort((a, b) => a.seconds - b.seconds || a.worst - b.worst);
  let best = Infinity;
  return sorted.filter((row) => row.worst < best && ((best = row.worst), true));
}

/** The picture; `rows` are {name, seconds, worst, designed}. */
export function frontPlot(rows) {
  const known = rows.filter((row) => typeof row.worst === "number" && row.worst > 0 && row.worst < 10);
  if (known.length < 2) return h("p", { class: "muted" }, "Too few protocols tell of every parameter.");
  const [times, errors] = [known.map((row) => row.seconds), known.map((row) => Math.log10(row.worst))];
  const [t0, t1] = [0, 1.08 * Math.max(...times)];
  const [e0, e1] = [Math.min(...errors) - 0.1, Math.max(...errors) + 0.1];
  const x = (t) => LEFT + ((WIDTH - LEFT - RIGHT) * (t - t0)) / (t1 - t0);
  const y = (error) => HEIGHT - BOTTOM - ((HEIGHT - BOTTOM - TOP) * (Math.log10(error) - e0)) / (e1 - e0);
  const ticks = [0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5].filter((v) => Math.log10(v) >= e0 && Math.log10(v) <= e1);
  const step = t1 > 150 ? 60 : t1 > 60 ? 20 : 10;
  const marks = Array.from({ length: Math.floor(t1 / step) + 1 }, (_, k) => k * step);
  const best = front(known);
  const path = best.map((row, k) => (k ? `H${x(row.seconds)}V${y(row.worst)}` : `M${x(row.seconds)} ${y(row.worst)}`)).join("");
  const told = best.map((row) => `${row.name}: ${seconds(row.seconds)}, ${percent(100 * row.worst, 2)}`).join("; ");
  return s(
    "svg",
    { class: "front", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `Duration against the largest error. None beats: ${told}` },
    ticks.map((v) => [s("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y(v), y2: y(v) }), s("text", { x: LEFT - 6, y: y(v) + 4, "text-anchor": "end" }, percent(100 * v, 1))]),
    marks.map((t) => s("text", { x: x(t), y: HEIGHT - BOTTOM + 16, "text-anchor": "middle" }, String(t))),
    s("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 6, "text-anchor": "middle" }, "Duration [s]"),
    s("text", { x: 12, y: (HEIGHT - BOTTOM) / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${(HEIGHT - BOTTOM) / 2})` }, "Largest error"),
    s("path", { class: "line", d: path }),
    known.map((row) =>
      s(
        "g",
        { class: row.designed ? "designed" : "other" },
        row.designed ? s("circle", { cx: x(row.seconds), cy: y(row.worst), r: 5 }) : s("rect", { x: x(row.seconds) - 4, y: y(row.worst) - 4, width: 8, height: 8 }),
        s("title", {}, `${row.name}: ${seconds(row.seconds)}, ${percent(100 * row.worst, 2)}`),
      ),
    ),
    labels(best, x, y),
  );
}

/** Names of those on the front, where they do not cover one another. */
function labels(best, x, y) {
  let last = -Infinity;
  return best.map((row) => {
    const at = y(row.worst) - 9;
    const shown = x(row.seconds) - last > 90;
    if (shown) last = x(row.seconds);
    return shown && s("text", { class: "name", x: Math.min(x(row.seconds) + 7, WIDTH - 90), y: at }, row.name);
  });
}
