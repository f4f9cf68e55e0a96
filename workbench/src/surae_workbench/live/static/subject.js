// The subject's page: the effort asked for against one's own, and a countdown. No numbers of anybody.

import { get } from "../js/core/api.js";
import { at, listen, surface } from "./stream.js";
import { _ } from "../js/core/words.js";

const AHEAD = 4;
const BEHIND = 4;
let state = null;
let own = [];

// Up is pulling the foot up (tibialis), down is pushing it down (the three heads together).
const both = ([ta, gl, sol, gm]) => ta - (gl + sol + gm) / 3;

function words(now) {
  if (!state || state.running === null || state.begin === null) return _("Relax");
  const t = now - state.begin;
  if (t < 0) return _("Ready … {n}", { n: Math.ceil(-t) });
  const target = state.curve ? at(state.curve, (i) => both(state.curve.effort[i]), t + 0.2) : null;
  if (target === null) return _("Well done. Relax");
  if (target > 0.05) return _("Pull up");
  if (target < -0.05) return _("Push down");
  return _("Relax");
}

function draw() {
  requestAnimationFrame(draw);
  const { context: c, width, height, colour } = surface(document.getElementById("effort"));
  const now = own.at(-1)?.t ?? 0;
  const x = (t) => width * 0.5 + ((t - now) / AHEAD) * width * 0.5;
  const y = (v) => height * 0.5 - v * height * 0.46;
  c.strokeStyle = colour("line");
  c.lineWidth = 2;
  c.beginPath();
  c.moveTo(0, y(0));
  c.lineTo(width, y(0));
  c.stroke();
  c.lineJoin = "round";
  c.lineCap = "round";
  if (state?.curve && state.begin !== null) {
    c.strokeStyle = colour("measured");
    c.lineWidth = Math.max(14, height / 22);
    c.beginPath();
    for (let i = 0; i <= 200; i += 1) {
      const t = now - BEHIND + (i / 200) * (AHEAD + BEHIND);
      const target = at(state.curve, (k) => both(state.curve.effort[k]), t - state.begin) ?? 0;
      c.lineTo(x(t), y(target));
    }
    c.stroke();
  }
  c.strokeStyle = colour("accent");
  c.lineWidth = Math.max(5, height / 70);
  c.beginPath();
  for (const { t, effort } of own) c.lineTo(x(t), y(both(effort)));
  c.stroke();
  const last = own.at(-1);
  if (last) {
    c.fillStyle = colour("accent");
    c.beginPath();
    c.arc(x(last.t), y(both(last.effort)), Math.max(10, height / 36), 0, 2 * Math.PI);
    c.fill();
  }
  const say = document.getElementById("say");
  const text = words(now);
  if (say.textContent !== text) say.textContent = text;
}

const refresh = async () => {
  state = await get("/api/subject");
};

refresh().then(() => {
  listen("/api/subject/events", {
    open: refresh,
    effort: (report) => {
      own.push(report);
      while (own.length && own[0].t < report.t - BEHIND - 1) own.shift();
    },
  });
  setInterval(() => refresh().catch(() => null), 500);
  requestAnimationFrame(draw);
});
