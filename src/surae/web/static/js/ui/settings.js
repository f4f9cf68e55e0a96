// Model, priors, loss and the rest of what a fit may be told.

import { field, h, replace, select } from "../core/dom.js";

/** Optional drives of the muscles, by their names in the API. */
const DRIVES = { emd: "Estimate an EMG delay", reflex: "Estimate a stretch reflex" };
const NO_MASS = { body_mass: null, footplate_mass: 0, foot_share: "winter" };
const LOSSES = { huber: "Huber", "soft-l1": "soft L1", tukey: "Tukey" };

/** Draw the settings of a draft; `store(what, label)` keeps a change. */
export function settingsForm(main, more, models, draft, store, recordings) {
  const weights = draft.weights ?? { windows: [], peaks: 0, activity: "torque" };
  const choice = (id, label, options, chosen, key, map = (value) => value || null) => {
    const knob = select({ id: `set-${id}` }, options, chosen ?? "");
    knob.addEventListener("change", () => store(key(map(knob.value)), `${label}: ${knob.selectedOptions[0].textContent}`));
    return field(label, knob);
  };
  const amount = (id, label, value, props, key) => {
    const input = h("input", { type: "number", step: "any", id: `set-${id}`, value: value ?? "", ...props });
    input.addEventListener("change", () => {
      if (!input.checkValidity()) return input.reportValidity();
      return store(key(input.value === "" ? null : Number(input.value)), `${label} ${input.value || "default"}`);
    });
    return field(label, input);
  };
  replace(
    main,
    choice("model", "Model", models.fitted.map((model) => [model.name, model.title]), draft.model, (model) => ({ model })),
    draft.model === "auto" && choice("nuisances", "Laboratory’s imperfections", [["all", "taken in"], ["none", "left out"]], typeof draft.nuisances === "string" ? draft.nuisances : "all", (nuisances) => ({ nuisances })),
    choice("population", "Priors", [["", "none"], ...models.populations.map((name) => [name, `${name} population`])], draft.population, (population) => ({ population })),
    choice("loss", "Outliers", [["", "count fully"], ...models.losses.map((name) => [name, LOSSES[name] ?? name])], draft.loss, (loss) => ({ loss })),
    amount("mass", "Body mass [kg]", draft.body_mass, { min: 5, max: 400 }, (body_mass) => (body_mass === null ? NO_MASS : { body_mass })),
    h("div", { class: "drives" }, Object.entries(models.drives).map(([name, members]) => drive(name, members, draft.parameters, store))),
  );
  replace(
    more,
    amount("starts", "Starts", draft.starts, { min: 1, max: 200, step: 1, required: true }, (starts) => ({ starts: starts ?? 8 })),
    amount("seed", "Seed", draft.seed, { min: 0, step: 1, required: true }, (seed) => ({ seed: seed ?? 0 })),
    amount("peaks", "Weight of peaks", weights.peaks, { min: 0, required: true }, (peaks) => ({ weights: { ...weights, peaks: peaks ?? 0 } })),
    choice("activity", "Peaks are those of", [["torque", "torque"], ["emg", "EMG"]], weights.activity, (activity) => ({ weights: { ...weights, activity } })),
    choice("normalise", "Divide EMG by", [["", "nothing"], ["session", "the session's largest"], ["mvc", "the contractions' largest"]], draft.normalise, (normalise) => (normalise === "mvc" ? { normalise } : { normalise, mvc: [] })),
    draft.normalise === "mvc" && contractions(recordings, draft, store),
    draft.body_mass !== null && amount("plate", "Footplate [kg]", draft.footplate_mass, { min: 0, max: 20 }, (mass) => ({ footplate_mass: mass ?? 0 })),
    draft.body_mass !== null && choice("share", "Foot's share by", models.foot_shares.map((name) => [name, name.replaceAll("-", " ")]), draft.foot_share, (foot_share) => ({ foot_share })),
    choice("prepared", "Signals", [["", "filter and resample"], ["yes", "use as they are"]], draft.prepared ? "yes" : "", (prepared) => ({ prepared }), (v) => v === "yes"),
    Object.entries(models.preparation).map(([name, usual]) => filter(name, usual, draft.preparation, store, amount)),
    Object.entries(models.options).map(([name, known]) => option(name, known, draft.options, store, choice, amount)),
  );
}

/** Recordings of maximum contractions. */
function contractions(recordings, draft, store) {
  const knob = h("select", { id: "set-mvc", multiple: true }, recordings.map((one) => h("option", { value: one.id, selected: draft.mvc.includes(one.id) }, one.name)));
  knob.addEventListener("change", () => store({ mvc: [...knob.selectedOptions].map((one) => one.value) }, "maximum contractions"));
  return field("Maximum contractions", knob);
}

/** One setting of the preparation; empty: its default. */
function filter(name, usual, told, store, amount) {
  const label = name.replaceAll("_", " ").replace(" hz", " [Hz]").replace("emg", "EMG");
  const key = (value) => {
    const made = { ...told };
    if (value === null) delete made[name];
    else made[name] = value === 0 ? false : value;
    return { preparation: made };
  };
  const off = usual === null || !name.endsWith("_order");
  const now = told[name] === false ? 0 : told[name] ?? null;
  return amount(name, label.charAt(0).toUpperCase() + label.slice(1), now, { min: 0, placeholder: usual ?? "off", title: off ? "0: without this filter" : "" }, key);
}

/** What may drive the muscles beside the EMG as it is: its parameters come and go together. */
function drive(name, members, told, store) {
  const label = DRIVES[name] ?? name;
  const knob = h("input", { type: "checkbox", id: `set-${name}`, checked: members.some((one) => told[one]) });
  knob.addEventListener("change", () => {
    const each = (value) => Object.fromEntries(members.map((one) => [one, value]));
    const change = knob.checked ? { parameters: each({ free: true }) } : { parameters: each(null), sliders: each(null) };
    store(change, `${label}: ${knob.checked ? "yes" : "no"}`);
  });
  return h("label", { class: "check" }, knob, label);
}

/** One switch of the model: a choice where its values are listed, else a number. */
function option(name, known, options, store, choice, amount) {
  const label = name.replaceAll("_", " ");
  const title = label.charAt(0).toUpperCase() + label.slice(1);
  const key = (value) => {
    const made = { ...options };
    if (value === null) delete made[name];
    else made[name] = value;
    return { options: made };
  };
  if (Array.isArray(known)) {
    return choice(name, title, known.map((one) => [one, one]), options[name] ?? known[0], key);
  }
  return amount(name, title, options[name] === known ? null : options[name], { placeholder: String(known) }, key);
}
