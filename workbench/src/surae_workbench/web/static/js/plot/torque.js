// Measured and modelled torque, one over the other.

import { lines } from "./lines.js";
import { onTheme } from "../core/theme.js";

/** A plot of both; the measured torque is broad and pale, the modelled one thin and dark. */
export function torquePlot() {
  const panel = lines({
    title: "Torque, triceps positive",
    unit: "Nm",
    height: 220,
    series: [
      { label: "measured", colour: "measured", width: 4 },
      { label: "modelled", colour: "modelled", width: 1.6 },
    ],
  });
  onTheme(panel.redraw);
  return {
    element: panel.element,
    show: (t, measured, model) => panel.show([t, measured ?? t.map(() => null), model], null),
  };
}
