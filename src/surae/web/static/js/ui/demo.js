// A recording of a virtual subject, for a first look.

import { post } from "../core/api.js";
import { button } from "../core/dom.js";
import { attempt } from "../core/notice.js";

/** A button that makes such a recording and shows it. */
export function demoButton(box) {
  const knob = button("Try it with the virtual subject", () =>
    attempt(
      box,
      async () => {
        const recording = await post("/api/demo");
        location.href = `/recordings/${recording.id}`;
      },
      knob,
    ),
  );
  return knob;
}
