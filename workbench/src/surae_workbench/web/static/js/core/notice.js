// Notices: quietly at the corner, or as an error beside what caused it.

import { byId, h } from "./dom.js";
import { _ } from "./words.js";

/** A line at the corner, read out politely. */
export function tell(text) {
  const line = h("p", { class: "notice" }, text);
  const area = byId("notices");
  area.append(line);
  while (area.children.length > 3) area.firstElementChild.remove();
  setTimeout(() => line.remove(), 6000);
}

/** An empty place for an error; put it beside the control it belongs to. */
export const alertBox = (id = null) => h("p", { class: "alert", role: "alert", id, hidden: true });

/** Show an error in its place. */
export function complain(box, error) {
  let line = error instanceof Error ? error.message : String(error);
  if (error instanceof TypeError || error instanceof ReferenceError) {
    console.error(error); // ours, not the server's: no sentence for a reader
    line = _("the page could not show this; reload it");
  }
  box.textContent = line;
  box.hidden = false;
}

export function calm(box) {
  box.hidden = true;
  box.textContent = "";
}

/** Do something; say in `box` why it was refused. Gives the result, or undefined. */
export async function attempt(box, work, busy = null) {
  calm(box);
  if (busy) {
    busy.disabled = true;
    busy.setAttribute("aria-busy", "true");
  }
  try {
    return await work();
  } catch (error) {
    if (error.name !== "AbortError") complain(box, error);
    return undefined;
  } finally {
    if (busy) {
      busy.disabled = false;
      busy.removeAttribute("aria-busy");
    }
  }
}

/** Do something when an element is chosen, which is busy meanwhile; errors go to `box`. */
export const onClick = (id, box, work) => byId(id).addEventListener("click", () => attempt(box, work, byId(id)));

/** What a page is about: its heading, the window's title, and what is said below. */
export function headline(name, about) {
  document.title = document.title.replace(/^[^·]*/, `${name} `);
  byId("name").textContent = name;
  byId("about").textContent = about.filter(Boolean).join(" · ");
}
