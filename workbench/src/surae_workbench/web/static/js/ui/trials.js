// Trials to choose from; and several files of one layout, which one description serves.

import { h, tick } from "../core/dom.js";
import { _ } from "../core/words.js";

/** A list to choose trials from: `chosen` has ids, `choose(one, wanted)` is called, `about` says more. */
export const trialList = (trials, chosen, choose, about) =>
  h("ul", { class: "list" }, trials.map((one) =>
    h(
      "li",
      {},
      tick(one.name, chosen.has(one.id), (wanted) => choose(one, wanted), { "data-focus": one.id }),
      h("a", { href: `/recordings/${one.id}`, class: "small", "aria-label": _("Look at {name}", one) }, _("Look")),
      h("span", { class: "muted small" }, about(one).filter(Boolean).join(" · ")),
    ),
  ));

/** Files, or trials, as their names count: trial 2 before trial 10. */
export const inOrder = (named) => [...named].sort((a, b) => a.name.localeCompare(b.name, undefined, { numeric: true }));

/** The files of which each holds an angle of its own; none where they are parts of one recording. */
export const trialsAmong = (files) => (files.length > 1 && files.every((one) => one.mapping.channels?.angle && one.columns.length) ? files : []);

/** The trials in one file, of which each is imported as a recording; none where it is one. */
export const trialsWithin = (file) => (file.trials ?? []).map((one) => ({ ...file, ...one }));

/** The description of one trial, as that of another says; throws where it has no such column. */
export function forTrial(one, mapping) {
  const channels = Object.entries(mapping.channels).map(([role, channel]) => {
    if (!one.columns.some((column) => column.name === channel.column)) throw new Error(_("it has no column {column}", channel));
    return [role, { ...channel, upload: one.id }];
  });
  const own = one.trial ? { name: one.name, trial: one.trial } : { name: one.name.replace(/\.[^.]*$/, "") };
  return { ...mapping, ...own, channels: Object.fromEntries(channels) };
}

const SIDES = [["left", /(^|[^a-z])(left|links|linkes|gauche)([^a-z]|$)/i], ["right", /(^|[^a-z])(right|rechts|rechtes|droite?)([^a-z]|$)/i]];
const DAY = /(?<!\d)(20\d\d)[-_.]?(0[1-9]|1[0-2])[-_.]?(0[1-9]|[12]\d|3[01])(?!\d)/;
// "4 maart 2026", "4. März 2026", "4 mars 2026", "March 4, 2026": by how months begin in each language
const MONTHS = [/^jan/i, /^f[eé][bv]/i, /^m(?:a(?:art|r)|rt|är|rz)/i, /^a[pv]r/i, /^m(?:ei|ai|ay)/i, /^jui?n/i, /^jui?l/i, /^(?:ao[uû]|aug)/i, /^sep/i, /^o[ck]t/i, /^nov/i, /^d[eé][cz]/i];
const DAY_MONTH = /(?<!\d)(0?[1-9]|[12]\d|3[01])(?:st|nd|rd|th|er)?[\s_.-]*(?:of\s+)?(\p{L}{3,9})[\s_.,-]*(20\d\d)(?!\d)/iu;
const MONTH_DAY = /(\p{L}{3,9})[\s_.-]*(0?[1-9]|[12]\d|3[01])(?:st|nd|rd|th)?[\s_.,-]+(20\d\d)(?!\d)/iu;
const CODE = /(?<![A-Za-z0-9])(?:S|P|sub-?|pat)-?\d{1,4}(?![A-Za-z0-9])/i;

/** The day in a name, as 2026-03-04: in figures, or with its month in a language of the page. */
export function dayIn(name) {
  const figures = DAY.exec(name);
  if (figures) return figures.slice(1, 4).join("-");
  for (const [pattern, day, month] of [[DAY_MONTH, 1, 2], [MONTH_DAY, 2, 1]]) {
    const told = pattern.exec(name);
    const at = told ? MONTHS.findIndex((begin) => begin.test(told[month])) : -1;
    if (at >= 0) return [told[3], String(at + 1).padStart(2, "0"), told[day].padStart(2, "0")].join("-");
  }
  return undefined;
}

/** Side, day of the visit and code of the subject, as the names of a leg's files, with their folder, say alike. */
export function legOf(names) {
  const alike = (told) => {
    const found = new Set(names.map(told).filter(Boolean));
    return found.size === 1 ? [...found][0] : undefined;
  };
  const sides = (name) => SIDES.filter(([, words]) => words.test(name.replace(/_/g, " "))).map(([side]) => side);
  return {
    side: alike((name) => (sides(name).length === 1 ? sides(name)[0] : null)),
    visit: alike(dayIn),
    code: alike((name) => CODE.exec(name.replace(/_/g, " "))?.[0]),
  };
}
