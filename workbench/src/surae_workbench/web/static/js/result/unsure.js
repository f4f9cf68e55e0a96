// What makes each parameter unsure, what the laboratory may have wrong, and which models were weighed.

import { get } from "../core/api.js";
import { button, byId, h, replace, table } from "../core/dom.js";
import { meant } from "../ui/marks.js";

export function showUnsure({ budget, laboratory, family, trials }, id) {
  replace(byId("budget"), h("p", {}, budget.text), helps(budget.helps), budget.helps.length > 0 && measureNext(id), budget.rows.length > 0 && [legend(budget), bars(budget), shares(budget)]);
  card("laboratory", laboratory, "The laboratory’s imperfections", () => [
    laboratory.rows.length > 0 && [
      h("p", { class: "muted small" }, `${laboratory.groups.map((pair) => pair.join(": ")).join("; ")}.`),
      texts("Imperfections", ["Imperfection", "Meaning", "Assumed", "Estimate", "95 % interval", "Unit", "Source"], laboratory.rows.map((r) => [r.name, r.meaning, r.prior, r.value, r.interval, r.unit || "–", r.told])),
    ],
    laboratory.zeros.length > 0 && h("p", {}, `Torque zero of each recording: ${laboratory.zeros.map((pair) => pair.join(" ")).join(", ")}.`),
  ]);
  card("family", family, "Which model the data support", () => [
    texts("Models that were weighed", ["Model", "Imperfections in it", "Probability"], family.models),
    family.variants.length > 0 && texts("Other sets of imperfections, in the intervals by their probability", ["Model", "Imperfections in it", "Probability"], family.variants),
  ]);
  card("trials", trials, "From trial to trial", () => [
    texts("Every parameter by recording", ["Parameter", "Unit", "Together", ...trials.recordings, "Spread"], trials.rows.map((r) => [r.name, r.unit || "–", r.value, ...r.each, r.spread])),
  ]);
}

function card(id, section, title, rest) {
  byId(id).hidden = !section;
  if (section) replace(byId(id), h("h2", {}, title), h("p", {}, section.text), rest());
}

const helps = (sentences) => sentences.length > 0 && h("div", {}, h("h3", {}, "What would help"), h("ul", {}, sentences.map((text) => h("li", {}, text))));

/** Which ready trial adds most, worked out when it is asked for. */
function measureNext(id) {
  const said = h("div", { role: "status", "aria-live": "polite" });
  const ask = button("Measure next", async () => {
    replace(said, h("p", { class: "muted" }, "Working it out …"));
    try {
      const { sentences } = await get(`/api/fits/${id}/next`);
      replace(said, sentences.map((text) => h("p", {}, text)));
    } catch (error) {
      replace(said, h("p", { class: "alert" }, error.message));
    }
  });
  return h("div", { class: "panel" }, h("div", { class: "button-row" }, ask), said);
}

const legend = ({ looks, sources }) =>
  h("ul", { class: "key-list", "aria-label": "Sources" }, sources.map((text, i) => h("li", {}, drawn("swatch", looks[i]), text)));

const bars = ({ looks, rows, alt }) =>
  h("div", { class: "shares", role: "img", "aria-label": alt }, rows.map((row) => [
    meant(row.name),
    h("span", { class: "bar" }, row.shares.map((share, i) => share > 0.002 && drawn("part", looks[i], share))),
    h("span", { class: "small nowrap" }, row.known),
  ]));

/** A surface in the look of a source; a style attribute would be refused. */
function drawn(kind, look, share = 0) {
  const element = h("span", { class: kind });
  element.style.background = look;
  element.style.flexGrow = share;
  return element;
}

const shares = ({ sources, rows }) => texts("Shares of the variance behind each 95 % interval", ["Parameter", "Known to", ...sources], rows.map((row) => [row.name, row.known, ...row.texts]));

const SYMBOLS = ["Parameter", "Imperfection"];
const texts = (caption, head, rows) =>
  table(caption, head, rows.map(([first, ...cells]) => [SYMBOLS.includes(head[0]) ? meant(first) : first, ...cells]));
