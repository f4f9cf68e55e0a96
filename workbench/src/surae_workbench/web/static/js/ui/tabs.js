// Tabs: arrow keys move between them, the address remembers which is open. It names the tab, not the
// panel: a browser would put the focus, and a frame around it, on what the address names.

import { byId } from "../core/dom.js";

/** Make tabs of a tablist; `opened[id]` runs the first time that a panel is shown. */
export function tabs(list, opened = {}) {
  const knobs = [...list.querySelectorAll("[role=tab]")];
  const seen = new Set();

  function open(knob, focus = false) {
    for (const other of knobs) {
      const chosen = other === knob;
      other.setAttribute("aria-selected", String(chosen));
      other.tabIndex = chosen ? 0 : -1;
      byId(other.getAttribute("aria-controls")).hidden = !chosen;
    }
    if (focus) knob.focus();
    const panel = knob.getAttribute("aria-controls");
    history.replaceState(null, "", `#show-${panel}`);
    if (!seen.has(panel)) {
      seen.add(panel);
      opened[panel]?.();
    }
  }

  list.addEventListener("keydown", (event) => {
    const at = knobs.indexOf(document.activeElement);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: knobs.length - 1 }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    open(knobs[(to + knobs.length) % knobs.length], true);
  });
  for (const knob of knobs) knob.addEventListener("click", () => open(knob));
  const named = knobs.find((knob) => ["#", "#show-"].some((mark) => mark + knob.getAttribute("aria-controls") === location.hash));
  open(named ?? knobs[0]);
  return { open: (panel) => open(knobs.find((k) => k.getAttribute("aria-controls") === panel)) };
}
