// What this browser works on: kept by the server, changed one step at a time, undone and redone.

import { get, patch, post } from "./api.js";
import { attempt, tell } from "./notice.js";
import { _ } from "./words.js";

let state = null;
let queue = Promise.resolve();
const listeners = new Set();

/** Be told of every change, this page's own and others'. */
export function onDraft(listener) {
  listeners.add(listener);
  if (state) listener();
}

function settle(next) {
  state = next;
  for (const listener of listeners) listener();
  return state;
}

export const draftState = () => state;
export const draft = () => state?.draft ?? null;

export const loadDraft = async () => settle(await get("/api/draft"));

/** Change the draft; changes wait for one another. One that builds on the draft is a function of it. */
export function change(what, label, { merge = false } = {}) {
  const done = queue.then(async () => {
    const made = typeof what === "function" ? what(draft()) : what;
    return settle(await patch("/api/draft", { change: made, label: label.slice(0, 120), merge }));
  });
  queue = done.catch(() => null);
  return done;
}

/** Undo or redo the last step. */
export function history(step, box) {
  const label = step === "undo" ? state?.undo : state?.redo;
  if (label === null || label === undefined) return;
  const done = queue.then(() =>
    attempt(box, async () => {
      settle(await post(`/api/draft/${step}`));
      tell(`${step === "undo" ? _("Undone") : _("Redone")}: ${label}`);
      dispatchEvent(new CustomEvent("surae:changed", { detail: { what: "all" } }));
    }),
  );
  queue = done.catch(() => null);
}

/** Another tab of this browser, or another device, may have changed it. */
export async function heard(revision) {
  await queue;
  if (!state || state.revision === revision) return;
  await loadDraft();
}
