// Settings, starts and files of a fit.

import { byId, h, replace, scroll } from "../core/dom.js";
import { number, rate, vaf } from "../core/format.js";

export function showDetails({ fit, settings, steps, made }) {
  const windows = Object.values(settings?.exclusions ?? {}).flat();
  replace(
    byId("made"),
    h("p", {}, fit.message),
    scroll(
      "Recordings",
      h(
        "table",
        {},
        h("caption", {}, "Recordings"),
        h("thead", {}, h("tr", {}, ["Name", "Samples", "Rate", "VAF", "RMSE", "SHA-256"].map((t) => h("th", { scope: "col" }, t)))),
        h("tbody", {}, fit.recordings.map((one) => h("tr", {}, h("th", { scope: "row" }, one.name), h("td", {}, one.n.toLocaleString("en")), h("td", {}, rate(one.rate_hz)), h("td", {}, vaf(one.vaf)), h("td", {}, `${number(one.rmse_Nm, 3)} Nm`), h("td", {}, h("code", {}, `${(one.sha256 ?? "").slice(0, 12)}…`))))),
      ),
    ),
    (steps ?? []).map((lines, i) =>
      lines && h("div", {}, h("h3", {}, `How the signals of ${fit.recordings[i]?.name ?? "it"} were prepared`), h("ul", {}, lines.map((line) => h("li", {}, line)))),
    ),
    scroll(
      "Settings",
      h(
        "table",
        {},
        h("caption", {}, "Settings"),
        h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Setting"), h("th", { scope: "col" }, "Value"))),
        h(
          "tbody",
          {},
          made.map(({ label, value }) => h("tr", {}, h("th", { scope: "row" }, label), h("td", {}, value))),
          windows.length > 0 && h("tr", {}, h("th", { scope: "row" }, "Left out"), h("td", {}, windows.map(([a, b]) => `${number(a)} to ${number(b)} s`).join(", "))),
        ),
      ),
    ),
  );
}
