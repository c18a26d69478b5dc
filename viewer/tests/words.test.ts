import assert from "node:assert/strict";
import { test } from "node:test";

import { SCALE_LAWS, opacity, place, shareAt } from "../src/field/scale-law";
import { advice } from "../src/panels/advice";
import { digits, trimmed } from "../src/panels/format";
import { forPage } from "../src/panels/silence";
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

test("numbers have no zeros at their end, but keep those before the point, and their power of ten", () => {
  const wanted = { 0: "0", 2: "2", 20: "20", 1.5: "1.5", 0.75: "0.75", "-150": "−150", 1e12: "1e+12", 7.5e11: "7.5e+11", 1e-10: "1e−10" };
  for (const [x, text] of Object.entries(wanted)) {
    assert.equal(trimmed(Number(x)), text);
    assert.equal(parseFloat(text.replace("−", "-")), parseFloat(digits(Number(x)).replace("−", "-")));
  }
});

test("each refusal has an advice", () => {
  for (const action of ["arm", "select", "slice", "nonesuch"]) assert.match(advice(action, "no"), /\.$/);
  assert.match(advice("select", "another client owns the output"), /^Take over/);
});

test("an advice for clients names the controls of the page", () => {
  assert.equal(forPage("stopped by an emergency stop: reset the server, then arm again"), "stopped by an emergency stop: press Reset, then arm again");
  assert.equal(forPage("arm with `take`"), "press Take over");
  assert.match(forPage("renew from the game's own tick, and arm again"), /^keep this page in view/);
  assert.equal(forPage("start `pacinian serve`"), "start pacinian serve");
});

test("saved work is not a problem; an unknown reason is", () => {
  const { saved, problems } = split({ "missed ticks": 2, "solve, nothing moved": 9, strange: 3, halted: 0 });
  assert.deepEqual(saved.map(({ name }) => name), ["solve, nothing moved"]);
  assert.deepEqual(problems.map(({ name }) => name), ["strange", "missed ticks"]);
});
