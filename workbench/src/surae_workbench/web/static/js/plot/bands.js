// Spans of time: findings as bars above the lines, what is left out of the fit hatched behind them.

import { h } from "../core/dom.js";
import { colour } from "../core/theme.js";
import { _ } from "../core/words.js";

const COLOURS = { info: "accent", warning: "weak", error: "bad" };
const WORDS = { error: _("error"), warning: _("warning"), info: _("for information"), excluded: _("left out of the fit") };
/** Height of the bars; a graver finding's is higher, so that they are told apart in grey, too. */
const HEIGHTS = { info: 4, warning: 6, error: 8 };

/** A uPlot plugin that paints what `spans()` gives: [{start, end, kind}]. */
export function bands(spans) {
  function paint(u) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const { start, end, kind } of spans()) {
      const left = u.valToPos(start ?? u.scales.x.min, "x", true);
      const right = Math.max(u.valToPos(end ?? u.scales.x.max, "x", true), left + 2 * devicePixelRatio);
      if (kind === "excluded") {
        ctx.fillStyle = colour("band-excluded");
        ctx.fillRect(left, bbox.top, right - left, bbox.height);
        hatch(ctx, left, right, bbox);
      } else {
        ctx.fillStyle = colour(COLOURS[kind]);
        ctx.fillRect(left, bbox.top, right - left, HEIGHTS[kind] * devicePixelRatio);
      }
    }
    ctx.restore();
  }
  return { hooks: { drawClear: paint } };
}

/** What the bars and the hatching of some spans mean. */
export const bandsKey = (spans) =>
  Object.keys(WORDS)
    .filter((kind) => spans.some((one) => one.kind === kind))
    .map((kind) => h("li", {}, h("span", { class: `band-key ${kind}`, "aria-hidden": "true" }), WORDS[kind]));

function hatch(ctx, left, right, bbox) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(left, bbox.top, right - left, bbox.height);
  ctx.clip();
  ctx.strokeStyle = colour("muted");
  ctx.globalAlpha = 0.5;
  ctx.lineWidth = devicePixelRatio;
  ctx.beginPath();
  const step = 9 * devicePixelRatio;
  for (let x = left - bbox.height; x < right; x += step) {
    ctx.moveTo(x, bbox.top + bbox.height);
    ctx.lineTo(x + bbox.height, bbox.top);
  }
  ctx.stroke();
  ctx.restore();
}
