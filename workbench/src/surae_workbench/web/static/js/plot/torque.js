// Measured and modelled torque, one over the other.

import { lines } from "./lines.js";
import { onTheme } from "../core/theme.js";
import { _ } from "../core/words.js";

/** A plot of both; the measured torque is broad and pale, the modelled one thin and dark. */
export function torquePlot() {
  const panel = lines({
    title: _("Torque, triceps positive"),
    unit: "Nm",
    height: 220,
    series: [
      { label: _("measured"), colour: "measured", width: 4 },
      { label: _("modelled"), colour: "modelled", width: 1.6 },
    ],
  });
  onTheme(panel.redraw);
  return {
    element: panel.element,
    show: (t, measured, model) => panel.show([t, measured ?? t.map(() => null), model], null),
  };
}
