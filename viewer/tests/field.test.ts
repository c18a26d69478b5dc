import assert from "node:assert/strict";
import { test } from "node:test";

import { Ray, Vector3 } from "three";

import { round, AutoScale } from "../src/field/auto-scale";
import type { Plane, Triple } from "../src/feed/messages";
import { ticks } from "../src/space/axes";
import { across, AXES, hit, number, peak, range, value } from "../src/space/planes";

const CENTRE: Triple = [0.01, -0.02, 0.2];

/** Return the middle of a cell, computed as in the server. */
function cell(plane: Plane, row: number, column: number): Vector3 {
  const [rows, columns] = plane.shape;
  return new Vector3(...plane.centre)
    .addScaledVector(new Vector3(...plane.u), ((column + 0.5) / columns - 0.5) * plane.size[0])
    .addScaledVector(new Vector3(...plane.v), ((row + 0.5) / rows - 0.5) * plane.size[1]);
}

for (const axis of AXES) {
  test(`the value at the middle of a cell is that of the cell, across ${axis}`, () => {
    const plane = across(axis, CENTRE, 0.1, 5);
    const values = Float32Array.from({ length: 25 }, (_, k) => k * k);
    const eye = new Vector3(0.3, 0.5, 0.9);
    for (let k = 0; k < 25; k++) {
      const at = cell(plane, Math.floor(k / 5), k % 5);
      const found = hit(plane, new Ray(eye, at.clone().sub(eye).normalize()));
      assert.ok(found && found.at.distanceTo(at) < 1e-9);
      assert.ok(Math.abs(value(plane, values, found.s, found.t) - k * k) < 1e-3);
    }
    const n = number(axis);
    assert.equal(new Vector3(...plane.u).cross(new Vector3(...plane.v)).toArray().findIndex(Boolean), n);
  });
}

test("a ray misses a plane beside it, behind the eye and parallel to it", () => {
  const plane = across("z", CENTRE, 0.1, 5);
  const down = new Vector3(0, 0, -1);
  assert.equal(hit(plane, new Ray(new Vector3(0.2, 0, 1), down)), null);
  assert.equal(hit(plane, new Ray(new Vector3(0, 0, 0.1), down)), null);
  assert.equal(hit(plane, new Ray(new Vector3(0, 0, 0.2), new Vector3(1, 0, 0))), null);
});

test("values are linear between cells and constant beyond the last ones", () => {
  const plane: Plane = { ...across("z", CENTRE, 0.1, 2), shape: [2, 2] };
  const values = new Float32Array([0, 1, 2, 3]);
  assert.equal(value(plane, values, 0.5, 0.5), 1.5);
  assert.equal(value(plane, values, 0, 0), 0);
  assert.equal(value(plane, values, 1, 1), 3);
});

test("the peak is found at its position; NaN is ignored", () => {
  const plane = across("y", CENTRE, 0.08, 4);
  const values = new Float32Array(16).fill(1);
  values[0] = NaN;
  values[6] = -7;
  const { most, at } = peak(plane, values);
  assert.equal(most, 7);
  assert.ok(new Vector3(...at).distanceTo(cell(plane, 1, 2)) < 1e-9);
  assert.equal(peak(plane, new Float32Array(16).fill(NaN)).most, 0);
});

test("scales are round and not below the values seen", () => {
  for (const x of [1e-9, 0.0123, 0.99, 1, 1.0001, 7.7, 42, 999, 1e7]) {
    const top = round(x);
    assert.ok(top >= x * (1 - 1e-9) && top <= 1.7 * x, `${x}: ${top}`);
    assert.equal(round(top), top);
  }
  assert.equal(round(0), 1);
  assert.equal(round(NaN), 1);
});

test("a scale grows at once, shrinks slowly, and stays if it is fixed", () => {
  const scale = new AutoScale();
  assert.ok(scale.see(11, 0));
  assert.equal(scale.most, 15);
  assert.ok(!scale.see(9, 0.5));
  let time = 0.5;
  while (!scale.see(2, time)) time += 0.1;
  assert.ok(time > 1 && time < 5 && scale.most < 15);
  assert.ok(scale.see(2, 60), "after a minute without a slice, one slice is enough");
  assert.equal(scale.most, 2);
  scale.auto = false;
  assert.ok(!scale.see(500, 61));
});

test("axes enclose their range", () => {
  const found = ticks(-0.29, 0.23, 0.1);
  assert.ok((found[0] ?? 0) <= -0.29 && (found.at(-1) ?? 0) >= 0.23);
  assert.equal(found.length, 7);
  assert.deepEqual(ticks(0, 0.2, 0.1).map((x) => Math.round(10 * x)), [0, 1, 2]);
});

test("the range of errors includes 0; without a number there is no range", () => {
  assert.deepEqual(range(new Float32Array([NaN, -2, 1, NaN])), { low: -2, high: 1 });
  assert.deepEqual(range(new Float32Array([3, 4])), { low: 0, high: 4 });
  assert.equal(range(new Float32Array([NaN, NaN])), null);
  assert.equal(range(new Float32Array()), null);
});
