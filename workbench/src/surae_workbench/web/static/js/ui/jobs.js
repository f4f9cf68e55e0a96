// One job, followed until it ends.

import { get, post } from "../core/api.js";
import { replace } from "../core/dom.js";
import { attempt, complain } from "../core/notice.js";
import { _ } from "../core/words.js";

/** What a job is doing before it counts. */
const PHASES = {
  reading: _("Reading …"),
  preparing: _("Preparing the signals …"),
  compiling: _("Compiling the model (only once) …"),
};

/** How far a job is, in words: what is counted, or its phase. */
export const progressText = (report, what) =>
  report.total ? _("{what}: {done} of {total}", { ...report, what }) : PHASES[report.phase] ?? _("At work …");

const ENDED = ["done", "failed", "cancelled", "interrupted"];
export const ended = (job) => ENDED.includes(job.state);

/**
 * Follow a job; the stream comes back by itself after a break.
 *
 * @param handlers {state(job), progress(data), end(job)}
 * @returns a function that stops following
 */
export function follow(id, handlers) {
  const source = new EventSource(`/api/jobs/${id}/events`);
  const stop = () => source.close();
  let over = false;
  const finish = (job) => {
    if (over) return;
    over = true;
    stop();
    handlers.end?.(job);
  };
  source.addEventListener("state", (event) => {
    const job = JSON.parse(event.data);
    handlers.state?.(job);
    if (ended(job)) finish(job);
  });
  source.addEventListener("progress", (event) => handlers.progress?.(JSON.parse(event.data)));
  source.addEventListener("end", (event) => finish(JSON.parse(event.data)));
  source.addEventListener("error", () => {
    if (source.readyState === EventSource.CLOSED && !over) {
      get(`/api/jobs/${id}`).then((job) => ended(job) && finish(job)).catch(() => null);
    }
  });
  addEventListener("pagehide", stop);
  return stop;
}

export const cancel = (id) => post(`/api/jobs/${id}/cancel`);

/**
 * Follows a job with these elements: `start` is off, `stop`, the `bar` and the `line` are there while
 * it is at work; the line holds what `progress` makes of its news, `said`, which is read aloud, what
 * `ended` does. Where there is no line, `said` holds both. Errors go to `box`.
 *
 * @returns {watch(job), busy()}
 */
export function jobControls({ start, stop, said, bar = null, line = null }, box, { progress, ended: text, done = () => null }) {
  let job = null;
  const working = (found) => {
    job = found;
    start.disabled = job !== null;
    stop.hidden = job === null;
    for (const one of [bar, line]) if (one) one.hidden = job === null;
  };
  const heard = (report) => {
    (line ?? said).textContent = progress(report);
    if (bar && report.total) bar.value = report.done / report.total;
  };
  stop.addEventListener("click", () => job && attempt(box, () => cancel(job.id), stop));
  function watch(found) {
    working(found);
    bar?.removeAttribute("value");
    said.textContent = _("At work …");
    follow(found.id, {
      state: (now) => {
        if (now.state === "queued") (line ?? said).textContent = _("Waiting, {n} in line", { n: now.position ?? 1 });
        if (now.progress) heard(now.progress);
      },
      progress: heard,
      end: async (now) => {
        working(null);
        replace(said, text(now));
        if (now.state === "failed") complain(box, now.message);
        await done(now);
      },
    });
  }
  return { watch, busy: () => job !== null };
}

/** Jobs that run or wait, of one kind or of all. */
export async function active(kind = null) {
  const { jobs } = await get("/api/jobs?active=true");
  return jobs.filter((job) => kind === null || job.kind === kind);
}
