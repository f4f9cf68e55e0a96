// What the names of a leg's files say of it.

import assert from "node:assert/strict";
import test from "node:test";

import { legOf } from "./js/ui/trials.js";

test("side, day and code are guessed where all names say them alike", () => {
  assert.deepEqual(legOf(["S07_left_2026-03-02/a.csv", "S07_left_2026-03-02/b.csv"]), { side: "left", visit: "2026-03-02", code: "S07" });
  assert.deepEqual(legOf(["P12 rechts 20260302.mat"]), { side: "right", visit: "2026-03-02", code: "P12" });
});

test("what the names do not say, or not alike, is not guessed", () => {
  const nothing = { side: undefined, visit: undefined, code: undefined };
  assert.deepEqual(legOf(["a_left.csv", "b_right.csv"]), nothing);
  assert.deepEqual(legOf(["leftover 2026-99-99 PS5.csv"]), nothing);
  assert.deepEqual(legOf(["left and right.csv"]), nothing);
  assert.deepEqual(legOf([]), nothing);
});
