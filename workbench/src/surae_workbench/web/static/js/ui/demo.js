// A recording of a virtual subject, for a first look.

import { post } from "../core/api.js";
import { button } from "../core/dom.js";
import { attempt } from "../core/notice.js";
import { _ } from "../core/words.js";

/** A button that makes such a recording and shows it. */
export function demoButton(box) {
  const knob = button(_("Try it with the virtual subject"), () =>
    attempt(box, async () => (location.href = `/recordings/${(await post("/api/demo")).id}`), knob),
  );
  return knob;
}
