// Fields of colour: the correlation map and the coverage of lengths and velocities.

import { h, s } from "../core/dom.js";
import { number } from "../core/format.js";

/** Correlations of parameters; strong ones carry their number, so that grey is enough. */
export function correlations(names, matrix) {
  const cell = 34;
  const left = 70;
  const top = 66;
  const size = names.length * cell;
  const drawing = s("svg", {
    class: "chart",
    width: left + size + 4,
    height: top + size + 4,
    viewBox: `0 0 ${left + size + 4} ${top + size + 4}`,
    role: "img",
    "aria-label": `Correlations of ${names.length} parameters; the strong ones are listed beside`,
  });
  names.forEach((name, i) => {
    const at = top + i * cell + cell / 2;
    drawing.append(s("text", { x: left - 6, y: at + 4, "text-anchor": "end" }, name));
    const x = left + i * cell + cell / 2;
    drawing.append(s("text", { x, y: top - 8, transform: `rotate(-60 ${x} ${top - 8})` }, name));
  });
  matrix.forEach((row, i) =>
    row.forEach((value, j) => {
      const [x, y] = [left + j * cell, top + i * cell];
      if (i === j) {
        drawing.append(s("rect", { x: x + 1, y: y + 1, width: cell - 2, height: cell - 2, class: "grid" }));
        return;
      }
      const strength = Math.abs(value ?? 0);
      const square = s("rect", { x: x + 1, y: y + 1, width: cell - 2, height: cell - 2, rx: 3 });
      square.style.fill = value >= 0 ? "var(--series-1)" : "var(--series-2)";
      square.style.opacity = (0.04 + 0.86 * strength ** 1.5).toFixed(3);
      square.append(s("title", {}, `${names[i]}, ${names[j]}: ${number(value, 2)}`));
      drawing.append(square);
      if (strength >= 0.5) {
        const text = s("text", { x: x + cell / 2, y: y + cell / 2 + 4, "text-anchor": "middle" }, value.toFixed(2).replace("0.", ".").replace("-", "−"));
        text.style.fontSize = "11px";
        if (strength > 0.75) text.style.fill = "var(--surface)";
        drawing.append(text);
      }
    }),
  );
  return drawing;
}

/** Pairs of a correlation matrix from strong to weak. */
export function pairs(names, matrix, least = 0.8) {
  const found = [];
  for (let i = 0; i < names.length; i++) {
    for (let j = i + 1; j < names.length; j++) {
      const value = matrix[i][j];
      if (value !== null && Math.abs(value) >= least) found.push({ a: names[i], b: names[j], value });
    }
  }
  return found.sort((x, y) => Math.abs(y.value) - Math.abs(x.value));
}

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
