// Around every page: history, theme, what runs.

import { byId, h, replace } from "./dom.js";
import { draftState, history, loadDraft, onDraft } from "./draft.js";
import { listen, onChanged } from "./events.js";
import { alertBox, complain } from "./notice.js";
import { latest } from "./pace.js";
import { active } from "../ui/jobs.js";
import { _, chooseLanguage, many } from "./words.js";

const box = alertBox();
byId("main").prepend(box);

const editable = (element) =>
  element instanceof HTMLTextAreaElement ||
  element instanceof HTMLSelectElement ||
  (element instanceof HTMLInputElement && !["range", "checkbox", "radio", "button"].includes(element.type));

function showHistory() {
  const { undo, redo } = draftState();
  for (const [id, label, verb] of [["undo", undo, _("Undo")], ["redo", redo, _("Redo")]]) {
    const knob = byId(id);
    knob.disabled = label === null;
    const text = label === null ? id === "undo" ? _("Nothing to undo") : _("Nothing to redo") : `${verb}: ${label}`;
    knob.title = text;
    knob.setAttribute("aria-label", label === null ? verb : text);
  }
}

function keys(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey || editable(event.target)) return;
  const key = event.key.toLowerCase();
  const step = key === "y" || (key === "z" && event.shiftKey) ? "redo" : key === "z" ? "undo" : null;
  if (!step) return;
  event.preventDefault();
  history(step, box);
}

const showJobs = latest(async () => {
  const jobs = await active();
  byId("jobs").hidden = !jobs.length;
  const href = { fit: "/fit", session: "/analyse", design: "/plan", study: "/studies" }[jobs[0]?.kind] ?? "/";
  replace(byId("jobs"), jobs.length > 0 && h("a", { href }, jobs.length === 1 ? `${_(jobs[0].kind)}: ${_(jobs[0].state)}` : many("{n} job running", "{n} jobs running", jobs.length)));
});

byId("undo").addEventListener("click", () => history("undo", box));
byId("redo").addEventListener("click", () => history("redo", box));
addEventListener("keydown", keys);
const research = byId("research");
research.checked = document.documentElement.hasAttribute("data-research");
research.addEventListener("change", () => {
  document.documentElement.toggleAttribute("data-research", research.checked);
  try {
    localStorage.setItem("surae.research", research.checked ? "on" : "off");
  } catch {
    // Without storage it holds for this page.
  }
});
chooseLanguage(byId("language"));
onDraft(showHistory);
onChanged(["jobs"], () => showJobs().catch(() => null));
listen();
Promise.all([loadDraft(), showJobs()]).catch((error) => complain(box, error));
