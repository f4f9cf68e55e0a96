// One job, followed until it ends.

import { get, post } from "../core/api.js";
import { attempt, complain } from "../core/notice.js";

/** What a job is doing before it counts. */
export const PHASES = {
  reading: "Reading",
  preparing: "Preparing the signals",
  compiling: "Compiling the model (only once)",
  fitting: "Fitting",
  assessing: "Working out the uncertainty",
};

/** How far a job is, in words: what is counted, or its phase. */
export const progressText = (report, what) =>
  report.total ? `${what}: ${report.done} of ${report.total}` : `${PHASES[report.phase] ?? "At work"} …`;

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
 * Gives a function that follows a job with these elements: `start` is off and `stop` there while it
 * is at work, `said` holds what `progress` and `ended` make of its news. Errors go to `box`.
 */
export function jobControls({ start, stop, said }, box, { progress, ended: text, done = () => null }) {
  let job = null;
  stop.addEventListener("click", () => job && attempt(box, () => cancel(job.id), stop));
  return function watch(found) {
    job = found;
    start.disabled = true;
    stop.hidden = false;
    follow(found.id, {
      state: (now) => now.state === "queued" && (said.textContent = "Waiting for another job …"),
      progress: (report) => (said.textContent = progress(report)),
      end: async (now) => {
        job = null;
        start.disabled = false;
        stop.hidden = true;
        said.textContent = text(now);
        if (now.state === "failed") complain(box, now.message);
        await done(now);
      },
    });
  };
}

/** Jobs that run or wait, of one kind. */
export async function active(kind) {
  const { jobs } = await get("/api/jobs?active=true");
  return jobs.filter((job) => job.kind === kind);
}
