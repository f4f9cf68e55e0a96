// Trials to choose from; and several files of one layout, which one description serves.

import { h, tick } from "../core/dom.js";

/** A list to choose trials from: `chosen` has ids, `choose(one, wanted)` is called, `about` says more. */
export const trialList = (trials, chosen, choose, about) =>
  h("ul", { class: "list" }, trials.map((one) =>
    h(
      "li",
      {},
      tick(one.name, chosen.has(one.id), (wanted) => choose(one, wanted), { "data-focus": one.id }),
      h("a", { href: `/recordings/${one.id}`, class: "small", "aria-label": `Look at ${one.name}` }, "Look"),
      h("span", { class: "muted small" }, about(one).filter(Boolean).join(" · ")),
    ),
  ));

/** The files of which each holds an angle of its own; none where they are parts of one recording. */
export const trialsAmong = (files) => (files.length > 1 && files.every((one) => one.mapping.channels?.angle && one.columns.length) ? files : []);

/** The description of one trial, as that of another says; throws where it has no such column. */
export function forTrial(one, mapping) {
  const channels = Object.entries(mapping.channels).map(([role, channel]) => {
    if (!one.columns.some((column) => column.name === channel.column)) throw new Error(`it has no column ${channel.column}`);
    return [role, { ...channel, upload: one.id }];
  });
  return { ...mapping, name: one.name.replace(/\.[^.]*$/, ""), channels: Object.fromEntries(channels) };
}
