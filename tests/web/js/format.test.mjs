import assert from "node:assert/strict";
import { test } from "node:test";

import { bytes, estimate, number, percent, quantity, shownAs, unitText, r2 } from "./js/core/format.js";

test("a number has the digits asked for, a true minus sign and powers in print style", () => {
  assert.equal(number(0.045312), "0.04531");
  assert.equal(number(-12.3456), "−12.35");
  assert.equal(number(0), "0");
  assert.equal(number(1234567, 3), "1.23·10⁶");
  assert.equal(number(-0.0000123, 2), "−1.2·10⁻⁵");
});

test("what is no number is a dash, with a unit too", () => {
  for (const nothing of [null, undefined, NaN, Infinity]) {
    assert.equal(number(nothing), "—");
    assert.equal(quantity(nothing, "Nm"), "—");
  }
});

test("units are written as they are printed, and a pure number has none", () => {
  assert.equal(quantity(2, "Nm", 1), "2 Nm");
  assert.equal(quantity(2, "-", 1), "2");
  assert.equal(unitText("rad/s2"), "rad/s²");
  assert.equal(unitText("uV"), "µV");
});

test("an estimate goes to the second digit of its standard error", () => {
  assert.equal(estimate(0.0453214, 0.000051), "0.045321");
  assert.equal(estimate(123.456, 7.2), "123.5");
  assert.equal(estimate(123.456, null), "123.5");
  assert.equal(estimate(null, 1), "—");
});

test("a VAF never rounds up to a perfect hundred", () => {
  assert.equal(r2(99.9999), "99.999 %");
  assert.equal(r2(98.25), "98.3 %");
  assert.equal(r2(-3.21), "−3.2 %");
  assert.equal(percent(null), "—");
});

test("signals are shown in units for the eye", () => {
  assert.deepEqual(shownAs("V"), { factor: 1e3, unit: "mV" });
  assert.equal(shownAs("rad").factor, 180 / Math.PI);
  assert.deepEqual(shownAs("Nm"), { factor: 1, unit: "Nm" });
  assert.equal(bytes(2_500_000), "2.50 MB");
});
