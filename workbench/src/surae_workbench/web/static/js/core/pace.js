// How often things may happen.

/** Runs `work` with the last arguments only, one call at a time: the latest wins. */
export function latest(work) {
  let running = false;
  let waiting = null;
  return async function ask(...args) {
    if (running) {
      waiting = args;
      return;
    }
    running = true;
    try {
      await work(...args);
    } finally {
      running = false;
      if (waiting) {
        const next = waiting;
        waiting = null;
        ask(...next);
      }
    }
  };
}

/** Runs `work` once its callers have been quiet for so many milliseconds. */
export function settled(work, milliseconds) {
  let timer = 0;
  return (...args) => {
    clearTimeout(timer);
    timer = setTimeout(() => work(...args), milliseconds);
  };
}
