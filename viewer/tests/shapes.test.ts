import assert from "node:assert/strict";
import { test } from "node:test";

import { BufferGeometry, Vector3 } from "three";

import type { Bytes, Triple } from "../src/feed/messages";
import type { Part, Shape } from "../src/feed/objects";
import { way } from "../src/shapes/curves";
import { surface } from "../src/shapes/marching-cubes";
import { made, shaped } from "../src/shapes/geometry";

function packed(values: Iterable<number>, kind: Float32ArrayConstructor | Uint32ArrayConstructor = Float32Array): Bytes {
  return new Uint8Array(kind.from(values as never).buffer as ArrayBuffer);
}

/** Return the signed volume that a surface encloses [m^3]: positive if it faces outwards. */
function volume(geometry: BufferGeometry): number {
  const free = geometry.getIndex() ? geometry.toNonIndexed() : geometry;
  const p = free.getAttribute("position");
  let sum = 0;
  for (let k = 0; k < p.count; k += 3) {
    const [a, b, c] = [0, 1, 2].map((n) => new Vector3().fromBufferAttribute(p, k + n));
    if (a && b && c) sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

function near(found: number, expected: number, share = 0.02): void {
  assert.ok(Math.abs(found - expected) <= share * Math.abs(expected), `${found}, not ${expected}`);
}

const BALL = (4 / 3) * Math.PI * 0.03 ** 3;
const SPHERE = { type: "sphere", radius: 0.03 } as const;
const TETRAHEDRON = {
  type: "mesh",
  vertices: packed([0, 0, 0, 60, 0, 0, 0, 60, 0, 0, 0, 60]),
  faces: packed([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], Uint32Array),
  scale: 1e-3,
} as const;

test("marching cubes makes a closed ball that faces outwards, on a grid that is not a cube", () => {
  const shape: Triple = [30, 26, 40];
  const origin: Triple = [-0.05, -0.04, -0.07];
  const spacing = 0.0035;
  const values = new Float32Array(shape[0] * shape[1] * shape[2]);
  let k = 0;
  for (let i = 0; i < shape[0]; i++) {
    for (let j = 0; j < shape[1]; j++) {
      for (let l = 0; l < shape[2]; l++) {
        const p = [i, j, l].map((n, axis) => (origin[axis] ?? 0) + n * spacing);
        values[k++] = 0.1 - Math.hypot(...p);
      }
    }
  }
  const found = surface({ values, shape, origin, spacing }, 0.07);
  near(volume(found), BALL);
  const p = found.getAttribute("position");
  const n = found.getAttribute("normal");
  for (let v = 0; v < p.count; v++) {
    const at = new Vector3().fromBufferAttribute(p, v);
    assert.ok(Math.abs(at.length() - 0.03) < 2e-4);
    assert.ok(at.normalize().dot(new Vector3().fromBufferAttribute(n, v)) > 0.9);
  }
  const edges = new Map<string, number>();
  const index = [...(found.getIndex()?.array ?? [])];
  for (let f = 0; f < index.length; f += 3) {
    for (let e = 0; e < 3; e++) {
      const key = [index[f + e], index[f + ((e + 1) % 3)]].sort().join();
      edges.set(key, (edges.get(key) ?? 0) + 1);
    }
  }
  assert.ok([...edges.values()].every((count) => count === 2), "closed");
});

test("a level that no value reaches has no surface; NaN counts as 0", () => {
  const values = new Float32Array(27).fill(NaN);
  const grid = { values, shape: [3, 3, 3] as Triple, origin: [0, 0, 0] as Triple, spacing: 1 };
  assert.equal(surface(grid, 0.5).getAttribute("position").count, 0);
  values[13] = 1;
  near(volume(surface(grid, 0.5)), 1 / 6, 1e-6);
});

test("solids enclose the right volume, facing outwards", () => {
  const block = new Float32Array(6 ** 3).fill(1);
  const shapes: [Shape, number][] = [
    [SPHERE, BALL],
    [{ type: "box", size: [0.1, 0.02, 0.03] }, 6e-5],
    [{ type: "capsule", radius: 0.03, length: 0.05 }, BALL + Math.PI * 0.03 ** 2 * 0.05],
    [TETRAHEDRON, 0.06 ** 3 / 6],
    [
      { type: "placed", shape: SPHERE, pose: { position: [0.1, 0, 0], rotation: [0, 0, 0, 1] } },
      BALL,
    ],
    [
      {
        type: "union",
        parts: [
          SPHERE,
          { type: "placed", shape: SPHERE, pose: { position: [0.1, 0, 0], rotation: [0, 0, 0, 1] } },
        ],
      },
      2 * BALL,
    ],
    [{ type: "intersection", parts: [SPHERE, { type: "box", size: [0.1, 0.1, 0.03] }] }, 7.775e-5],
    [{ type: "difference", of: SPHERE, less: [{ type: "box", size: [0.1, 0.1, 0.03] }] }, BALL - 7.775e-5],
    [
      { type: "difference", of: { type: "box", size: [0.1, 0.1, 0.1] }, less: [TETRAHEDRON, SPHERE] },
      1e-3 - (7 / 8) * BALL - 0.06 ** 3 / 6,
    ],
    [
      { type: "voxels", values: packed(block), grid: [6, 6, 6], pitch: 0.01, level: 0.5 },
      0.06 ** 3 * 0.98,
    ],
  ];
  for (const [shape, expected] of shapes) near(volume(shaped(shape)), expected, 0.05);
});

test("a height map has the rows of a picture seen from +z", () => {
  const shape: Shape = {
    type: "height-map",
    heights: packed([5, 0, 0, 0, 0, 1]),
    grid: [2, 3],
    width: 0.2,
    height: 0.1,
    depth: 0.01,
  };
  const p = shaped(shape).getAttribute("position");
  const corner = [0, 1, 2].map((n) => p.array[n]);
  near(corner[0] ?? 0, -0.1);
  near(corner[1] ?? 0, 0.05); // the first row has the largest y
  near(corner[2] ?? 0, 0.05);
  near(p.getZ(5), 0.01);
  const n = shaped({ ...shape, heights: packed([0, 0, 0, 0, 0, 0]) }).getAttribute("normal");
  near(n.getZ(0), 1);
});

test("curves have the right length and size", () => {
  near(way({ type: "circle", radius: 0.02 }).getLength(), 2 * Math.PI * 0.02);
  near(way({ type: "line", length: 0.1 }).getLength(), 0.1);
  const square = packed([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
  near(way({ type: "polyline", points: square, closed: true }).getLength(), 4);
  near(way({ type: "polyline", points: square, closed: false }).getLength(), 3);
  const eight = way({ type: "lissajous", width: 0.08, height: 0.06, a: 1, b: 2, phase: 0 });
  const far = eight.getPoints(400).map(({ x, y }) => [Math.abs(x), Math.abs(y)]);
  near(Math.max(...far.map(([x]) => x ?? 0)), 0.04);
  near(Math.max(...far.map(([, y]) => y ?? 0)), 0.03);
});

test("an object that cannot be drawn gets an outline, without an error", () => {
  const far: Part = { type: "placed", shape: SPHERE, pose: { position: [1, 0, 0], rotation: [0, 0, 0, 1] } };
  const apart = made({ type: "volume", shape: { type: "intersection", parts: [SPHERE, far] } });
  assert.equal(apart.drawn, false);
  assert.ok(apart.reach > 1);
  const none = { type: "polyline", points: packed([0, 0, 0, 0, 0, 0]), closed: false } as const;
  assert.equal(made({ type: "path", shape: none, width: 0.01 }).drawn, false);
  assert.equal(made({ type: "surface", shape: { type: "unheard-of" } as never }).drawn, false);
});
