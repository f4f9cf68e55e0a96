// Fits side by side; the address names them, so that it can be kept.

import { get, query } from "../core/api.js";
import { byId, h, replace, scroll } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { NONE, estimate, number, unitText, vaf, when } from "../core/format.js";
import { attempt } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { ranges } from "../plot/ranges.js";
import { meant, status, verdict } from "../ui/marks.js";

const SHAPES = ["●", "■", "▲", "◆"];
const box = byId("error");
let chosen = (new URLSearchParams(location.search).get("fits") ?? "").split(",").filter(Boolean);

function choose(id, wanted) {
  chosen = wanted ? [...chosen, id] : chosen.filter((one) => one !== id);
  history.replaceState(null, "", `/compare${query({ fits: chosen.join(",") })}`);
  showTable();
}

async function showChoice() {
  const { fits } = await get("/api/fits");
  chosen = chosen.filter((id) => fits.some((fit) => fit.id === id));
  replace(
    byId("choose"),
    fits.length
      ? h(
          "ul",
          { class: "list chosen" },
          fits.map((fit) =>
            h(
              "li",
              {},
              h("label", { class: "check" }, h("input", { type: "checkbox", checked: chosen.includes(fit.id), "data-focus": fit.id, on: { change: (event) => choose(fit.id, event.target.checked) } }), fit.name),
              h("span", { class: "muted small" }, [fit.title, `VAF ${vaf(fit.vaf)}`, when(fit.created)].join(" · ")),
            ),
          ),
        )
      : h("div", { class: "empty" }, h("p", {}, h("strong", {}, "No fits yet."), " Fit a recording first; two fits or more can be compared."), h("a", { class: "button", href: "/fit" }, "Go to Fit")),
  );
}

const showTable = latest(async () => {
  if (!chosen.length) {
    replace(byId("side"), h("p", { class: "muted" }, "Choose the fits above."));
    return;
  }
  const told = await attempt(box, () => get(`/api/compare${query({ fits: chosen.join(",") })}`));
  if (told) replace(byId("side"), table(told));
});

function table({ fits, parameters }) {
  const shape = (i) => SHAPES[i % SHAPES.length];
  return scroll(
    "Fits side by side",
    h(
      "table",
      { class: "comparison" },
      h("caption", {}, "Estimates with their 95 % intervals."),
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Parameter"), fits.map((fit, i) => h("th", { scope: "col" }, `${shape(i)} `, h("a", { href: `/fits/${fit.id}` }, fit.name))), h("th", { scope: "col" }, "Together"))),
      h(
        "tbody",
        {},
        h("tr", {}, h("th", { scope: "row" }, "Model"), fits.map((fit) => h("td", {}, fit.title)), h("td")),
        h("tr", {}, h("th", { scope: "row" }, "Status"), fits.map((fit) => h("td", {}, status(fit.status))), h("td")),
        h("tr", {}, h("th", { scope: "row" }, "VAF"), fits.map((fit) => h("td", {}, vaf(fit.vaf))), h("td")),
        h("tr", {}, h("th", { scope: "row" }, "IPDE"), fits.map((fit) => h("td", {}, number(fit.ipde, 3))), h("td")),
        parameters.map((p) => row(p)),
      ),
    ),
  );
}

function row(p) {
  return h(
    "tr",
    {},
    h("th", { scope: "row" }, meant(p.name), h("span", { class: "muted small" }, unitText(p.unit) && ` [${unitText(p.unit)}]`)),
    p.estimates.map((one) =>
      h("td", { class: "est" }, one ? [`${estimate(one.value, one.sem)} ${one.sem ? `± ${number(one.sem, 2)} ` : ""}`, verdict(one.verdict)] : NONE),
    ),
    h("td", { class: "range-cell" }, ranges(p.estimates, {}, `${p.name} of ${p.estimates.length} fits`)),
  );
}

onChanged(["fits"], () => attempt(box, showChoice));
attempt(box, async () => {
  await showChoice();
  await showTable();
});
