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
import { _, many } from "../core/words.js";

const box = byId("error");
const running = (study) => study.state === "running" || study.state === "queued";

const table = sortable(_("Studies"), [
  { title: _("Study"), value: (s) => s.name, show: (s) => h("details", {}, h("summary", {}, s.name), h("pre", { class: "scroll", tabindex: "0", role: "region", "aria-label": _("Settings of {name}", s) }, h("code", {}, s.toml))) },
  { title: _("State"), value: (s) => s.state, show: (s) => mark(s.state) },
  { title: _("Done"), value: (s) => s.done / (s.fits || 1), show: (s) => [h("progress", { max: s.fits || 1, value: s.done, "aria-label": _("Progress of {name}", s) }), " ", _("{done} of {whole} fits", { done: s.done, whole: s.fits ?? s.rows }), Object.entries(s.reasons).map(([why, n]) => h("div", { class: "small" }, `${n} × ${why}`))] },
  { title: _("Made"), look: "minor", value: (s) => s.created, show: (s) => when(s.created) },
  { title: "", show: actions },
]);

function actions(study) {
  const knob = (text, work) => button(text, () => attempt(box, work), { class: "small", "aria-label": `${text} ${study.name}` });
  return h(
    "div",
    { class: "button-row" },
    running(study) ? knob(_("Stop"), () => cancel(study.job)) : study.state !== "done" && knob(_("Resume"), () => post(`/api/studies/${study.id}/start`)),
    study.done > 0 && knob(_("Export CSV"), () => download(`/api/studies/${study.id}/table.csv`, "study.csv")),
    !running(study) && deleteButton(`/api/studies/${study.id}`, study.name, box, refresh),
  );
}

const refresh = latest(() => attempt(box, async () => {
  const { studies } = await get("/api/studies");
  table.update(studies);
  replace(byId("list"), studies.length ? table.element : empty(_("No studies yet."), _("Choose below what to vary, and start.")));
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
  byId("count").textContent = _("As the file says.");
});
byId("toml").addEventListener("input", () => (byId("count").textContent = _("As the text below says.")));
attempt(box, async () => {
  const form = factors(await get("/api/protocols/choices"), (toml, fits) => {
    byId("start").disabled = toml === null;
    byId("count").textContent = toml === null ? _("An entry is missing or no number.") : many("{n} fit: every value with every other.", "{n} fits: every value with every other.", fits);
    if (toml !== null) byId("toml").value = toml;
  });
  replace(byId("factors"), form.element);
  form.write();
});
onChanged(["studies", "jobs"], refresh);
refresh();
