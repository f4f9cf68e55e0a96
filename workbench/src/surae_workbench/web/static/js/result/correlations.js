// Which parameters trade off against each other.

import { byId, h, num, replace, scroll, table } from "../core/dom.js";
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
      ? table(
          "Strong correlations",
          ["Parameter", "With", "Correlation"],
          strong.map((one) => [one.a, one.b, num(number(one.value, 3))]),
          { caption: "Pairs whose correlation is 0.8 or more", numbers: [2, 2] },
        )
      : h("p", {}, "No two parameters are correlated by 0.8 or more: each can be told from the others."),
  );
}
