// Fields of colour: the coverage of lengths and velocities.

import { h, s } from "../core/dom.js";
import { number } from "../core/format.js";

/**
 * Share of time over two quantities.
 *
 * @param x {label, edges}, @param y {label, edges}, @param share share[j][i]: y cell j, x cell i
 */
export function density(x, y, share, label) {
  const [width, height, left, bottom] = [520, 330, 64, 46];
  const most = Math.max(...share.flat(), 1e-12);
  const px = (i) => left + ((width - left - 10) * i) / (x.edges.length - 1);
  const py = (j) => 8 + ((height - bottom - 8) * (y.edges.length - 1 - j)) / (y.edges.length - 1);
  const drawing = s("svg", { class: "chart", width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label });
  share.forEach((row, j) =>
    row.forEach((value, i) => {
      const cell = s("rect", { x: px(i) + 0.5, y: py(j + 1) + 0.5, width: px(i + 1) - px(i) - 1, height: py(j) - py(j + 1) - 1 });
      cell.style.fill = value > 0 ? "var(--series-1)" : "var(--raised)";
      cell.style.opacity = value > 0 ? (0.2 + 0.8 * Math.sqrt(value / most)).toFixed(3) : "1";
      if (value > 0) cell.append(s("title", {}, `${number(100 * value, 2)} % of the time`));
      drawing.append(cell);
    }),
  );
  ticks(x.edges).forEach(([i, text]) => drawing.append(s("text", { class: "quiet", x: px(i), y: height - bottom + 16, "text-anchor": "middle" }, text)));
  ticks(y.edges).forEach(([j, text]) => drawing.append(s("text", { class: "quiet", x: left - 6, y: py(j) + 4, "text-anchor": "end" }, text)));
  const middle = (height - bottom) / 2;
  drawing.append(s("text", { x: (left + width) / 2, y: height - 8, "text-anchor": "middle" }, x.label));
  drawing.append(s("text", { x: 14, y: middle, "text-anchor": "middle", transform: `rotate(-90 14 ${middle})` }, y.label));
  return h("figure", {}, drawing);
}

/** About five edges with their text. */
function ticks(edges) {
  const step = Math.max(1, Math.round((edges.length - 1) / 5));
  const found = [];
  for (let i = 0; i < edges.length; i += step) found.push([i, number(Math.abs(edges[i]) < 1e-9 ? 0 : edges[i], 2)]);
  return found;
}
