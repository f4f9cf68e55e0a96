// One job, followed until it ends.

import { get, post } from "../core/api.js";

/** What a job is doing before it counts. */
export const PHASES = {
  reading: "Reading",
  preparing: "Preparing the signals",
  compiling: "Compiling the model (only once)",
  fitting: "Fitting",
  assessing: "Working out the uncertainty",
};

/** How far a job is, in words: what is counted, or its phase. */
export const progressText = (told, what) =>
  told.total ? `${what}: ${told.done} of ${told.total}` : `${PHASES[told.phase] ?? "At work"} …`;

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
export const restart = (id) => post(`/api/jobs/${id}/restart`);

/** Jobs that run or wait, of one kind. */
export async function active(kind) {
  const { jobs } = await get("/api/jobs?active=true");
  return jobs.filter((job) => job.kind === kind);
}
