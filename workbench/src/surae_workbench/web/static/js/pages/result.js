// One fit: its report, which the server made, and what else the data can be asked.

import { download, get, patch } from "../core/api.js";
import { byId, field, h } from "../core/dom.js";
import { change, draftState, loadDraft } from "../core/draft.js";
import { onChanged } from "../core/events.js";
import { when } from "../core/format.js";
import { attempt, headline, onClick } from "../core/notice.js";
import { ask } from "../ui/dialog.js";
import { older } from "../ui/marks.js";
import { profiles } from "../ui/profiles.js";
import { validation } from "../ui/validation.js";
import { _ } from "../core/words.js";

const id = byId("fit").dataset.id;
const box = byId("error");
let result = null;

async function read() {
  result = await get(`/api/fits/${id}`);
  const { summary } = result;
  headline(summary.name, [_(summary.title), summary.names.join(", "), when(summary.created)]);
  byId("about").append(" ", older(summary) || "");
}

function file(knob, url, name) {
  const label = byId(knob).textContent;
  onClick(knob, box, async () => {
    byId(knob).textContent = _("Making it …");
    await download(url, name).finally(() => (byId(knob).textContent = label));
  });
}

file("report-html", `/api/fits/${id}/report.html`, "report.html");
file("report-pdf", `/api/fits/${id}/report.pdf`, "report.pdf");
file("save-json", `/api/fits/${id}/fit.json`, "fit.json");

onClick("rename", box, async () => {
  const name = h("input", { type: "text", required: true, maxlength: 120, value: result.summary.name });
  if (!(await ask(_("Rename the fit"), field(_("Name"), name), { confirm: _("Save") }))) return;
  await patch(`/api/fits/${id}`, { name: name.value.trim() });
  await read();
});

onClick("resume", box, async () => {
  const values = Object.fromEntries(
    Object.entries(result.parameters).filter(([, p]) => p.value !== null).map(([name, p]) => [name, p.value]),
  );
  const { parameters, exclusions, sliders, ...asked } = result.settings;
  // Entries that this browser has and the fit had not are taken away.
  const now = draftState()?.draft ?? (await loadDraft()).draft;
  const only = (key, wanted) => ({ ...Object.fromEntries(Object.keys(now[key]).map((name) => [name, null])), ...wanted });
  await change(
    { ...asked, exclusions: only("exclusions", exclusions), sliders: only("sliders", values) },
    _("settings of {name}", result.summary),
  );
  location.href = "/fit";
});

attempt(box.hidden ? box : byId("profile-error"), async () => {
  await read();
  profiles(id, () => result, read);
  validation(id, result);
});
onChanged(["fits"], () => attempt(byId("profile-error"), read));
