import assert from "node:assert/strict";
import { test } from "node:test";

import { SCALE_LAWS, opacity, place, shareAt } from "../src/field/scale-law";
import { advice } from "../src/panels/advice";
import { split } from "../src/panels/skip-reasons";

for (const law of SCALE_LAWS) {
  test(`positions on the ${law} bar and shares convert back and forth`, () => {
    for (const share of [0.002, 0.1, 0.5, 1]) assert.ok(Math.abs(shareAt(place(share, law), law) - share) < 1e-12);
    assert.equal(place(7, law), 1);
    assert.equal(place(0, law), 0);
  });
}

test("0 is transparent, the top is opaque, and opacity never decreases between them", () => {
  assert.equal(opacity(0), 0);
  assert.ok(opacity(1) > 0.9);
  for (let at = 0; at < 1; at += 0.01) assert.ok(opacity(at + 0.01) >= opacity(at));
});

test("each refusal has an advice", () => {
  for (const action of ["arm", "select", "stop", "slice", "nonesuch"]) assert.match(advice(action, "no"), /\.$/);
  assert.match(advice("select", "another client owns the output"), /^Take over/);
});

test("saved work is not a problem; an unknown reason is", () => {
  const { saved, problems } = split({ "missed ticks": 2, "solve, nothing moved": 9, strange: 3, halted: 0 });
  assert.deepEqual(saved.map(({ name }) => name), ["solve, nothing moved"]);
  assert.deepEqual(problems.map(({ name }) => name), ["strange", "missed ticks"]);
});
