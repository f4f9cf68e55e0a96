import assert from "node:assert/strict";
import { test } from "node:test";

import { aligned } from "./js/plot/align.js";

test("series on one axis of time share it, gaps stay gaps", () => {
  const t = [0, 1, 2];
  assert.deepEqual(aligned([{ t, v: [1, null, 3] }, { t: [0, 1, 2], v: [4, 5, 6] }], [10]), [
    t, [10, null, 30], [4, 5, 6],
  ]);
});

test("series with times of their own are joined", () => {
  globalThis.uPlot = { join: (tables) => ({ joined: tables }) };
  const { joined } = aligned([{ t: [0, 1], v: [1, 2] }, { t: [0, 0.5], v: [3, 4] }], [1, 2]);
  assert.deepEqual(joined, [[[0, 1], [1, 2]], [[0, 0.5], [6, 8]]]);
});
