import assert from "node:assert/strict";
import { test } from "node:test";

import { changeOf, inPlace, valueOf } from "./js/ui/settings.js";

const nuisances = { path: ["nuisances"], default: "all", needs: "model=auto" };
const starts = { path: ["starts"], default: 8, needs: "model!=auto" };
const bessel = { path: ["preparation", "bessel_hz"], default: 20, needs: "" };
const peaks = { path: ["weights", "peaks"], default: 0, needs: "" };
const draft = { model: "auto", starts: 3, weights: null, preparation: { rate_hz: 128, bessel_hz: false } };

test("a setting is shown where it has an effect", () => {
  assert.equal(inPlace(starts, draft), false);
  assert.equal(inPlace(starts, { ...draft, model: "muscle" }), true);
  assert.equal(inPlace(bessel, draft), true);
  assert.equal(inPlace(nuisances, draft), true);
  assert.equal(inPlace(nuisances, { ...draft, model: "muscle" }), false);
});

test("a setting may be a key of the draft or lie within one", () => {
  assert.equal(valueOf(starts, draft), 3);
  assert.equal(valueOf(bessel, draft), false);
  assert.equal(valueOf(peaks, draft), null);
});

test("a change keeps what stands beside it; nothing is the default", () => {
  assert.deepEqual(changeOf(starts, null, draft), { starts: 8 });
  assert.deepEqual(changeOf(bessel, 10, draft), { preparation: { rate_hz: 128, bessel_hz: 10 } });
  assert.deepEqual(changeOf(bessel, null, draft), { preparation: { rate_hz: 128 } });
  assert.deepEqual(changeOf(peaks, 4, draft), { weights: { peaks: 4 } });
});
