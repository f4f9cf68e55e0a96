// Panels under one another that share their time: zoom, pan, exclude, with mouse and keyboard.

import { button, h, replace } from "../core/dom.js";
import { settled } from "../core/pace.js";
import { bandsKey } from "./bands.js";
import { onTheme } from "../core/theme.js";
import { lines } from "./lines.js";
import { _ } from "../core/words.js";

let count = 0;

/**
 * Linked panels.
 *
 * @param panels as for `lines`; with a `role`, a panel shows only the spans of this signal and of none
 * @param options {duration, spans, onExclude, load(range), label}: `load` fetches the data of a
 *   range of time (null: all) and calls `show` of the panels; it may be asked again at any time.
 */
export function linked(panels, options) {
  const sync = `linked-${++count}`;
  let mode = "zoom";
  let range = null;

  const made = panels.map((panel, index) =>
    lines(panel, {
      sync,
      spans: options.spans && (() => options.spans().filter((one) => !one.role || !panel.role || panel.role === one.role)),
      drag: () => mode,
      onRange: go,
      onExclude: options.onExclude,
      bottom: index === panels.length - 1,
    }),
  );
  const load = settled(() => options.load(range), 120);

  const whole = () => [0, options.duration()];
  const now = () => range ?? whole();

  function go(to) {
    const [low, high] = whole();
    if (to) {
      const width = Math.min(Math.max(to[1] - to[0], (high - low) * 1e-5), high - low);
      const start = Math.min(Math.max(to[0], low), high - width);
      range = width >= (high - low) * 0.9999 ? null : [start, start + width];
    } else range = null;
    for (const panel of made) panel.range(now());
    load();
  }

  function zoom(factor) {
    const [a, b] = now();
    const [middle, half] = [(a + b) / 2, ((b - a) / 2) * factor];
    go([middle - half, middle + half]);
  }

  function pan(share) {
    const [a, b] = now();
    go([a + share * (b - a), b + share * (b - a)]);
  }

  const knob = (text, label, work) => button(text, work, { class: "small", "aria-label": label, title: label });
  const modes = ["zoom", "exclude"].map((name) =>
    button(name === "zoom" ? _("Drag to zoom") : _("Drag to exclude"), () => setMode(name), { class: "small", "aria-pressed": String(name === mode) }),
  );
  function setMode(name) {
    mode = name;
    modes.forEach((one, i) => one.setAttribute("aria-pressed", String(["zoom", "exclude"][i] === name)));
    for (const panel of made) panel.canvas.dataset.drag = name;
  }

  const legend = h("ul", { class: "legend", "aria-label": _("Marks in the plots") });
  const marks = () => replace(legend, options.spans ? bandsKey(options.spans()) : []);
  const tools = h(
    "div",
    { class: "plot-tools" },
    h("div", { class: "button-row", role: "group", "aria-label": _("What dragging does") }, options.onExclude ? modes : []),
    legend,
    h(
      "div",
      { class: "button-row", role: "group", "aria-label": _("Zoom") },
      knob("+", _("Zoom in"), () => zoom(0.5)),
      knob("−", _("Zoom out"), () => zoom(2)),
      knob("←", _("Earlier"), () => pan(-0.3)),
      knob("→", _("Later"), () => pan(0.3)),
      knob(_("Whole"), _("Whole recording"), () => go(null)),
    ),
  );

  const keys = { "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), ArrowLeft: () => pan(-0.3), ArrowRight: () => pan(0.3), 0: () => go(null) };
  const stack = h(
    "div",
    {
      class: "plots",
      role: "group",
      tabindex: "0",
      "aria-label": `${options.label}. ${_("Arrow keys move, plus and minus zoom, 0 shows all.")}`,
      on: {
        keydown: (event) => {
          if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
          event.preventDefault();
          keys[event.key]();
        },
      },
    },
    made.map((panel) => panel.element),
  );
  const element = h("div", { class: "plots" }, tools, stack);
  onTheme(() => made.forEach((panel) => panel.redraw()));

  return {
    element,
    panels: made,
    go,
    /** The range that is looked at; null for all. */
    range: () => range,
    reload: () => options.load(range),
    redraw: () => {
      marks();
      made.forEach((panel) => panel.redraw());
    },
  };
}
