// The project's events: one stream per page keeps every list fresh.

import { heard } from "./draft.js";

let source = null;

/** Listen while the page is seen: a browser allows few connections, hidden tabs need none. */
export function listen() {
  document.addEventListener("visibilitychange", () => {
    if (document.hidden) close();
    else open(true);
  });
  addEventListener("pagehide", close);
  open(false);
}

function close() {
  source?.close();
  source = null;
}

function open(missed) {
  if (source) return;
  source = new EventSource("/api/events");
  source.addEventListener("open", () => {
    if (missed) announce({ what: "all" });
    missed = false;
  });
  source.addEventListener("error", () => {
    missed = true; // The browser tries again by itself, also after a restart of the server.
  });
  source.addEventListener("changed", (event) => announce(JSON.parse(event.data)));
  source.addEventListener("draft", (event) => heard(JSON.parse(event.data).revision).catch(() => null));
}

const announce = (detail) => dispatchEvent(new CustomEvent("surae:changed", { detail }));

/** Call `work` when one of these kinds of entries changed, or may have. */
export function onChanged(kinds, work) {
  addEventListener("surae:changed", ({ detail }) => {
    if (detail.what === "all" || kinds.includes(detail.what)) work();
  });
}
