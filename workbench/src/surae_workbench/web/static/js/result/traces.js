// EMG, angle, torque, its residual and its parts, linked in time.

import { get, query } from "../core/api.js";
import { byId, h, replace } from "../core/dom.js";
import { EMG_SHORT, shownAs } from "../core/format.js";
import { calm, complain } from "../core/notice.js";
import { linked } from "../plot/linked.js";

const PARTS = {
  tissue_tri: ["tissue, triceps", "series-2", 2.4, null],
  tissue_tib: ["tissue, tibialis", "series-2", 1.6, "dash"],
  neural_tri: ["neural, triceps", "series-1", 1.6, null],
  neural_tib: ["neural, tibialis", "series-1", 1.6, "dash"],
  inertial: ["inertial", "series-6", 1.2, "dot"],
  gravitational: ["gravitational", "series-3", 1.8, "dash"],
};

export async function traces(id, { fit }) {
  const names = fit.recordings.map((one) => one.name);
  byId("trace-field").hidden = names.length < 2;
  replace(byId("trace"), names.map((name, i) => h("option", { value: i }, name)));
  byId("trace").addEventListener("change", () => draw(id, byId("trace").value));
  await draw(id, 0);
}

async function draw(id, recording) {
  const box = byId("traces-error");
  const ask = (range) => get(`/api/fits/${id}/traces${query({ recording, start: range?.[0], end: range?.[1], points: 2000 })}`);
  let first;
  try {
    first = await ask(null);
    calm(box);
  } catch (error) {
    complain(box, error);
    return;
  }
  const parts = Object.keys(PARTS).filter((name) => first.parts[name]);
  const largest = Math.max(...first.emg.map((one) => Math.max(...one)), 0);
  const emg = shownAs("V", largest);
  const panels = [
    { title: "Torque", unit: "Nm", height: 210, series: [{ label: "measured", colour: "measured", width: 4 }, { label: "modelled", colour: "modelled", width: 1.6 }] },
    { title: "Residual", unit: "Nm", height: 100, series: [{ label: "measured − modelled", colour: "series-6", width: 1.1 }] },
    { title: "Parts of the modelled torque", unit: "Nm", height: 220, series: parts.map((name) => ({ label: PARTS[name][0], colour: PARTS[name][1], width: PARTS[name][2], dash: PARTS[name][3] })) },
    { title: "Angle, dorsiflexion positive", unit: "°", height: 120, series: [{ label: "angle", colour: "series-1" }] },
    {
      title: "EMG as the model sees it",
      unit: emg.unit,
      height: 150,
      series: EMG_SHORT.map((label, i) => ({ label, colour: ["series-2", "series-1", "series-5", "series-4"][i], dash: [null, null, "dash", "dot"][i], width: 1.5 })),
    },
  ];
  let limits = [first.t[0], first.t[first.t.length - 1]];
  const stack = linked(panels, {
    duration: () => limits[1],
    spans: () => first.excluded.map(([start, end]) => ({ start, end, kind: "excluded" })),
    label: "Torque and its parts",
    load: async (range) => {
      try {
        show(range ? await ask(range) : first, range);
        calm(box);
      } catch (error) {
        complain(box, error);
      }
    },
  });
  function show(seen, range) {
    const to = range ?? limits;
    const degrees = 180 / Math.PI;
    stack.panels[0].show([seen.t, seen.measured, seen.modelled], to);
    stack.panels[1].show([seen.t, seen.residual], to);
    stack.panels[2].show([seen.t, ...parts.map((name) => seen.parts[name])], to);
    stack.panels[3].show([seen.t, seen.angle.map((x) => x * degrees)], to);
    stack.panels[4].show([seen.t, ...seen.emg.map((one) => one.map((x) => x * emg.factor))], to);
  }
  replace(byId("traces"), stack.element);
  show(first, null);
}
