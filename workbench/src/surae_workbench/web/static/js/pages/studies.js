// Studies: start one, see how far they are.

import { get, post } from "../core/api.js";
import { byId, empty, h, replace } from "../core/dom.js";
import { onChanged, onJob } from "../core/events.js";
import { when } from "../core/format.js";
import { attempt, calm } from "../core/notice.js";
import { factors } from "../ui/factors.js";
import { mark } from "../ui/marks.js";
import { sortable } from "../ui/table.js";

const box = byId("error");

const table = sortable("Studies", [
  { title: "Study", value: (s) => s.name, show: (s) => h("a", { href: `/studies/${s.id}` }, s.name) },
  { title: "State", value: (s) => s.state, show: (s) => mark(s.state) },
  { title: "Done", value: (s) => s.done / (s.fits || 1), show: (s) => h("span", {}, h("progress", { max: s.fits || 1, value: s.done, "aria-label": `Progress of ${s.name}` }), ` ${s.done} of ${s.fits} fits`) },
  { title: "Made", value: (s) => s.created, show: (s) => when(s.created) },
]);

async function refresh() {
  const { studies } = await get("/api/studies");
  table.update(studies);
  replace(byId("list"), studies.length ? table.element : empty("No studies yet.", "Choose below what to vary, and start."));
}

byId("new").addEventListener("submit", async (event) => {
  event.preventDefault();
  const made = await attempt(byId("new-error"), () => post("/api/studies", { toml: byId("toml").value, start: true }), byId("start"));
  if (made) location.href = `/studies/${made.id}`;
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
onChanged(["studies"], () => attempt(box, refresh));
onJob((job) => job.kind === "study" && attempt(box, refresh));
attempt(box, refresh);
