// Numbers as text: sensible digits, powers of ten in print style, a unit at every number.

import { _, decimal, language } from "./words.js";

export const NONE = "—";
const SUPERSCRIPT = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** A number with so many significant digits; true minus sign. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) {
    const [mantissa, power] = value.toExponential(Math.max(digits - 1, 0)).split("e");
    return `${minus(mantissa)}·10${[...String(Number(power))].map((c) => SUPERSCRIPT[c]).join("")}`;
  }
  const rounded = Number(value.toPrecision(Math.max(digits, 1)));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return minus(rounded.toFixed(Math.min(decimals, 9)));
}

export const minus = (text) => decimal(text.replace("-", "−"));

/** A number with its unit; "-" means that it has none. */
export function quantity(value, unit, digits = 4) {
  const text = number(value, digits);
  return text === NONE || !unit || unit === "-" || unit === "1" ? text : `${text} ${unitText(unit)}`;
}

export const unitText = (unit) =>
  !unit || unit === "-" || unit === "1" ? "" : unit.replace(/\b([a-zA-Z]+)(\d)$/, (_, u, d) => u + SUPERSCRIPT[d]).replace("uV", "µV").replace(/^deg/, "°");

/** An estimate to the second digit of its standard error, as the reports write it. */
export function estimate(value, sem) {
  if (value === null || value === undefined) return NONE;
  if (!sem || !Number.isFinite(sem) || sem <= 0 || value === 0) return number(value, 4);
  const digits = Math.floor(Math.log10(Math.abs(value))) - Math.floor(Math.log10(sem)) + 2;
  return number(value, Math.min(Math.max(digits, 2), 6));
}

export const percent = (value, digits = 3) =>
  value === null || value === undefined ? NONE : `${number(value, digits)} %`;

/** An R² never rounds up to a perfect 100. */
export function r2(value) {
  if (value === null || value === undefined) return NONE;
  return value > 99.9 ? `${minus((Math.floor(value * 1000) / 1000).toFixed(3))} %` : `${minus(value.toFixed(1))} %`;
}

export const seconds = (value) =>
  value === null || value === undefined ? NONE : value < 60 ? `${minus(value.toFixed(value < 10 ? 2 : 1))} s` : `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`;

export const span = (start, end) => _("{low} to {high}", { low: minus(start.toFixed(2)), high: `${minus(end.toFixed(2))} s` });

export function when(iso) {
  const date = new Date(iso);
  return Number.isNaN(date.getTime())
    ? NONE
    : date.toLocaleString(language, { year: "numeric", month: "short", day: "numeric", hour: "2-digit", minute: "2-digit" });
}

/** A rate of samples, without zeros that say nothing. */
export const rate = (hz) => (hz ? `${decimal(String(Number(hz.toPrecision(5))))} Hz` : NONE);

export const bytes = (n) => (n < 1e6 ? `${number(n / 1e3, 3)} kB` : `${number(n / 1e6, 3)} MB`);

const ROLES = {
  angle: _("Angle"),
  torque: _("Torque"),
  emg_ta: _("EMG tibialis anterior"),
  emg_gl: _("EMG gastrocnemius lateralis"),
  emg_sol: _("EMG soleus"),
  emg_gm: _("EMG gastrocnemius medialis"),
  angular_velocity: _("Angular velocity"),
  angular_acceleration: _("Angular acceleration"),
};
const MUSCLES = { tib: _("tibialis"), gl: _("gastrocnemius lateralis"), sol: _("soleus"), gm: _("gastrocnemius medialis") };
const FILMED = { fascicle: _("Fascicle length"), pennation: _("Pennation") };
export const ofFilm = (role) => role.split("_")[0] in FILMED;
export function roleText(role) {
  const [kind, muscle] = role.split("_");
  return ROLES[role] ?? (FILMED[kind] ? `${FILMED[kind]}, ${MUSCLES[muscle]}` : role);
}
export const EMG = ["emg_ta", "emg_gl", "emg_sol", "emg_gm"];
export const EMG_SHORT = ["TA", "GL", "SOL", "GM"];

const VERDICTS = { identified: _("identified"), weak: _("weak"), undetermined: _("undetermined"), "at-bound": _("at bound"), fixed: _("fixed") };
export const verdictText = (verdict) => VERDICTS[verdict] ?? verdict;

/** A range of values as it is shown to the eye. */
export function shownRange(low, high, unit) {
  const { factor, unit: text } = shownAs(unit);
  return `${number(low * factor, 3)} … ${number(high * factor, 3)} ${text}`;
}

/** How a signal is shown: factor and unit for the eye (degrees, mV). */
export function shownAs(unit) {
  if (unit === "rad") return { factor: 180 / Math.PI, unit: "°" };
  if (unit === "rad/s") return { factor: 180 / Math.PI, unit: "°/s" };
  if (unit === "rad/s2" || unit === "rad/s²") return { factor: 180 / Math.PI, unit: "°/s²" };
  if (unit === "V") return { factor: 1e3, unit: "mV" };
  return { factor: 1, unit: unitText(unit) };
}
