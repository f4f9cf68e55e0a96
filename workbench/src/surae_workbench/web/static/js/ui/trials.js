// Several files that are trials of one layout: one description serves all of them.

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

const LEFT_OUT = "surae.left-out";

/** Remember, across pages, why trials were not chosen for the fit: {id: reason}. */
export const rememberLeftOut = (reasons) => sessionStorage.setItem(LEFT_OUT, JSON.stringify({ ...leftOut(), ...reasons }));

/** Why trials that were imported together were not chosen: {id: reason}. */
export const leftOut = () => JSON.parse(sessionStorage.getItem(LEFT_OUT) ?? "{}");

/** Why a trial is not for a joint fit, as the check has it; empty for one that is. */
export function whyNot(findings) {
  if (findings.some((one) => one.code === "angle-still")) return "holds still: one hold cannot show stiffness";
  const error = findings.find((one) => one.severity === "error");
  return error ? `the check: ${error.message}` : "";
}
