// A fit in short, as the page for clinicians has it: one sentence, a curve, a few numbers.

import { get, query } from "../core/api.js";
import { byId, h, replace, scroll, table } from "../core/dom.js";
import { attempt } from "../core/notice.js";
import { latest } from "../core/pace.js";

/** Show it in the language that is chosen; of two changes in a row the later stays. */
export const showShort = latest((id) =>
  attempt(byId("short-error"), async () => {
    const place = byId("short-page");
    if (!place.childElementCount) replace(place, h("p", { class: "muted" }, "Making it …"));
    const page = await get(`/api/fits/${id}/clinical${query({ language: byId("language").value })}`);
    place.lang = page.language;
    replace(place, content(page));
  }),
);

const content = (page) => [
  h("h2", {}, page.title),
  h("p", { class: "muted" }, page.question),
  h("p", { class: "answer" }, page.answer),
  h("p", {}, page.adequacy),
  page.reasons.length > 0 && h("ul", { lang: "en" }, page.reasons.map((text) => h("li", {}, text))),
  figure(page, "curve"),
  h("p", { class: "muted small" }, page.words.curve_note),
  page.images.shares && figure(page, "shares"),
  h("h3", {}, page.words.figures),
  answers(page),
  page.note && h("p", { class: "muted small" }, page.note),
  lines(page.words.norms, page.norms),
  lines(page.words.next, page.next),
  h("p", { class: "muted small" }, page.made),
];

const figure = (page, name) =>
  h("figure", { class: "drawn" }, h("figcaption", {}, page.words[name]), scroll(page.words[name], h("img", { src: page.images[name], alt: page.words[name] })));

const lines = (heading, texts) => texts.length > 0 && [h("h3", {}, heading), h("ul", {}, texts.map((text) => h("li", {}, text)))];

const answers = ({ words, heads, rows }) =>
  table(words.figures, heads, rows.map((row) => [row.name, ...row.cells, row.is_strong ? h("strong", {}, row.verdict) : row.verdict]), { caption: null });
