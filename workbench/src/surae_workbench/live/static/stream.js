// News and drawing that both pages share.

import { colour } from "../js/core/theme.js";

/** Listen to the server; `heard` has a function for each event, and `error` for a server that is gone. */
export function listen(url, heard) {
  const source = new EventSource(url);
  for (const [name, work] of Object.entries(heard)) {
    // The browser's own "open", at every new connection, carries nothing.
    source.addEventListener(name, (event) => work(event.data === undefined ? {} : JSON.parse(event.data)));
  }
  return source;
}

/** A canvas's context at the screen's own pixels, its size, and the page's colours. */
export function surface(canvas) {
  const ratio = devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height, colour };
}

/** A curve's value at a time, 0 outside of it. */
export function at(curve, values, t) {
  const { t: times } = curve;
  if (t < times[0] || t > times.at(-1)) return null;
  const step = times[1] - times[0];
  const place = (t - times[0]) / step;
  const index = Math.min(Math.floor(place), times.length - 2);
  const share = place - index;
  return values(index) * (1 - share) + values(index + 1) * share;
}
