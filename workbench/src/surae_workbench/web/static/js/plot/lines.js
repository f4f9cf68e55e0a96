// One panel of lines over time: its heading with legend and read-out, and a uPlot below.

import { h, s } from "../core/dom.js";
import { NONE, number } from "../core/format.js";
import { bands } from "./bands.js";
import { colour } from "../core/theme.js";
import { _, decimal } from "../core/words.js";

const DASHES = { dash: [8, 5], dot: [2, 4] };
/** Width of the y axis: panels under one another share their zero. */
const AXIS = 58;

function key(series) {
  const dash = series.dash ? DASHES[series.dash].join(" ") : null;
  const line = s("line", { x1: 0, x2: 22, y1: 6, y2: 6, "stroke-width": series.width ?? 1.5, "stroke-dasharray": dash });
  line.style.stroke = `var(--${series.colour})`;
  return s("svg", { width: 22, height: 12, "aria-hidden": "true" }, line);
}

/**
 * A panel.
 *
 * @param panel {title, unit, series: [{label, colour, width, dash}], height, x: {label, unit, time}}
 * @param options {sync, spans, drag: () => "zoom"|"exclude"|null, onRange, onExclude, bottom}
 */
export function lines(panel, options = {}) {
  const readout = h("span", { class: "readout", "aria-hidden": "true" });
  const heading = h("h3", {}, title(panel));
  const legend = h(
    "ul",
    { class: "legend" },
    panel.series.length > 1 || panel.legend ? panel.series.map((one) => h("li", {}, key(one), one.label)) : [],
  );
  const over = panel.x?.label ?? _("time");
  const canvas = h("div", { class: "plot-canvas", role: "img", "aria-label": _("Plot: {what} over {x}", { what: title(panel), x: over }) });
  const element = h("div", { class: "plot-panel" }, h("div", { class: "plot-head" }, heading, legend, readout), canvas);

  let plot = null;
  let data = [[0], ...panel.series.map(() => [null])];
  let range = null;

  function create() {
    const axis = {
      stroke: () => colour("muted"),
      grid: { stroke: () => colour("grid"), width: 1 },
      ticks: { stroke: () => colour("grid"), width: 1 },
      font: '12px system-ui, "Liberation Sans", sans-serif',
    };
    plot = new uPlot(
      {
        width: Math.max(canvas.clientWidth, 200),
        height: panel.height ?? 150,
        legend: { show: false },
        padding: [8, panel.x?.unit?.length > 1 ? 26 : 12, 0, 0], // the last tick carries the unit
        cursor: {
          sync: options.sync ? { key: options.sync, setSeries: false, scales: ["x", null] } : undefined,
          drag: { x: true, y: false, setScale: false, uni: 5 },
          points: { size: 6 },
          y: false,
        },
        scales: { x: { time: false, range: (u, low, high) => range ?? [low, high] }, y: { range: padded } },
        axes: [
          { ...axis, size: options.bottom === false ? 8 : 34, values: options.bottom === false ? () => [] : (u, ticks) => named(ticks, panel.x?.unit ?? "s") },
          { ...axis, size: AXIS, space: 18, values: (u, ticks) => ticks.map((t) => decimal(String(+t.toPrecision(6)).replace("-", "−"))) },
        ],
        series: [
          {},
          ...panel.series.map((one) => ({
            label: one.label,
            stroke: () => colour(one.colour),
            width: one.width ?? 1.4,
            dash: one.dash ? DASHES[one.dash] : undefined,
            points: { show: one.points ?? false, size: 6 },
            spanGaps: false,
          })),
        ],
        plugins: options.spans ? [bands(options.spans)] : [],
        hooks: { setSelect: [selected], setCursor: [read] },
      },
      data,
      canvas,
    );
    plot.over.addEventListener("dblclick", () => options.onRange?.(null));
  }

  function selected(u) {
    const { left, width } = u.select;
    if (width < 4) return;
    const [start, end] = [u.posToVal(left, "x"), u.posToVal(left + width, "x")];
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    if ((options.drag?.() ?? "zoom") === "exclude") options.onExclude?.(start, end);
    else options.onRange?.([start, end]);
  }

  function read(u) {
    const at = u.cursor.idx;
    if (at === null || at === undefined || !u.data[0].length) {
      readout.textContent = "";
      return;
    }
    const values = panel.series.map((one, i) => number(u.data[i + 1][at], 4));
    if (values.every((text) => text === NONE)) {
      readout.textContent = "";
      return;
    }
    const x = number(u.data[0][at], 5);
    readout.textContent = `${x} ${panel.x?.unit ?? "s"}: ${values.join(" / ")} ${panel.unit ?? ""}`;
  }

  const watch = new ResizeObserver(() => {
    if (!canvas.clientWidth) return;
    if (!plot) create();
    else if (plot.width !== canvas.clientWidth) plot.setSize({ width: canvas.clientWidth, height: panel.height ?? 150 });
  });
  watch.observe(canvas);

  return {
    element,
    canvas,
    /** Show [x, y…]; `to` is the range of x, null for all of it. */
    show(next, to = range) {
      data = next;
      range = to;
      plot?.setData(data);
    },
    range(to) {
      range = to;
      if (plot && to) plot.setScale("x", { min: to[0], max: to[1] });
    },
    unit(text) {
      panel.unit = text;
      heading.textContent = title(panel);
    },
    redraw: () => plot?.redraw(false, true),
    destroy() {
      watch.disconnect();
      plot?.destroy();
    },
  };
}

/** Ticks of x; the last one carries the unit. */
function named(ticks, unit) {
  const texts = ticks.map((t) => decimal(String(+t.toPrecision(6)).replace("-", "−")));
  if (texts.length && unit) texts[texts.length - 1] += ` ${unit}`;
  return texts;
}

const title = (panel) => (panel.unit ? `${panel.title} [${panel.unit}]` : panel.title);

function padded(u, low, high) {
  if (low === null || high === null) return [0, 1];
  const pad = 0.06 * (high - low) || 0.5 * Math.abs(high) || 1;
  return [low - pad, high + pad];
}
