// Profiles of the likelihood: start them, watch them, draw them.

import { post } from "../core/api.js";
import { byId, h, replace } from "../core/dom.js";
import { quantity, unitText } from "../core/format.js";
import { attempt } from "../core/notice.js";
import { lines } from "../plot/lines.js";
import { onTheme } from "../core/theme.js";
import { active, jobControls, progressText } from "./jobs.js";
import { _, many } from "../core/words.js";

/** Rise of the deviance that ends a 95 % interval. */
const RISE = 3.841;

export function profiles(id, result, reread) {
  const box = byId("profile-error");
  const free = Object.entries(result().parameters).filter(([, p]) => p.free);
  replace(byId("profile-name"), h("option", { value: "" }, _("all free ones")), free.map(([name]) => h("option", { value: name }, name)));
  byId("profile-name").value = free[0]?.[0] ?? "";

  const { watch } = jobControls({ start: byId("profile-start"), stop: byId("profile-stop"), said: byId("profile-said") }, box, {
    progress: (report) => progressText(report, _("Profile of {name}", { name: report.parameter })),
    ended: ({ state }) => ({ done: _("The profile is done."), cancelled: _("Stopped.") })[state] ?? "",
    done: () => attempt(box, async () => {
      await reread();
      draw();
    }),
  });

  function draw() {
    const known = Object.entries(result().profiles);
    replace(byId("profile-plots"), known.length ? known.map(([name, one]) => card(name, one, result().parameters[name])) : h("p", { class: "empty" }, _("No profiles yet. Choose a parameter above, and compute its profile.")));
  }

  byId("profile-form").addEventListener("submit", (event) => {
    event.preventDefault();
    const name = byId("profile-name").value;
    attempt(box, async () => watch(await post(`/api/fits/${id}/profile`, { parameters: name ? [name] : null })));
  });
  draw();
  attempt(box, async () => {
    const running = (await active("profile")).find((one) => one.fit === id);
    if (running) watch(running);
  });
}

function card(name, profile, parameter) {
  const unit = parameter?.unit ?? "-";
  const panel = lines({
    title: _("Rise of the deviance"),
    height: 190,
    legend: true,
    x: { label: name, unit: unitText(unit) },
    series: [
      { label: _("profile"), colour: "series-1", width: 1.8, points: true },
      { label: _("95 % limit"), colour: "series-2", width: 1.4, dash: "dash" },
    ],
  });
  const order = profile.values.map((_, i) => i).sort((a, b) => profile.values[a] - profile.values[b]);
  panel.show([order.map((i) => profile.values[i]), order.map((i) => profile.delta[i]), order.map(() => profile.threshold ?? RISE)], null);
  onTheme(panel.redraw);
  const side = (value, none) => (value === null || value === undefined ? none : quantity(value, unit));
  const low = side(profile.lower, _("no lower limit"));
  const high = side(profile.upper, _("no upper limit"));
  return h(
    "article",
    { class: "card" },
    h("h3", {}, `${name} = ${quantity(parameter?.value, unit)}`),
    h("p", {}, _("95 % interval of the profile: {low} … {high}", { low, high })),
    profile.note && h("p", { class: "muted small" }, profile.note),
    panel.element,
    h("p", { class: "muted small" }, many("Over {name}, {n} fit", "Over {name}, {n} fits", profile.values.length, { name: unitText(unit) ? `${name} [${unitText(unit)}]` : name })),
  );
}
