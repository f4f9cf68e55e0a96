// What the names of a leg's files say of it.

import assert from "node:assert/strict";
import test from "node:test";

import { dayIn, legOf } from "./js/ui/trials.js";

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

test("the day of a visit is read in figures, and with its month in each language", () => {
  const told = {
    "walk_2026-03-04.csv": "2026-03-04", "4 maart 2026/slow.csv": "2026-03-04", "4. März 2026.csv": "2026-03-04",
    "le 4 mars 2026.csv": "2026-03-04", "March 4, 2026.csv": "2026-03-04", "21st of August 2025": "2025-08-21",
    "12 août 2025": "2025-08-12", "1er juin 2026": "2026-06-01", "3 juillet 2026": "2026-07-03", "03_dez_2025": "2025-12-03",
    "5 mei 2026": "2026-05-05", "6 Mai 2026": "2026-05-06", "7 févr. 2026": "2026-02-07", "8 okt 2026": "2026-10-08",
  };
  for (const [name, day] of Object.entries(told)) assert.equal(dayIn(name), day, name);
  for (const name of ["trial 4", "4 walks 2026", "PL_50_01", "32 maart 2026"]) assert.equal(dayIn(name), undefined, name);
});
