// Which channel of the streams is which signal: chosen here, from what their names suggest.

import { get, post } from "../js/core/api.js";
import { byId, h, replace, select, tick } from "../js/core/dom.js";
import { _, many } from "../js/core/words.js";

const NAMES = {
  angle: _("Angle"), torque: _("Torque"), emg_ta: _("tibialis"), emg_gl: _("gastroc. lat."), emg_sol: _("soleus"), emg_gm: _("gastroc. med."),
};

/** Show the choice; `refresh` is called once it is made, `tried` says what goes wrong. */
export async function showChannels(state, refresh, tried) {
  const offered = await get("/api/live/channels");
  const place = byId("channels");
  place.hidden = !offered.columns.length;
  if (!offered.columns.length) return;
  const stated = Object.fromEntries(offered.columns.map(({ column, unit }) => [column, unit]));
  const rows = Object.keys(NAMES).map((role) => line(role, offered, stated, state.mapped));
  const unread = state.trials.filter((trial) => trial.state === "judged" && !trial.use).length;
  const judged = state.trials.length - unread;
  let again = false;
  const kind = select({ id: "emg-kind" }, [["raw", _("raw")], ["envelope", _("envelope")]], offered.emg ?? "raw");
  const guessed = Object.keys(offered.guesses).length;
  const said = state.mapped
    ? _("These are used. Another choice counts from the next trial on.")
    : guessed
      ? _("This is a guess by the channels’ names: look at it, then use it.")
      : _("The streams’ names do not say which channel is which: choose.");
  replace(
    byId("channels-form"),
    h("p", { class: "small" }, said),
    rows.map((one) => one.shown),
    h("label", { class: "channel" }, h("span", {}, "EMG"), kind),
    h("p", { class: "muted small" }, _("Angle is positive in dorsiflexion, torque where the calf pulls: turn what is not.")),
    unread ? h("p", { class: "small" }, many("{n} trial waits for this, and is judged then.", "{n} trials wait for this, and are judged then.", unread)) : null,
    judged ? tick(_("Judge all trials so far again by it"), false, (yes) => { again = yes; }) : null,
    h("button", { type: "submit", class: state.mapped ? null : "primary" }, _("Use these channels")),
  );
  if (!state.mapped) place.open = true;
  byId("channels-form").onsubmit = (event) => {
    event.preventDefault();
    const channels = Object.fromEntries(rows.map((one) => one.value()).filter(Boolean));
    tried(async () => {
      await post("/api/live/channels", { channels, emg: kind.value, again });
      place.open = false;
      await refresh();
    });
  };
}

/** One signal's line: its channel, its unit where the stream states none, and whether it is turned. */
function line(role, offered, stated, mapped) {
  const before = offered.chosen[role] ?? (mapped ? null : offered.guesses[role]);
  const perhaps = offered.open[role] ?? [];
  const column = select({ "aria-label": NAMES[role] }, [["", perhaps.length && !before ? _("– choose –") : _("– none –")], ...offered.columns.map((one) => [one.column, one.unit ? `${one.column} [${one.unit}]` : one.column])], before?.column ?? "");
  const unit = select({ "aria-label": _("Unit of {name}", { name: NAMES[role] }) }, offered.units[role].map((name) => [name, name]), before?.unit ?? offered.units[role][0]);
  let turned = before?.sign === -1;
  const turn = tick(_("turn"), turned, (yes) => { turned = yes; });
  const show = () => { unit.hidden = !column.value || Boolean(stated[column.value]); };
  column.addEventListener("change", show);
  show();
  return {
    shown: h("div", { class: "channel" }, h("span", {}, NAMES[role]), column, unit, role.startsWith("emg_") ? null : turn),
    value: () => column.value && [role, { column: column.value, unit: unit.value, sign: turned ? -1 : 1 }],
  };
}
