// A recording of a virtual subject, for a first look.

import { get, post } from "../core/api.js";
import { button } from "../core/dom.js";
import { attempt } from "../core/notice.js";

/** A button that is seen where the server has such a recording. */
export function demoButton(box) {
  const knob = button(
    "Try it with the virtual subject",
    () =>
      attempt(
        box,
        async () => {
          const recording = await post("/api/demo");
          location.href = `/recordings/${recording.id}`;
        },
        knob,
      ),
    { hidden: true },
  );
  get("/api/openapi.json")
    .then((known) => {
      knob.hidden = !known.paths["/api/demo"];
    })
    .catch(() => null);
  return knob;
}
