// Which column is what: one row per role, with unit, sign and a picture of the signal.

import { button, h, select, table } from "../core/dom.js";
import { EMG, number, ofFilm, roleText, unitText } from "../core/format.js";
import { sparkline } from "../plot/sparkline.js";
import { _ } from "../core/words.js";

export const emptyMapping = () => ({ name: "", emg: null, side: null, channels: {}, fixed: {}, prepare: {}, open: [] });

const NEEDED = ["angle", "torque", ...EMG];
const OUT = "out";
/** What a number of a channel is that is left blank. */
const BLANK = { scale: 1, offset: 0, start_s: null, rate_hz: null };

/**
 * The table of a mapping; it changes the mapping in place and calls `changed` after every change.
 *
 * @param files what was inspected: [{id, name, columns}]
 */
export function mappingTable(mapping, files, { roles, units }, changed) {
  const all = roles.length ? roles : NEEDED;
  const usual = (role) => NEEDED.includes(role) || role in mapping.channels;
  const others = all.filter((role) => !usual(role));
  const filmed = all.filter((role) => ofFilm(role) && mapping.channels[role] && !mapping.channels[role].time);
  const part = (some, label, caption) => table(
    label,
    [_("Signal"), _("Column"), _("Unit"), _("Sign"), _("Scale"), _("Offset"), _("Range in the file"), _("Preview")],
    some.map((role) => cells(role, mapping, files, units[role] ?? [], changed)),
    { class: "mapping", caption },
  );
  return [
    part(all.filter(usual), _("Channels, units, signs"), _("Angle: dorsiflexion positive. Torque: positive where the triceps pulls. Turn a sign where the file has it the other way. A value is sign · (scale · number + offset), in the unit.")),
    others.length > 0 && h("details", {}, h("summary", {}, _("Other signals: velocity, ultrasound")), part(others, _("Other signals"), _("Signals that a file may have too"))),
    filmed.length > 0 && table(
      _("Clock of a film"),
      [_("Signal"), _("First frame at [s]"), _("Frames per second")],
      filmed.map((role) => [roleText(role), ...[["start_s", _("First frame")], ["rate_hz", _("Frames per second")]].map(([key, label]) => amount(mapping.channels[role], role, key, label, changed))]),
      { class: "mapping", caption: _("The first frame is at this time of the other signals. Leave blank what the film’s file has right.") },
    ),
  ];
}

function cells(role, mapping, files, units, changed) {
  const channel = mapping.channels[role] ?? null;
  const column = channel && files.find((f) => f.id === channel.upload)?.columns.find((c) => c.name === channel.column);
  // Of a muscle that is in the file but not settled it must be said that it may be left out.
  const weight = mapping.open?.includes(role) && EMG.includes(role) ? `g${EMG.indexOf(role) + 1}` : null;
  const choose = h(
    "select",
    { "aria-label": _("Column of {role}", { role: roleText(role) }), "data-focus": `column-${role}` },
    h("option", { value: "" }, NEEDED.includes(role) ? _("choose …") : _("none")),
    files.map((file, f) => h("optgroup", { label: file.name }, file.columns.map((c, i) => (c.usable !== false || c.bridge_s > 0) && h("option", { value: `${f}/${i}` }, c.usable === false ? _("{name} (a line over its gaps)", c) : c.name)))),
    weight && h("option", { value: OUT }, _("left out: silent")),
  );
  const at = channel ? files.findIndex((f) => f.id === channel.upload) : -1;
  choose.value = weight && weight in mapping.fixed ? OUT : at < 0 || !column ? "" : `${at}/${files[at].columns.indexOf(column)}`;
  choose.addEventListener("change", () => {
    const [f, i] = choose.value.split("/").map(Number);
    if (weight) delete mapping.fixed[weight];
    if (choose.value === OUT) mapping.fixed[weight] = 0;
    if (choose.value === "" || choose.value === OUT) delete mapping.channels[role];
    else {
      const file = files[f];
      const one = file.columns[i];
      mapping.channels[role] = { upload: file.id, column: one.name, unit: units.includes(one.unit) ? one.unit : units.length === 1 ? units[0] : null, sign: 1, scale: one.scale ?? 1.0, offset: 0.0, bridge_s: one.usable === false ? one.bridge_s : 0 };
    }
    changed();
  });

  const stated = channel?.unit ?? column?.unit ?? "";
  const known = stated && !units.includes(stated) ? [stated, ...units] : units;
  const unit = select(
    { "aria-label": _("Unit of {role}", { role: roleText(role) }), disabled: !channel, "data-focus": `unit-${role}` },
    [...(stated ? [] : [["", _("choose …")]]), ...known.map((name) => [name, unitText(name) || _("none")])],
    stated,
  );
  unit.addEventListener("change", () => {
    channel.unit = unit.value || null;
    // One amplifier measures all muscles: a unit given once holds for the EMG without one.
    for (const other of EMG.includes(role) ? EMG : []) {
      if (mapping.channels[other]) mapping.channels[other].unit ??= channel.unit;
    }
    changed();
  });
  const sign = button(
    channel?.sign < 0 ? "−" : "+",
    () => {
      channel.sign = channel.sign < 0 ? 1 : -1;
      changed();
    },
    {
      class: "small",
      disabled: !channel,
      "aria-label": channel?.sign < 0 ? _("Sign of {role}: turned", { role: roleText(role) }) : _("Sign of {role}: as in the file", { role: roleText(role) }),
      "aria-pressed": String(channel?.sign < 0),
      "data-focus": `sign-${role}`,
    },
  );
  const range = column ? `${number(column.low, 3)} … ${number(column.high, 3)} ${unitText(stated)}` : "—";
  return [
    [roleText(role), NEEDED.includes(role) ? "" : h("span", { class: "muted small" }, ` (${_("optional")})`)],
    choose,
    unit,
    sign,
    amount(channel, role, "scale", _("Scale"), changed),
    amount(channel, role, "offset", _("Offset"), changed),
    h("td", { class: "nowrap" }, range),
    h("td", { class: "spark" }, column?.preview ? sparkline(column.preview, _("Preview of {role}", { role: roleText(role) }), channel.sign) : "—"),
  ];
}

/** An input of a number of a channel. */
function amount(channel, role, key, label, changed) {
  const input = h("input", { type: "number", step: "any", value: channel?.[key] ?? "", disabled: !channel, "aria-label": _("{label} of {role}", { label, role: roleText(role) }), "data-focus": `${key}-${role}` });
  input.addEventListener("change", () => {
    const value = input.valueAsNumber;
    channel[key] = Number.isFinite(value) && (key !== "scale" || value) ? value : BLANK[key];
    changed();
  });
  return input;
}
