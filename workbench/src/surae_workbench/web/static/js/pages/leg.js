// One leg: its report, and what changed since another visit.

import { download, get, patch, post, query } from "../core/api.js";
import { button, byId, field, h, html, replace, select } from "../core/dom.js";
import { attempt, headline, onClick } from "../core/notice.js";
import { mend } from "../ui/describe.js";
import { ask } from "../ui/dialog.js";
import { language } from "../core/words.js";

const id = byId("session").dataset.id;
const words = Object.fromEntries([...byId("words").querySelectorAll("dt")].map((term) => [term.textContent, term.nextSibling.textContent]));
let summary = null;
let place = null; // where the card of the change shows what it compares

async function show() {
  const answer = await get(`/api/sessions/${id}`);
  ({ summary } = answer);
  headline(summary.name, [words[summary.side], summary.visit || words.dayless]);
  byId("report-pdf").hidden = !answer.paper;
  byId("joint").hidden = !summary.fit;
  byId("joint").href = `/fits/${summary.fit}`;
  const knob = byId("before");
  const groups = { leg: [], other: [], else: [] };
  for (const one of answer.visits) groups[one.subject !== summary.subject || !one.subject ? "else" : one.side === summary.side ? "leg" : "other"].push(one);
  const listed = Object.entries(groups).filter(([, some]) => some.length).map(([key, some]) =>
    h("optgroup", { label: words[key] }, some.map((one) => h("option", { value: one.id }, [one.name, one.visit].filter((text, i, [name]) => !i || !name.includes(text)).join(", ")))));
  replace(knob, knob.options[0], listed.length ? listed : h("option", { disabled: true }, words.none));
  knob.value = answer.visits.some((one) => one.id === summary.before) ? summary.before : "";
  await compare();
}

/** What changed since the visit that was chosen; what the report says where none is. */
async function compare() {
  const card = document.querySelector(".report [aria-labelledby=change]");
  if (!card) return;
  place ??= { card, before: [...card.querySelectorAll(":scope > :not(h2)")] };
  if (byId("before").value) card.replaceChildren(card.querySelector("h2"), h("progress", { "aria-label": byId("before").selectedOptions[0].textContent }));
  const { html: text } = byId("before").value ? await get(`/api/sessions/${id}/change${query({ language })}`) : {};
  const said = h("div", { role: "status" }, text ? html(text) : place.before);
  card.replaceChildren(card.querySelector("h2"), said);
}

byId("before").addEventListener("change", () => attempt(byId("error"), async () => {
  await patch(`/api/sessions/${id}`, { before: byId("before").value || null });
  await show();
}, byId("before")));

byId("edit").addEventListener("click", () => attempt(byId("error"), async () => {
  const { subjects } = await get("/api/subjects");
  const name = h("input", { type: "text", required: true, maxlength: 120, value: summary.name });
  const subject = select({}, [["", words.unknown], ...subjects.map((one) => [one.id, one.code])], summary.subject ?? "");
  const side = select({}, [["", words.unknown], ["left", words.left], ["right", words.right]], summary.side ?? "");
  const visit = h("input", { type: "date", value: summary.visit });
  const content = h("div", { class: "fields" }, field(words.name, name), field(words.subject, subject), field(words.side, side), field(words.visit, visit));
  if (!(await ask(words.edit, content, { confirm: words.save, cancel: words.cancel }))) return;
  await patch(`/api/sessions/${id}`, { name: name.value.trim(), subject: subject.value || null, side: side.value || null, visit: visit.value || null });
  await show();
}));

byId("print").addEventListener("click", () => print());
for (const kind of ["html", "pdf"]) onClick(`report-${kind}`, byId("error"), () => download(`/api/sessions/${id}/report.${kind}${query({ language })}`, `leg.${kind}`));

/** A turned sign has its button where it is told: the trials are turned, and analysed again. */
async function offerToTurn() {
  const box = byId("error");
  const checked = await Promise.all(summary.recordings.map(async (one) => [one, (await get(`/api/recordings/${one}/quality`)).findings.find((f) => /-sign$/.test(f.code) && f.mend)]));
  const turned = checked.filter(([, finding]) => finding);
  if (!turned.length) return;
  const again = async () => {
    for (const [one, finding] of turned) await mend(one, finding);
    await post("/api/sessions", { recordings: summary.recordings });
    location.href = "/analyse";
  };
  const which = Object.keys(turned[0][1].mend.channels).map((role) => words[role]).join(", ");
  const knob = button(words.turn, () => attempt(box, again, knob), { class: "primary" });
  byId("turned").append(`${words.turned} (${which}; ${turned.length}/${summary.recordings.length}) `, knob);
  byId("turned").hidden = false;
}
attempt(byId("error"), async () => {
  await show();
  await offerToTurn();
});
