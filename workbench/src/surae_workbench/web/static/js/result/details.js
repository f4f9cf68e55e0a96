// Settings, starts and files of a fit.

import { byId, h, replace, table } from "../core/dom.js";
import { number, rate, vaf } from "../core/format.js";

export function showDetails({ fit, settings, steps, made }) {
  const windows = Object.values(settings?.exclusions ?? {}).flat();
  replace(
    byId("made"),
    h("p", {}, fit.message),
    table("Recordings", ["Name", "Samples", "Rate", "VAF", "RMSE", "SHA-256"], fit.recordings.map((one) => [
      one.name, one.n.toLocaleString("en"), rate(one.rate_hz), vaf(one.vaf), `${number(one.rmse_Nm, 3)} Nm`, h("code", {}, `${(one.sha256 ?? "").slice(0, 12)}…`),
    ])),
    (steps ?? []).map((lines, i) =>
      lines && h("div", {}, h("h3", {}, `How the signals of ${fit.recordings[i]?.name ?? "it"} were prepared`), h("ul", {}, lines.map((line) => h("li", {}, line)))),
    ),
    table("Settings", ["Setting", "Value"], [
      ...made.map(({ label, value }) => [label, value]),
      ...(windows.length ? [["Left out", windows.map(([a, b]) => `${number(a)} to ${number(b)} s`).join(", ")]] : []),
    ]),
  );
}
