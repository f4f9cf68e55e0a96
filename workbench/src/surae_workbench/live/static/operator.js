// The operator's page: streams, traces, trials and what to do next.

import { get, post } from "../js/core/api.js";
import { button, byId, h, num, replace, table } from "../js/core/dom.js";
import { minus, number, r2, unitText, verdictText } from "../js/core/format.js";
import { _, chooseLanguage, decimal, language, many, said } from "../js/core/words.js";
import { showChannels } from "./channels.js";
import { at, listen, surface } from "./stream.js";

const act = (name, body) => post(`/api/live/${name}`, body);
const SECONDS = 12;
const MUSCLES = [["emg_ta", _("tibialis")], ["emg_gl", _("gastroc. lat.")], ["emg_sol", _("soleus")], ["emg_gm", _("gastroc. med.")]];
const ROWS = [
  ["angle", _("Angle [°]"), 57.29578, "series-1"],
  ["torque", _("Torque [Nm]"), 1, "series-2"],
  ...MUSCLES.map(([role, name], i) => [role, `${name} [mV]`, 1000, `series-${(i % 4) + 3}`]),
];
const named = (channel) => ROWS.find(([role]) => role === channel)?.[1].replace(/ \[.*/, "") ?? channel;
const WORDS = { keep: _("Keep"), look: _("Look at it"), repeat: _("Repeat") };
const SIGNS = { keep: "✓", look: "!", repeat: "↻" };

let state = null;
let frames = [];
let late = null;
let sound = true;
window.suraeLatency = [];

// --- traces ---------------------------------------------------------------------------------

function draw() {
  requestAnimationFrame(draw);
  if (!state) return;
  const { context: c, width, height, colour } = surface(byId("traces"));
  const now = frames.at(-1)?.t ?? state.now;
  const end = now + (state.begin !== null && state.curve ? 2 : 0);
  const left = 150;
  const x = (t) => left + ((t - end + SECONDS) / SECONDS) * (width - left - 8);
  const shown = ROWS.filter(([role]) => state.roles.includes(role));
  const row = height / Math.max(shown.length, 1);
  c.font = "12px system-ui, sans-serif";
  shown.forEach(([role, name, factor, series], index) => {
    const top = index * row + 6;
    const bottom = (index + 1) * row - 6;
    const seen = frames.filter((frame) => frame.new[role]);
    const target = role === "angle" && state.curve;
    let low = Infinity;
    let high = -Infinity;
    for (const frame of seen) {
      low = Math.min(low, frame.new[role][0]);
      high = Math.max(high, frame.new[role][1]);
    }
    if (target) {
      low = Math.min(low, ...state.curve.angle);
      high = Math.max(high, ...state.curve.angle);
    }
    if (role.startsWith("emg_")) {
      high = Math.max(Math.abs(low), Math.abs(high), 5e-5);
      low = -high;
    }
    if (!(high > low)) [low, high] = role === "angle" ? [low - 0.1, low + 0.1] : [low - 1, low + 1];
    if (!Number.isFinite(low)) [low, high] = [-1, 1];
    const y = (v) => bottom - ((v - low) / (high - low)) * (bottom - top);
    c.fillStyle = colour("muted");
    c.fillText(name, 0, (top + bottom) / 2 + 4);
    c.textAlign = "right";
    const least = 1e-3 * (high - low);
    const tick = (v) => (Math.abs(v) < least ? "0" : decimal(String(Number((v * factor).toPrecision(2))).replace("-", "−")));
    if (seen.length || target) {
      c.fillText(tick(high), left - 6, top + 9);
      c.fillText(tick(low), left - 6, bottom);
    }
    c.textAlign = "left";
    c.strokeStyle = colour("grid");
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(left, bottom + 5.5);
    c.lineTo(width, bottom + 5.5);
    c.stroke();
    if (target) {
      c.strokeStyle = colour("measured");
      c.lineWidth = 5;
      c.beginPath();
      const first = end - SECONDS;
      for (let i = 0; i <= 240; i += 1) {
        const t = first + (i / 240) * SECONDS;
        const own = state.begin === null ? null : at(state.curve, (k) => state.curve.angle[k], t - state.begin);
        const value = own ?? (state.begin !== null && t > state.begin ? state.curve.angle.at(-1) : state.curve.angle[0]);
        c.lineTo(x(t), y(value));
      }
      c.stroke();
    }
    // A band from the lowest to the highest of each frame: nothing between two frames is hidden.
    c.fillStyle = c.strokeStyle = colour(series);
    c.lineWidth = 1.2;
    for (const piece of unbroken(seen.filter((frame) => x(frame.t) >= left))) {
      c.beginPath();
      for (const frame of piece) c.lineTo(x(frame.t), y(frame.new[role][1]));
      for (const frame of piece.reverse()) c.lineTo(x(frame.t), y(frame.new[role][0]));
      c.closePath();
      c.fill();
      c.stroke();
    }
  });
  if (end > now) {
    c.strokeStyle = colour("accent");
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(x(now), 0);
    c.lineTo(x(now), height);
    c.stroke();
  }
  showClock(now);
  if (late !== null) {
    window.suraeLatency.push(Date.now() - late);
    if (window.suraeLatency.length > 20000) window.suraeLatency.shift();
    late = null;
  }
}

/** Frames in pieces between which nothing came. */
function unbroken(seen) {
  const pieces = [];
  seen.forEach((frame, i) => {
    if (i === 0 || frame.t - seen[i - 1].t > 0.4) pieces.push([]);
    pieces.at(-1).push(frame);
  });
  return pieces;
}

function showClock(now) {
  let text = state.ready ? (state.mapped ? _("Ready") : _("Which channel is which?")) : _("Getting ready …");
  if (state.running !== null) {
    const own = state.begin === null ? null : now - state.begin;
    const { seconds } = state.asked;
    if (own === null) text = _("Trial {n}", { n: state.running });
    else if (own < 0) text = _("Trial {n} in {s} s", { n: state.running, s: Math.ceil(-own) });
    else text = _("Trial {n} · {now} of {whole} s", { n: state.running, now: Math.min(own, seconds).toFixed(0), whole: seconds.toFixed(0) });
  }
  const place = byId("clock");
  if (place.textContent !== text) place.textContent = text;
}

function heardFrame(frame) {
  frames.push(frame);
  if (frame.taken !== null) late = frame.taken;
  const oldest = frame.t - SECONDS - 1;
  while (frames.length && frames[0].t < oldest) frames.shift();
  frame.effort.forEach((effort, i) => {
    const meter = byId(`effort-${i}`);
    if (!meter) return;
    meter.value = effort;
    byId(`effort-${i}-said`).textContent = `${Math.round(100 * effort)} %`;
  });
}

// --- reports --------------------------------------------------------------------------------

function showStreams() {
  const report = { changed: ["look", _("changed")], silent: ["look", _("silent")], lost: ["repeat", _("lost")] };
  const missing = [!state.streams.length && _("None yet: start the programs that send streams of LSL.")].filter(Boolean);
  replace(
    byId("streams"),
    state.streams.map((stream) => {
      const [kind, word] = report[stream.state === "good" && stream.remark ? "changed" : stream.state] ?? use(stream);
      const rate = stream.measured_hz === null ? "" : _("{now} of {whole} Hz", { now: stream.measured_hz.toFixed(0), whole: stream.rate_hz.toFixed(0) });
      const clock = stream.offset_ms === null ? "" : ", " + _("clock {ms} ms", { ms: number(Math.round(10 * stream.offset_ms) / 10, 2) });
      const wrong = [
        stream.gaps ? many("{n} gap", "{n} gaps", stream.gaps) : "",
        stream.losses ? many("lost {n} time", "lost {n} times", stream.losses) : "",
        stream.lost_s ? _("{s} s missing", { s: number(stream.lost_s, 2) }) : "",
        stream.not_finite ? many("{n} value is no number", "{n} values are no numbers", stream.not_finite) : "",
        stream.bad_stamps ? many("{n} time stamp is no number", "{n} time stamps are no numbers", stream.bad_stamps) : "",
        stream.remark && _("came back as another stream"),
      ].filter(Boolean).join(", ");
      return h("li", {}, h("strong", {}, stream.name), h("span", { class: `pill ${kind}` }, word),
        h("span", { class: "muted small" }, `${stream.channels.map(named).join(", ")}: ${rate}${clock}${wrong ? `; ${wrong}` : ""}`));
    }),
    missing.map((text) => h("li", { class: "muted" }, text)),
  );
  const box = byId("error");
  if (state.trouble) {
    box.textContent = said(state.trouble_said);
    box.hidden = false;
    box.dataset.disk = "yes";
  } else if (box.dataset.disk) {
    box.hidden = true;
    delete box.dataset.disk;
  }
}

/** The choice of channels: anew where the streams, or what they are used for, are others. */
function offerChannels() {
  const key = JSON.stringify([state.mapped, state.streams.map((stream) => [stream.name, stream.channels, stream.roles])]);
  if (byId("channels").dataset.key === key) return;
  byId("channels").dataset.key = key;
  tried(() => showChannels(state, refresh, tried));
}

/** What a stream that sends is good for: it is good once it has signals, and a trial of them was judged. */
function use(stream) {
  if (!state.mapped) return ["wait", _("sends")];
  if (!stream.roles.length) return ["wait", _("not used")];
  if (stream.bad !== null) return ["look", _("see trial {n}", { n: stream.bad })];
  return stream.judged ? ["keep", _("good")] : ["wait", _("not judged yet")];
}

/** What goes wrong now: seen as long as it lasts, heard once. */
function showAlarms() {
  const place = byId("alarms");
  const texts = (state.alarms ?? []).map(said);
  if (place.dataset.said !== JSON.stringify(texts)) {
    place.dataset.said = JSON.stringify(texts);
    replace(place, texts.map((text) => h("li", {}, text)));
  }
  place.hidden = !texts.length;
}

function heardAlarm(alarm) {
  if (!state.alarms.some((one) => one.text === alarm.text)) state.alarms.push(alarm);
  showAlarms();
  beep("alarm");
}

/** What was said in the reader's language, else in English. */
const own = (what) => ({ ...what, ...what.translated?.[language] });

function pill(trial) {
  if (trial.state === "judged") return h("span", { class: `pill ${trial.verdict}` }, `${SIGNS[trial.verdict]} ${WORDS[trial.verdict]}`);
  return h("span", { class: "pill wait" }, _(trial.state));
}

function showTrials() {
  const items = [...state.trials].reverse().map((trial) => {
    const numbers = trial.grade ? `${_(trial.grade)}, VAF ${r2(trial.vaf)}` : !trial.translated?.[language] && _(trial.why);
    const about = [_(trial.protocol), numbers, trial.note].filter(Boolean).join(" · ");
    return h("li", {}, h("strong", {}, _("Trial {n}", { n: trial.trial })), pill(trial), h("span", { class: "muted small" }, about),
      own(trial).advice ? h("span", { class: "muted small" }, own(trial).advice) : null,
      own(trial).leg.map((sentence) => h("span", { class: "small" }, sentence)),
      trial.alarms.map((alarm) => h("span", { class: "muted small" },
        alarm.at === null ? said(alarm) : _("At {s} s:", { s: alarm.at.toFixed(0) }) + " " + said(alarm))));
  });
  replace(byId("trials"), items.length ? items : h("li", { class: "muted" }, _("None yet.")));
  byId("repeat").disabled = !state.trials.length || state.running !== null;
}

function showVerdict(trial) {
  const place = byId("verdict");
  place.className = `verdict ${trial.verdict}`;
  replace(
    place,
    h("strong", {}, `${SIGNS[trial.verdict]} ${_("Trial {n}", { n: trial.trial })}: ${WORDS[trial.verdict]}`),
    h("span", {}, own(trial).advice || _("Nothing was found against it.")),
    own(trial).leg.map((sentence) => h("span", {}, sentence)),
  );
  place.hidden = false;
  beep(trial.verdict);
}

const together = (trials) => (trials.length > 1 ? _("Trials {list} together", { list: trials.join(", ") }) : _("Trial {n} alone", { n: trials[0] }));

function showSession() {
  const { session } = state;
  const place = byId("session");
  const failed = session.state === "failed" && session.parameters && h("p", { class: "alert" }, _("{trials}: the fit failed ({why}). This is the one before.", { trials: together(session.fitting), why: session.why }));
  const busy = session.state === "fitting" && h("p", { class: "muted" }, _("{trials}: being fitted; it takes a minute.", { trials: together(session.fitting) }));
  if (!session.parameters) {
    const text = session.state === "failed" ? session.why : _("After the first good trial: all trials fitted together, and what to measure next.");
    replace(place, busy || h("p", { class: "muted" }, text));
    return;
  }
  replace(place, failed, busy,
    h("p", {}, `${together(session.trials)}: ${_(session.grade)}, VAF ${r2(session.vaf)}. ${own(session).reasons.join("; ")}`),
    (own(session).leg ?? []).map((sentence) => h("p", {}, sentence)),
    h("div", { class: "next" }, own(session).next.map((sentence) => h("p", {}, sentence)),
      session.proposed && button([_("Load {movement}", { movement: session.proposed }), " ", h("kbd", {}, "N")], next, { id: "next", "aria-keyshortcuts": "N" })),
    h("details", {}, h("summary", {}, _("All measures and parameters")),
      h("div", {}, (own(session).gains ?? session.next).map((sentence) => h("p", { class: "small" }, sentence))),
      estimates(_("Measures"), session.measures, session.before),
      estimates(_("Parameters"), session.parameters.filter((p) => p.verdict !== "fixed"), session.before)));
}

/** A table of estimates: now, and after the trials before. */
function estimates(title, rows, before) {
  const kinds = { identified: "keep", weak: "look" };
  return table(title, [title, _("Value"), _("95 % interval"), _("Before"), _("Verdict")], rows.map((one) => [
    h("span", { title: one.meaning ?? null }, one.name.replaceAll("_", " ")),
    num(`${number(one.value, 3)} ${unitText(one.unit)}`),
    num(one.ci95 && one.verdict !== "undetermined" ? `${number(one.ci95[0], 3)} … ${number(one.ci95[1], 3)}` : _("none")),
    num(number(before[one.name], 3)),
    h("span", { class: `pill ${kinds[one.verdict] ?? "repeat"}` }, verdictText(one.verdict)),
  ]), { caption: null, numbers: [1, 3] });
}

function showAsked() {
  byId("asked").textContent = state.asked.protocol
    ? `${_(state.asked.protocol)}, ${state.asked.seconds.toFixed(0)} s`
    : _("Nothing is loaded: a trial records what comes, until it is stopped.");
  const moves = { ...state.moves, low: minus(state.moves.low), high: minus(state.moves.high) };
  const device = byId("device");
  if (!device.options.length) {
    replace(device, h("option", { value: "" }, _("none known")), [...new Set([...moves.devices, moves.device].filter(Boolean))].map((name) => h("option", { value: name }, name)));
    device.disabled = state.rehearsal;
  }
  if (document.activeElement !== device) device.value = moves.device ?? "";
  const what = moves.device ? _("{device}, from {low}° to {high}°", moves) : _("No device is chosen: movements go from {low}° to {high}°, and no limit of a device is watched.", moves);
  replace(byId("moves"), h("p", {}, what), state.limits.map((limit) => {
    const text = said(limit);
    return h("p", { class: limit.exceeded ? "alert" : null }, text[0].toUpperCase() + text.slice(1));
  }));
  const running = state.running !== null;
  replace(byId("start"), `${running ? _("Stop") : _("Start")} `, h("kbd", {}, _("Space")));
  byId("start").className = running ? "danger" : "primary";
  byId("start").disabled = !running && !state.ready;
  byId("mark").disabled = !running;
}

function showAll() {
  byId("where").textContent = [state.rehearsal && _("Rehearsal, a virtual leg"), state.folder].filter(Boolean).join(" · ");
  byId("faults").hidden = !state.rehearsal;
  showAlarms();
  showStreams();
  offerChannels();
  showTrials();
  showSession();
  showAsked();
}

// --- sound ----------------------------------------------------------------------------------

let audio = null;
function beep(verdict) {
  if (!sound) return;
  const tones = { keep: [660, 880], look: [660, 660], repeat: [330, 220, 330], alarm: [880, 440, 880, 440] }[verdict];
  try {
    audio ??= new AudioContext();
    tones.forEach((frequency, i) => {
      const tone = audio.createOscillator();
      const gain = audio.createGain();
      gain.gain.value = 0.08;
      tone.frequency.value = frequency;
      tone.connect(gain).connect(audio.destination);
      tone.start(audio.currentTime + 0.2 * i);
      tone.stop(audio.currentTime + 0.2 * i + 0.16);
    });
  } catch {
    // No sound here: the colour and the words remain.
  }
}

// --- what is done ---------------------------------------------------------------------------

async function tried(work) {
  const box = byId("error");
  try {
    await work();
    if (!box.dataset.disk) box.hidden = true;
  } catch (error) {
    box.textContent = error.message;
    box.hidden = false;
  }
}

let asked = 0;
/** Ask how all stands; of several answers, the one that was asked for last counts. */
const refresh = async () => {
  const own = ++asked;
  const report = await get("/api/live");
  if (own !== asked) return;
  state = report;
  showAll();
};
const startStop = () => tried(async () => {
  await act(state.running === null ? "start" : "stop");
  await refresh();
});
const mark = () => tried(() => act("mark"));
const again = () => tried(async () => {
  if (state.running === null && state.trials.length) {
    await act("start");
    await refresh();
  }
});
const next = () => tried(async () => {
  await act("next");
  await refresh();
});

byId("start").addEventListener("click", startStop);
byId("mark").addEventListener("click", mark);
byId("repeat").addEventListener("click", again);
byId("forget").addEventListener("click", () => tried(() => act("forget")));
chooseLanguage(byId("language"));
byId("sound").addEventListener("click", () => {
  sound = !sound;
  byId("sound").textContent = sound ? _("Sound on") : _("Sound off");
  byId("sound").setAttribute("aria-pressed", String(sound));
});
byId("protocol").addEventListener("submit", (event) => {
  event.preventDefault();
  tried(async () => {
    replace(byId("told"));
    await act("load", { profile: byId("profile").value, task: byId("task").value,
      seconds: Number(byId("seconds").value), chirp_amplitude: Number(byId("chirp").value) });
    await refresh();
  });
});
/** What a movement is good for; a designed one brings its effort and its length along. */
function showMovement() {
  const chosen = state.profiles.find((one) => one.name === byId("profile").value);
  byId("movement").textContent = _(chosen?.description);
  for (const id of ["task", "seconds", "chirp"]) byId(id).disabled = Boolean(chosen?.designed) || chosen?.name === "maximum";
}
byId("profile").addEventListener("change", showMovement);
byId("device").addEventListener("change", () => tried(async () => {
  await act("device", { name: byId("device").value });
  await refresh();
}));
byId("tells").addEventListener("click", () => tried(async () => {
  replace(byId("told"), h("p", { class: "muted" }, _("Being computed; it takes a minute.")));
  const { tells } = await act("tells");
  replace(byId("told"), tells.map((text) => h("p", { class: "small" }, text)));
}));
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
  if (event.target.closest("input, select, textarea")) return;
  const work = { " ": startStop, m: mark, r: again, n: next }[event.key.toLowerCase()];
  if (!work) return;
  event.preventDefault();
  if (event.target instanceof HTMLButtonElement) event.target.blur();
  work();
});

replace(byId("efforts"), MUSCLES.map(([, name], i) =>
  h("label", {}, h("span", {}, `${name} `, h("span", { id: `effort-${i}-said` }, "0 %")), h("meter", { id: `effort-${i}`, min: 0, max: 1, value: 0 }))));
replace(byId("fault-buttons"), [["electrode-off", _("electrode off")], ["hum", _("hum")], ["torque-sign", _("torque turned")], ["dropout", _("dropout")], ["none", _("mend all")]]
  .map(([kind, text]) => button(text, () => tried(() => act("fault", { kind })), { class: "small" })));

tried(async () => {
  await refresh();
  const option = (name, first) => h("option", { value: name, selected: name === first }, _(name));
  const group = (label, ones) => h("optgroup", { label }, ones.map(({ name }) => option(name, "everything-35")));
  replace(byId("profile"), group(_("Designed"), state.profiles.filter((one) => one.designed)), group(_("Others"), state.profiles.filter((one) => !one.designed)));
  replace(byId("task"), state.tasks.map((name) => option(name, "active")));
  showMovement();
  listen("/api/live/events", {
    open: () => tried(refresh),
    error: () => {
      byId("error").textContent = _("surae does not answer: what is shown is old, and nothing may be recorded. Look at where it was started, and load this page again when it runs.");
      byId("error").hidden = false;
      byId("error").dataset.disk = "";
    },
    frame: heardFrame,
    health: (report) => {
      Object.assign(state, report);
      showAlarms();
      showStreams();
      offerChannels();
      showAsked();
    },
    trial: (trial) => {
      state.trials = [...state.trials.filter((one) => one.trial !== trial.trial), trial].sort((a, b) => a.trial - b.trial);
      showTrials();
      if (trial.state === "judged") showVerdict(trial);
      refresh();
    },
    protocol: refresh,
    alarm: heardAlarm,
    session: (session) => {
      state.session = session;
      showSession();
    },
  });
  requestAnimationFrame(draw);
});
