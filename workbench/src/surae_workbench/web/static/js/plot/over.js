// Torque over angle: a small picture in which a turned sign is seen at once.

import { s } from "../core/dom.js";
import { number } from "../core/format.js";
import { _ } from "../core/words.js";

const WIDTH = 260;
const HEIGHT = 170;
const LEFT = 56;
const BOTTOM = 34;

/** Torque [Nm] over angle [°], with both axes through zero; dorsiflexion to the right, the calf's pull up. */
export function over({ angle, torque }, label) {
  const [low, high] = ends(angle);
  const [least, most] = ends(torque);
  const x = (value) => LEFT + ((value - low) / (high - low)) * (WIDTH - LEFT - 6);
  const y = (value) => HEIGHT - BOTTOM - ((value - least) / (most - least)) * (HEIGHT - BOTTOM - 6);
  const path = angle.map((at, i) => `${i ? "L" : "M"}${x(at).toFixed(1)} ${y(torque[i]).toFixed(1)}`).join("");
  const text = (value, at, props) => s("text", { class: "quiet", ...at, ...props }, value);
  return s(
    "svg",
    { class: "chart over", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": label },
    s("path", { class: "axis", d: `M${LEFT} ${y(0).toFixed(1)}H${WIDTH - 6}M${x(0).toFixed(1)} 6V${HEIGHT - BOTTOM}` }),
    s("path", { class: "line", d: path }),
    text(`${number(most, 2)} Nm`, { x: LEFT - 4, y: 15 }, { "text-anchor": "end" }),
    text(number(least, 2), { x: LEFT - 4, y: HEIGHT - BOTTOM }, { "text-anchor": "end" }),
    text(`${number(low, 2)}°`, { x: LEFT, y: HEIGHT - BOTTOM + 14 }, {}),
    text(`${number(high, 2)}°`, { x: WIDTH - 6, y: HEIGHT - BOTTOM + 14 }, { "text-anchor": "end" }),
    text(_("toes down"), { x: LEFT, y: HEIGHT - 5 }, {}),
    text(_("toes up"), { x: WIDTH - 6, y: HEIGHT - 5 }, { "text-anchor": "end" }),
  );
}

/** Least and greatest, zero among them, and never the same. */
function ends(values) {
  const low = Math.min(0, ...values);
  const high = Math.max(0, ...values);
  return high > low ? [low, high] : [low - 1, high + 1];
}
