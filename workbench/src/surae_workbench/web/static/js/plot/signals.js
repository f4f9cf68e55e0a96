// A recording's EMG, angle and torque: windows are fetched as they are looked at.

import { EMG, EMG_SHORT, roleText, shownAs } from "../core/format.js";
import { linked } from "./linked.js";
import { _ } from "../core/words.js";

/**
 * Linked plots of a recording; two million samples stay smooth because only what is seen is fetched.
 *
 * @param options {duration, spans, onExclude, label, roles, fetch(range, signal), failed, done}
 */
export function signalPlots(options) {
  const emg = EMG.filter((role) => options.roles.includes(role));
  const panels = [
    ...emg.map((role, i) => ({ role, title: `EMG ${EMG_SHORT[EMG.indexOf(role)]}`, series: [{ label: role, colour: `series-${i === 0 ? 2 : 1}` }], height: 92 })),
    ...["angle", "torque"].filter((role) => options.roles.includes(role)).map((role) => ({
      role,
      title: role === "angle" ? _("Angle, dorsiflexion positive") : _("Torque, triceps positive"),
      series: [{ label: roleText(role), colour: "series-1" }],
      height: role === "torque" ? 180 : 140,
    })),
  ];
  let pending = null;

  const stack = linked(panels, {
    ...options,
    load: async (range) => {
      pending?.abort();
      pending = new AbortController();
      try {
        const window = await options.fetch(range, pending.signal);
        options.done();
        draw(window, range);
      } catch (error) {
        if (error.name !== "AbortError") options.failed(error);
      }
    },
  });

  function draw(window, range) {
    panels.forEach((panel, i) => {
      const found = window.signals.find((one) => one.role === panel.role);
      if (!found?.t.length) return;
      const shown = shownAs(found.unit);
      stack.panels[i].unit(shown.unit);
      stack.panels[i].show([found.t, found.v.map((y) => y * shown.factor)], range ?? [0, options.duration()]);
    });
  }
  return stack;
}
