import assert from "node:assert/strict";
import { test } from "node:test";

import { forTrial, trialsAmong, trialsWithin } from "./js/ui/trials.js";

const file = (id, name, columns, roles) => ({
  id, name, columns: columns.map((column) => ({ name: column })), mapping: { channels: roles },
});
const angle = { upload: "1", column: "crank", sign: -1 };
const one = file("1", "walk.1.csv", ["crank", "load"], { angle });
const two = file("2", "run.csv", ["crank", "load"], { angle: { ...angle, upload: "2" } });
const emg = file("3", "emg.csv", ["ta"], { emg_ta: { upload: "3", column: "ta" } });

test("files that each hold an angle are trials, parts of one recording are not", () => {
  assert.deepEqual(trialsAmong([one, two]), [one, two]);
  assert.deepEqual(trialsAmong([one, emg]), []);
  assert.deepEqual(trialsAmong([one]), []);
});

test("a trial is described as the first is, by its own file and name", () => {
  const made = forTrial(two, { name: "x", emg: "raw", channels: { angle } });
  assert.deepEqual(made, { name: "run", emg: "raw", channels: { angle: { ...angle, upload: "2" } } });
  assert.equal(forTrial(one, { name: "x", channels: { angle } }).name, "walk.1");
  assert.throws(() => forTrial(emg, { channels: { angle } }), /no column crank/);
});

test("trials within one file keep its columns, and each has its own name and place in it", () => {
  const within = trialsWithin({ ...one, trials: [{ name: "walk-1.5", trial: { column: "rep", index: 1 } }] });
  assert.equal(within.length, 1);
  assert.deepEqual(trialsWithin(two), []);
  const made = forTrial(within[0], { name: "x", trial: { column: "rep", index: 3 }, channels: { angle } });
  assert.deepEqual(made, { name: "walk-1.5", trial: { column: "rep", index: 1 }, channels: { angle } });
});
