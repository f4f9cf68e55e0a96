// Studies: start one, see how far they are.

import { download, get, post } from "../core/api.js";
import { button, byId, empty, h, replace } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { when } from "../core/format.js";
import { attempt, calm } from "../core/notice.js";
import { latest, settled } from "../core/pace.js";
import { factors } from "../ui/factors.js";
import { cancel } from "../ui/jobs.js";
import { mark } from "../ui/marks.js";
import { deleteButton, sortable } from "../ui/table.js";

const box = byId("error");
const running = (study) => study.state === "running" || study.state === "queued";

const table = sortable("Studies", [
  { title: "Study", value: (s) => s.name, show: (s) => h("details", {}, h("summary", {}, s.name), h("pre", { class: "scroll", tabindex: "0", role: "region", "aria-label": `Settings of ${s.name}` }, h("code", {}, s.toml))) },
  { title: "State", value: (s) => s.state, show: (s) => mark(s.state) },
  { title: "Done", value: (s) => s.done / (s.fits || 1), show: (s) => [h("progress", { max: s.fits || 1, value: s.done, "aria-label": `Progress of ${s.name}` }), ` ${s.done} of ${s.fits ?? s.rows} fits`, Object.entries(s.reasons).map(([why, n]) => h("div", { class: "small" }, `${n} × ${why}`))] },
  { title: "Made", look: "minor", value: (s) => s.created, show: (s) => when(s.created) },
  { title: "", show: actions },
]);

function actions(study) {
  const knob = (text, work) => button(text, () => attempt(box, work), { class: "small", "aria-label": `${text} ${study.name}` });
  return h(
    "div",
    { class: "button-row" },
    running(study) ? knob("Stop", () => cancel(study.job)) : study.state !== "done" && knob("Resume", () => post(`/api/studies/${study.id}/start`)),
    study.done > 0 && knob("Export CSV", () => download(`/api/studies/${study.id}/table.csv`, "study.csv")),
    !running(study) && deleteButton(`/api/studies/${study.id}`, study.name, box, refresh),
  );
}

const refresh = latest(() => attempt(box, async () => {
  const { studies } = await get("/api/studies");
  table.update(studies);
  replace(byId("list"), studies.length ? table.element : empty("No studies yet.", "Choose below what to vary, and start."));
  if (studies.some(running)) soon();
}));
const soon = settled(refresh, 2000);

byId("new").addEventListener("submit", async (event) => {
  event.preventDefault();
  const made = await attempt(byId("new-error"), () => post("/api/studies", { toml: byId("toml").value, start: true }), byId("start"));
  if (made) await refresh();
});
byId("file").addEventListener("change", async (event) => {
  calm(byId("new-error"));
  const [file] = event.target.files;
  if (!file) return;
  byId("toml").value = await file.text();
  byId("as-toml").open = true;
  byId("count").textContent = "As the file says.";
});
byId("toml").addEventListener("input", () => (byId("count").textContent = "As the text below says."));
attempt(box, async () => {
  const form = factors(await get("/api/protocols/choices"), (toml, fits) => {
    byId("start").disabled = toml === null;
    byId("count").textContent = toml === null ? "An entry is missing or no number." : `${fits.toLocaleString("en")} ${fits === 1 ? "fit" : "fits"}: every value with every other.`;
    if (toml !== null) byId("toml").value = toml;
  });
  replace(byId("factors"), form.element);
  form.write();
});
onChanged(["studies", "jobs"], refresh);
refresh();
