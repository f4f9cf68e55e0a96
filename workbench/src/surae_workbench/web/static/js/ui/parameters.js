// The table of parameters: slider, free or fixed, start, bounds, prior.

import { h, table } from "../core/dom.js";
import { number, quantity, unitText } from "../core/format.js";
import { _ } from "../core/words.js";

const STEPS = 1000;
/** Bounds from zero far beyond the start: the lower end of the slider gets more room. */
const POWER = 3;
const GROUPS = { limb: _("Limb"), passive: _("Passive tissue"), active: _("Muscles and EMG"), tendon: _("Tendons"), reflex: _("Reflexes") };

/** Where on its slider a value is, 0 … STEPS: logarithmic where the bounds span a decade. */
function scaleOf({ lower, upper, default: usual }) {
  if (lower === 0 && usual.value < 0.15 * upper) {
    return {
      at: (value) => Math.round(STEPS * (Math.max(value, 0) / upper) ** (1 / POWER)),
      value: (at) => Number((upper * (at / STEPS) ** POWER).toPrecision(6)),
    };
  }
  const log = lower > 0 && upper / lower > 12;
  const [a, b] = log ? [Math.log(lower), Math.log(upper)] : [lower, upper];
  return {
    at: (value) => Math.round((STEPS * ((log ? Math.log(Math.max(value, lower)) : value) - a)) / (b - a || 1)),
    value: (at) => {
      const x = a + ((b - a) * at) / STEPS;
      return Number((log ? Math.exp(x) : x).toPrecision(6));
    },
  };
}

/**
 * The table.
 *
 * @param on {slide(name, value), settle(name, value), set(name, changes|null, label)}
 */
export function parameterTable(on) {
  const head = [_("Parameter"), _("Slider"), _("Free"), _("Start or value"), _("Lower"), _("Upper"), _("Prior median"), _("Prior spread")];
  const element = table(_("Parameters"), head, [], { class: "parameters", caption: _("The sliders show what the torque would be; the fit begins at the start values. The spread of a prior is that of its logarithm, or of the value where it may be negative.") });
  const body = element.querySelector("tbody");
  let rows = new Map();
  let locked = false;
  let shape = "";

  function build(parameters) {
    rows = new Map();
    const parts = [];
    let group = null;
    for (const p of parameters) {
      if (p.group !== group) {
        group = p.group;
        parts.push(h("tr", { class: "group" }, h("th", { colspan: head.length, scope: "colgroup" }, GROUPS[group] ?? group)));
      }
      const row = makeRow(p, on);
      rows.set(p.name, row);
      parts.push(row.element);
    }
    body.replaceChildren(...parts);
  }

  return {
    element,
    update(parameters) {
      const now = parameters.map((p) => p.name).join();
      if (now !== shape) build(parameters);
      shape = now;
      for (const p of parameters) rows.get(p.name).update(p);
      if (locked) this.lock(true);
    },
    /** Sliders follow a fit. */
    move(values) {
      for (const [name, value] of Object.entries(values)) rows.get(name)?.move(value);
    },
    lock(on_) {
      locked = on_;
      for (const row of rows.values()) row.lock(on_);
    },
  };
}

/** A number as an input takes it, short. */
function plain(x) {
  if (x === null || x === undefined) return "";
  const short = Number(x.toPrecision(7));
  return Math.abs(short) >= 1e5 ? short.toExponential().replace("e+", "e") : String(short);
}

function makeRow(first, on) {
  let p = first;
  let scale = scaleOf(p);
  let dragging = false;
  const { name } = p;

  const slider = h("input", { type: "range", min: 0, max: STEPS, step: 1, "aria-label": _("Slider of {name}", { name }) });
  const readout = h("span", { class: "num small" });
  const free = h("input", { type: "checkbox", "aria-label": _("{name} is free", { name }) });
  const box = (label) => h("input", { type: "number", step: "any", "aria-label": _("{label} of {role}", { label, role: name }) });
  const [value, lower, upper, median, spread] = [_("Value"), _("Lower bound"), _("Upper bound"), _("Prior median"), _("Prior spread")].map(box);
  const element = h(
    "tr",
    {},
    h("th", { scope: "row" }, h("span", { class: "name" }, h("span", {}, name, unitText(p.unit) && h("small", {}, ` [${unitText(p.unit)}]`)), h("small", {}, _(p.meaning)))),
    h("td", { class: "slide" }, h("div", {}, slider, readout)),
    h("td", {}, free),
    h("td", {}, value),
    h("td", {}, lower),
    h("td", {}, upper),
    h("td", { class: "prior" }, median),
    h("td", { class: "prior" }, spread),
  );

  function showSlider(at) {
    slider.value = scale.at(at);
    readout.textContent = quantity(at, p.unit, 3);
    slider.setAttribute("aria-valuetext", quantity(at, p.unit, 3));
  }

  slider.addEventListener("input", () => {
    dragging = true;
    const now = scale.value(Number(slider.value));
    readout.textContent = quantity(now, p.unit, 3);
    slider.setAttribute("aria-valuetext", readout.textContent);
    on.slide(name, now);
  });
  slider.addEventListener("change", () => {
    dragging = false;
    on.settle(name, scale.value(Number(slider.value)));
  });

  /** Only what differs from the default is sent. */
  function differing(changes) {
    const now = { free: p.free, value: p.value, lower: p.lower, upper: p.upper, prior: p.prior, ...changes };
    const made = {};
    for (const key of ["free", "value", "lower", "upper"]) if (now[key] !== p.default[key]) made[key] = now[key];
    if (made.lower !== undefined || made.upper !== undefined) Object.assign(made, { lower: now.lower, upper: now.upper });
    if (now.prior && (changes.prior !== undefined || p.own)) made.prior = now.prior;
    if (Object.keys(made).length) made.free = now.free; // which a recording may prescribe
    return Object.keys(made).length || p.optional ? made : null; // an optional one is there while it is mentioned
  }
  const numeric = (input, fallback) => (input.value.trim() === "" ? fallback : Number(input.value));
  free.addEventListener("change", () => on.set(name, differing({ free: free.checked }), free.checked ? _("free {name}", { name }) : _("fix {name}", { name })));
  value.addEventListener("change", () => on.set(name, differing({ value: numeric(value, p.default.value) }), `${name} = ${value.value || _("default")}`));
  lower.addEventListener("change", () => on.set(name, differing({ lower: numeric(lower, p.default.lower) }), _("lower bound of {name}", { name })));
  upper.addEventListener("change", () => on.set(name, differing({ upper: numeric(upper, p.default.upper) }), _("upper bound of {name}", { name })));
  function prior() {
    const both = median.value !== "" && spread.value !== "";
    if (!both && median.value + spread.value !== "") return; // half given: wait for the other
    on.set(name, differing({ prior: both ? { median: Number(median.value), spread: Number(spread.value) } : null }), both ? _("prior of {name}", { name }) : _("no prior of {name}", { name }));
  }
  median.addEventListener("change", prior);
  spread.addEventListener("change", prior);

  return {
    element,
    update(next) {
      p = next;
      p.own = p.prior !== null;
      scale = scaleOf(p);
      element.classList.toggle("fixed-row", !p.free);
      free.checked = p.free;
      const put = (input, x) => document.activeElement === input || (input.value = plain(x));
      put(value, p.value);
      put(lower, p.lower);
      put(upper, p.upper);
      put(median, p.prior?.median);
      put(spread, p.prior?.spread);
      value.title = p.prescribed === null ? _("default {value}", { value: number(p.default.value) }) : _("the recording prescribes {value}", { value: number(p.prescribed) });
      for (const input of [lower, upper, median, spread]) input.disabled = !p.free;
      if (!dragging) showSlider(p.slider);
    },
    move: showSlider,
    lock(locked) {
      slider.disabled = locked;
    },
  };
}
