// Fits side by side; the address names them, so that it can be kept.

import { get, query } from "../core/api.js";
import { byId, empty, h, replace, table, tick } from "../core/dom.js";
import { onChanged } from "../core/events.js";
import { NONE, estimate, number, unitText, vaf, when } from "../core/format.js";
import { attempt } from "../core/notice.js";
import { latest } from "../core/pace.js";
import { ranges } from "../plot/ranges.js";
import { paged } from "../ui/paged.js";
import { meant, status, verdict } from "../ui/marks.js";

const SHAPES = ["●", "■", "▲", "◆"];
const box = byId("error");
let chosen = (new URLSearchParams(location.search).get("fits") ?? "").split(",").filter(Boolean);

function choose(id, wanted) {
  chosen = wanted ? [...chosen, id] : chosen.filter((one) => one !== id);
  history.replaceState(null, "", `/compare${query({ fits: chosen.join(",") })}`);
  showTable();
}

const pages = paged("fits", () => attempt(box, showChoice), () => chosen);
const showChoice = latest(async () => {
  const { rows: fits, none } = await pages.read();
  if (pages.element.hidden) chosen = chosen.filter((id) => fits.some((fit) => fit.id === id));
  replace(
    byId("choose"),
    pages.element,
    !none
      ? h("ul", { class: "list chosen" }, fits.map((fit) =>
          h(
            "li",
            {},
            tick(fit.name, chosen.includes(fit.id), (wanted) => choose(fit.id, wanted), { "data-focus": fit.id }),
            h("span", { class: "muted small" }, [fit.title, `VAF ${vaf(fit.vaf)}`, when(fit.created)].join(" · ")),
          ),
        ))
      : empty("No fits yet.", "Fit a recording first; two fits or more can be compared.", h("a", { class: "button", href: "/fit" }, "Go to Fit")),
  );
});

const showTable = latest(async () => {
  if (!chosen.length) {
    replace(byId("side"), h("p", { class: "muted" }, "Choose the fits above."));
    return;
  }
  const told = await attempt(box, () => get(`/api/compare${query({ fits: chosen.join(",") })}`));
  if (told) replace(byId("side"), beside(told));
});

function beside({ fits, parameters }) {
  const heads = fits.map((fit, i) => [`${SHAPES[i % SHAPES.length]} `, h("a", { href: `/fits/${fit.id}` }, fit.name)]);
  const of = (name, show) => [name, ...fits.map(show), ""];
  return table("Fits side by side", ["Parameter", ...heads, "Together"], [
    of("Model", (fit) => fit.title),
    of("Status", (fit) => status(fit.status)),
    of("VAF", (fit) => vaf(fit.vaf)),
    of("IPDE", (fit) => number(fit.ipde, 3)),
    ...parameters.map(estimates),
  ], { class: "comparison", caption: "Estimates with their 95 % intervals." });
}

const estimates = (p) => [
  [meant(p.name), h("span", { class: "muted small" }, unitText(p.unit) && ` [${unitText(p.unit)}]`)],
  ...p.estimates.map((one) =>
    h("td", { class: "est" }, one ? [`${estimate(one.value, one.sem)} ${one.sem ? `± ${number(one.sem, 2)} ` : ""}`, verdict(one.verdict)] : NONE),
  ),
  h("td", { class: "range-cell" }, ranges(p.estimates, {}, `${p.name} of ${p.estimates.length} fits`)),
];

onChanged(["fits"], () => attempt(box, showChoice));
attempt(box, async () => {
  await showChoice();
  await showTable();
});
