// Around every page: history, theme, what runs.

import { get } from "./api.js";
import { byId, h, replace } from "./dom.js";
import { draftState, history, loadDraft, onDraft } from "./draft.js";
import { listen, onChanged, onJob, onQueue } from "./events.js";
import { alertBox, complain } from "./notice.js";
import { themeButton } from "./theme.js";

const box = alertBox();
byId("main").prepend(box);

const editable = (element) =>
  element instanceof HTMLTextAreaElement ||
  element instanceof HTMLSelectElement ||
  (element instanceof HTMLInputElement && !["range", "checkbox", "radio", "button"].includes(element.type));

function showHistory() {
  const { undo, redo } = draftState();
  for (const [id, label, verb] of [["undo", undo, "Undo"], ["redo", redo, "Redo"]]) {
    const knob = byId(id);
    knob.disabled = label === null;
    const text = label === null ? `Nothing to ${id}` : `${verb}: ${label}`;
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

const running = new Map();

function showJobs() {
  const place = byId("jobs");
  place.hidden = running.size === 0;
  const first = [...running.values()][0];
  const href = first && ({ fit: "/fit", study: "/studies" }[first.kind] ?? "/");
  replace(place, first && h("a", { href }, running.size === 1 ? `${first.kind} ${first.state}` : `${running.size} jobs running`));
}

function note(job) {
  if (job.state === "queued" || job.state === "running") running.set(job.id, job);
  else running.delete(job.id);
  showJobs();
}

async function readJobs() {
  const { jobs } = await get("/api/jobs?active=true");
  running.clear();
  jobs.forEach(note);
  showJobs();
}

byId("undo").addEventListener("click", () => history("undo", box));
byId("redo").addEventListener("click", () => history("redo", box));
addEventListener("keydown", keys);
themeButton(byId("theme"));
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
onDraft(showHistory);
onJob(note);
onQueue((waiting) => {
  byId("queue").hidden = waiting === 0;
  byId("queue").textContent = `${waiting} waiting for files to be read`;
});
onChanged([], () => readJobs().catch(() => null));
listen();
Promise.all([loadDraft(), readJobs()]).catch((error) => complain(box, error));
