import assert from "node:assert/strict";
import { mock, test } from "node:test";

import { latest, settled } from "./js/core/pace.js";

const soon = () => new Promise((done) => setImmediate(done));

test("of calls while one runs, only the latest is made", async () => {
  const seen = [];
  const release = [];
  const ask = latest((x) => new Promise((done) => (seen.push(x), release.push(done))));
  ask(1);
  ask(2);
  ask(3);
  assert.deepEqual(seen, [1]);
  release[0]();
  await soon();
  assert.deepEqual(seen, [1, 3]);
});

test("a call that fails does not hold up the next", async () => {
  const seen = [];
  const ask = latest(async (x) => {
    seen.push(x);
    if (x === 1) throw new Error("refused");
  });
  await assert.rejects(ask(1));
  await ask(2);
  assert.deepEqual(seen, [1, 2]);
});

test("work that settles runs once its callers are quiet, with the last arguments", () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  const seen = [];
  const ask = settled((x) => seen.push(x), 100);
  ask(1);
  mock.timers.tick(60);
  ask(2);
  mock.timers.tick(60);
  assert.deepEqual(seen, []);
  mock.timers.tick(40);
  assert.deepEqual(seen, [2]);
  mock.timers.reset();
});
