import assert from "node:assert/strict";
import { test } from "node:test";

import { Vector3 } from "three";

import { square } from "../src/field/skin-plane";
import type { Bytes, State } from "../src/feed/messages";

function bytes(values: number[], kind: typeof Float32Array | typeof Int32Array = Float32Array): Bytes {
  return new Uint8Array(kind.from(values).buffer as ArrayBuffer);
}

function state(points: number[][], normals: number[][], asked: number[], index: number[], force: number[]): State {
  return {
    points: bytes(points.flat()),
    normals: bytes(normals.flat()),
    asked: bytes(asked),
    index: bytes(index, Int32Array),
    felt: bytes(force.flatMap((f) => [f, 0, 0, 0])),
    objects: force.map((_, i) => `object ${i}`),
  } as unknown as State;
}

test("the square is perpendicular to the normal of the strongest contact, and contains all of it", () => {
  const down = [0, 0, -1];
  const points = [[0.1, 0, 0.2], [0.12, 0.01, 0.2], [0.11, 0.02, 0.203], [0, 0, 0.1]];
  const found = square(state(points, [down, down, down, down], [3, 3, 3, 5], [1, 1, 1, 0], [1, 1]));
  assert.ok(found);
  assert.equal(found.object, "object 1");
  const { centre, u, v, size } = found.plane;
  assert.ok(new Vector3(...u).cross(new Vector3(...v)).distanceTo(new Vector3(0, 0, -1)) < 1e-6);
  assert.ok(Math.abs(centre[2] - 0.201) < 1e-6);
  for (const point of points.slice(0, 3)) {
    const away = new Vector3(...(point as [number, number, number])).sub(new Vector3(...centre));
    for (const axis of [u, v]) assert.ok(Math.abs(away.dot(new Vector3(...axis))) < size[0] / 2 - 0.008);
  }
});

test("points alone have no square", () => {
  assert.equal(square(state([[0, 0, 0.1]], [[0, 0, 1]], [5], [0], [NaN])), null);
  assert.equal(square(state([], [], [], [], [])), null);
});
