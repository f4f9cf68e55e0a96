// One study: how far it is, and what has come out so far.

import { download, get, post, remove } from "../core/api.js";
import { byId, h, replace } from "../core/dom.js";
import { onChanged, onJob } from "../core/events.js";
import { when } from "../core/format.js";
import { attempt, headline, onClick } from "../core/notice.js";
import { latest, settled } from "../core/pace.js";
import { ask } from "../ui/dialog.js";
import { cancel } from "../ui/jobs.js";
import { sortable } from "../ui/table.js";

const id = byId("study").dataset.id;
const box = byId("error");
let study = null;

const running = () => study.state === "running" || study.state === "queued";

function showHead() {
  headline(study.name, [study.fits === null ? "" : `${study.fits} fits`, `made ${when(study.created)}`]);
  byId("progress").max = study.fits || 1;
  byId("progress").value = study.done;
  byId("said").textContent = study.fits === null ? study.state : `${study.state}: ${study.done} of ${study.fits} fits`;
  byId("start").hidden = running() || study.state === "done";
  byId("stop").hidden = !running();
  byId("delete").disabled = running();
  byId("export").disabled = study.done === 0;
  byId("toml").textContent = study.toml;
  replace(byId("reasons"), Object.entries(study.reasons ?? {}).map(([why, n]) => h("li", {}, `${n} × ${why}`)));
}

const refresh = latest(async () => {
  await attempt(box, async () => {
    study = await get(`/api/studies/${id}`);
    showHead();
    if (study.done > 0) await showResults();
  });
});

let drawn = -1;
async function showResults() {
  if (drawn === study.done) return;
  drawn = study.done;
  const { columns, rows, total } = await get(`/api/studies/${id}/table?limit=500`);
  const table = sortable(
    total > rows.length ? `The first ${rows.length} of ${total} rows; the export has all` : `${total} rows`,
    columns.map((name, i) => ({
      title: name,
      numeric: rows.some((row) => typeof row[i] === "number"),
      value: (row) => row[i],
      show: (row) => (typeof row[i] === "number" ? String(Number(row[i].toPrecision(5))).replace("-", "−") : String(row[i] ?? "—")),
    })),
  );
  table.update(rows);
  replace(byId("table"), table.element);
}

onClick("start", box, async () => { await post(`/api/studies/${id}/start`); await refresh(); });
onClick("stop", box, () => study.job && cancel(study.job));
onClick("export", box, () => download(`/api/studies/${id}/table.csv`, "study.csv"));
byId("delete").addEventListener("click", async () => {
  if (!(await ask(`Delete ${study.name}?`, h("p", {}, `Its ${study.done} fits are lost.`), { confirm: "Delete", danger: true }))) return;
  const gone = await attempt(box, async () => { await remove(`/api/studies/${id}`); return true; });
  if (gone) location.href = "/studies";
});
const soon = settled(refresh, 400);
onChanged(["studies"], soon);
onJob((job) => job.kind === "study" && soon());
refresh();
