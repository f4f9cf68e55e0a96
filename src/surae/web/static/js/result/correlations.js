// Which parameters trade off against each other.

import { byId, h, replace, scroll } from "../core/dom.js";
import { number } from "../core/format.js";
import { correlations, pairs } from "../plot/heat.js";

export function showCorrelations({ fit }) {
  const names = fit.correlation?.names ?? [];
  if (names.length < 2) {
    replace(byId("correlation-map"), h("p", { class: "muted" }, "There are no correlations: fewer than two parameters have an uncertainty."));
    replace(byId("correlation-list"));
    return;
  }
  replace(
    byId("correlation-map"),
    scroll("Correlation map", correlations(names, fit.correlation.matrix)),
    h("p", { class: "muted small" }, "Blue: estimates go up together. Red: one goes up as the other goes down. Numbers from 0.5."),
  );
  const strong = pairs(names, fit.correlation.matrix);
  replace(
    byId("correlation-list"),
    strong.length
      ? scroll(
          "Strong correlations",
          h(
            "table",
            {},
            h("caption", {}, "Pairs whose correlation is 0.8 or more"),
            h("thead", {}, h("tr", {}, ["Parameter", "With", "Correlation"].map((t, i) => h("th", { scope: "col", class: i === 2 ? "num" : null }, t)))),
            h("tbody", {}, strong.map((one) => h("tr", {}, h("th", { scope: "row" }, one.a), h("td", {}, one.b), h("td", { class: "num" }, number(one.value, 3))))),
          ),
        )
      : h("p", {}, "No two parameters are correlated by 0.8 or more: each can be told from the others."),
  );
}
