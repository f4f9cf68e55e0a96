// What mends a recording in one press: turn, swap, scale, each with its picture before and after.

import { button, h, select } from "../core/dom.js";
import { EMG, roleText, shownRange } from "../core/format.js";
import { over } from "../plot/over.js";
import { sparkline } from "../plot/sparkline.js";
import { _, said } from "../core/words.js";

/** What a finding is mended by, in words. */
export const labelOf = (mend) => said({ text: mend.label, given: mend.given });

/** A mapping with the channels that a remedy changes. */
export function mended(mapping, { channels }) {
  const made = { ...mapping, channels: { ...mapping.channels } };
  for (const [role, change] of Object.entries(channels)) made.channels[role] = { ...made.channels[role], ...change };
  return made;
}

/** The exchange of two electrodes as a remedy. */
export const swap = (mapping, first, second) => ({
  label: _("Swap {first} and {second}", { first: roleText(first), second: roleText(second) }),
  given: {},
  channels: { [first]: mapping.channels[second], [second]: mapping.channels[first] },
});

/** The remedies that findings offer, each once, with the finding that it is of. */
export function remediesOf(seen) {
  const found = new Map();
  for (const trial of seen) {
    for (const finding of trial.findings.filter((one) => one.mend)) {
      const key = JSON.stringify([finding.mend.label, finding.mend.given, Object.keys(finding.mend.channels)]);
      if (!found.has(key)) found.set(key, { ...finding, trial });
    }
  }
  return [...found.values()];
}

/**
 * One remedy: why, its pictures, its button.
 *
 * @param look gives what the recording would be with it, as the preview has it
 * @param use is called when it is wanted
 */
export function remedy({ message, said: told, mend, trial }, look, use) {
  const after = h("div", {}, h("progress", { "aria-label": labelOf(mend) }));
  const roles = Object.keys(mend.channels);
  look(mend).then((then) => after.replaceChildren(...pictures(then, roles, labelOf(mend)))).catch(() => after.replaceChildren());
  return h(
    "section",
    { class: "remedy" },
    h("p", {}, trial.name ? h("strong", {}, `${trial.name}: `) : null, message ? said({ text: message, ...told }) : labelOf(mend)),
    h("div", { class: "before-after" }, h("div", {}, pictures(trial, roles, _("As it is"))), after),
    button(labelOf(mend), () => use(mend), { class: "primary" }),
  );
}

/** A picture with its words: torque over angle where these are changed, else each signal over time. */
function pictures(seen, roles, words) {
  const of = roles.some((role) => !EMG.includes(role))
    ? [over(seen.pictures.over, _("Torque over angle: {what}", { what: words }))]
    : roles.map((role) => {
        const channel = seen.channels.find((one) => one.role === role);
        return h("div", {}, h("span", { class: "small" }, `${roleText(role)} ${shownRange(channel.low, channel.high, channel.unit)}`), sparkline(seen.pictures.of[role], `${roleText(role)}: ${words}`));
      });
  return [h("p", { class: "muted small" }, words), ...of];
}

/** Two electrodes to be exchanged, where there are two; `look` and `use` are as of `remedy`. */
export function swapping(mapping, trial, look, use) {
  const there = EMG.filter((role) => mapping.channels[role]);
  if (there.length < 2) return null;
  const options = there.map((role) => [role, roleText(role)]);
  const first = select({ "aria-label": _("Electrode") }, options, there[0]);
  const second = select({ "aria-label": _("Other electrode") }, options, there[1]);
  const place = h("div");
  const show = button(_("Look at them exchanged"), () => {
    if (first.value === second.value) return place.replaceChildren();
    const mend = swap(mapping, first.value, second.value);
    return place.replaceChildren(remedy({ message: "", mend, trial }, look, use));
  }, { class: "small" });
  return h("details", { class: "swapping" }, h("summary", {}, _("Two electrodes are exchanged?")), h("div", { class: "button-row" }, first, second, show), place);
}
