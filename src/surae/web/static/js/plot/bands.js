// Spans of time behind the lines: findings and what is left out of the fit.

import { colour } from "./colours.js";

const STROKES = { info: "accent", warning: "weak", error: "bad", excluded: "muted" };

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
      const all = kind !== "excluded" && left <= bbox.left && right >= bbox.left + bbox.width;
      ctx.fillStyle = colour(`band-${kind}`);
      // What holds for all of the signal is said by the bar alone: nothing stands out in a full plot.
      if (!all) ctx.fillRect(left, bbox.top, right - left, bbox.height);
      if (kind === "excluded") hatch(ctx, left, right, bbox);
      else {
        // A bar on top: findings are seen without their colour, too.
        ctx.fillStyle = colour(STROKES[kind]);
        ctx.fillRect(left, bbox.top, right - left, 3 * devicePixelRatio);
      }
    }
    ctx.restore();
  }
  return { hooks: { drawClear: paint } };
}

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
