// Settings, starts and files of a fit.

import { byId, h, replace, scroll } from "../core/dom.js";
import { number, rate, vaf } from "../core/format.js";

export function showDetails({ fit, settings, steps }) {
  const plain = Object.entries(settings ?? {}).filter(([key, value]) => !["recordings", "mvc", "sliders", "exclusions", "parameters", "fixed", "free", "start", "bounds", "priors", "footplate_mass"].includes(key) && value !== null && value !== "" && !(typeof value === "object" && !Object.keys(value).length));
  const told = Object.entries(settings?.parameters ?? {});
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
        h("thead", {}, h("tr", {}, ["Name", "Samples", "Rate", "VAF", "RMSE", "sha256"].map((t) => h("th", { scope: "col" }, t)))),
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
          plain.map(([key, value]) => h("tr", {}, h("th", { scope: "row" }, key.replaceAll("_", " ")), h("td", {}, typeof value === "object" ? text(value) : String(value)))),
          told.map(([name, one]) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, text(one)))),
          windows.length > 0 && h("tr", {}, h("th", { scope: "row" }, "left out"), h("td", {}, windows.map(([a, b]) => `${number(a)} to ${number(b)} s`).join(", "))),
        ),
      ),
    ),
  );
}

const text = (value) => Object.entries(value).map(([key, one]) => `${key} ${typeof one === "object" && one ? `(${text(one)})` : one}`).join(", ");
