import assert from "node:assert/strict";
import { test } from "node:test";

import { Ray, Vector3 } from "three";

import type { Arrayed, Bytes, Frame } from "../src/feed/messages";
import { Hands } from "../src/space/hands";
import { radii } from "../src/space/ring-sizes";
import { Quads } from "../src/space/quads";
import { Transducers } from "../src/space/transducers";

function packed(values: number[], kind: Float32ArrayConstructor | Uint16ArrayConstructor = Float32Array): Bytes {
  return new Uint8Array(kind.from(values).buffer as ArrayBuffer);
}

function array(count: number, sizes: number[] | null): Arrayed {
  const places = Array.from({ length: 3 * count }, (_, k) => 0.01 * k);
  const positions = packed(places);
  return { positions, normals: positions, sound: sizes && { sizes: packed(sizes) } } as Arrayed;
}

function frame(levels: number[], amplitudes: number): Frame {
  const phase = packed(levels.map(() => 64), Uint16Array);
  return { phases: 256, amplitudes, phase, amplitude: packed(levels, Uint16Array) } as Frame;
}

/** Return an attribute at the first corner of each square. */
function firsts(geometry: Quads["geometry"], name: string, count: number): number[] {
  const attribute = geometry.getAttribute(name);
  return Array.from({ length: count }, (_, k) => attribute.getX(4 * k));
}

test("levels have the amplitudes that the server sends, or are evenly spaced", () => {
  for (const [sizes, wanted] of [
    [[0, 0.5, 0.75, 1], [0, 0.75, 1]],
    [[], [0, 2 / 3, 1]],
    [[0, 1], [0, 2 / 3, 1]], // for another number of levels
    [null, [0, 2 / 3, 1]],
  ] as const) {
    const shown = new Transducers();
    shown.place(array(3, sizes && [...sizes]));
    shown.show(frame([0, 2, 3], 4));
    const { geometry } = shown.mesh;
    const found = firsts(geometry, "amplitude", 3);
    wanted.forEach((size, k) => assert.ok(Math.abs((found[k] ?? NaN) - size) < 1e-6, `${found}`));
    assert.deepEqual(firsts(geometry, "phase", 3), [0.25, 0.25, 0.25]);
    assert.equal(shown.drive.most, 1);
    assert.ok(Math.abs(shown.drive.mean - wanted.reduce((a, b) => a + b, 0) / 3) < 1e-6);
  }
});

test("a frame with levels of no transducer, or of another number of them, is silent", () => {
  const shown = new Transducers();
  shown.place(array(3, null));
  for (const levels of [[1, 1], []]) {
    shown.show(frame([1, 1, 1], 2));
    assert.deepEqual(shown.drive, { mean: 1, most: 1 });
    shown.show(frame(levels, 2));
    assert.deepEqual(shown.drive, { mean: 0, most: 0 });
    assert.deepEqual(firsts(shown.mesh.geometry, "amplitude", 3), [0, 0, 0]);
  }
  shown.show(frame([0, 0, 0], 1)); // from a device with one level
  assert.deepEqual(shown.drive, { mean: 0, most: 0 });
});

test("there is room for any number of squares, each with four corners", () => {
  const squares = new Quads({ at: 3, size: 1 });
  for (const count of [1, 2, 50, 7]) {
    squares.resize(count);
    squares.write("at", Array.from({ length: 3 * count }, (_, k) => k));
    squares.write("size", Array.from({ length: count + 9 }, (_, k) => k)); // too many
    const { geometry } = squares;
    assert.equal(geometry.drawRange.count, 6 * count);
    for (let k = 0; k < 4 * count; k++) {
      const square = Math.floor(k / 4);
      assert.equal(geometry.getAttribute("at").getZ(k), 3 * square + 2);
      assert.equal(geometry.getAttribute("size").getX(k), square);
      assert.equal(Math.abs(geometry.getAttribute("corner").getX(k)), 1);
    }
    const index = geometry.getIndex();
    assert.equal(Math.max(...Array.from({ length: 6 * count }, (_, k) => index?.getX(k) ?? NaN)), 4 * count - 1);
  }
});

test("rings of samples close together are small; a single sample has the largest ring", () => {
  const points = Float32Array.from([
    ...[0, 0, 0, 0.004, 0, 0, 0.008, 0, 0, 0.008, 0, 0], // two at one place
    ...[0.001, 0, 0], // another object
    ...[0, 0, 0, 0, 0.0001, 0, 0, 0.0005, 0], // very close together
  ]);
  const found = [...radii(points, [0, 0, 0, 0, 1, 2, 2, 2], 0.0045)].map((each) => Math.round(1e5 * each));
  assert.deepEqual(found, [220, 220, 220, 220, 450, 70, 70, 70]);
  assert.deepEqual([...radii(Float32Array.of(1, 2, 3), [], 0.001)].map((each) => Math.round(1e5 * each)), [100]);
});

test("a hand covers what lies on a line through its skin, or beside it within the margin", () => {
  Object.assign(globalThis, { document: { createElement: () => ({ getContext: () => null }) } });
  const hands = new Hands();
  const seen = (x: number, margin: number): boolean => {
    const eye = new Vector3(0, -1, 0);
    return hands.covers(new Ray(eye, new Vector3(x, 1, 0).sub(eye).normalize()), margin);
  };
  assert.ok(!seen(0, 0)); // no hand
  hands.show(packed(Array.from({ length: 26 * 3 }, () => 0))); // all joints at the origin: a ball of 2 cm
  assert.deepEqual([0, 0.038, 0.044, -0.038].map((x) => seen(x, 0)), [true, true, false, true]);
  assert.deepEqual([0.044, 0.058, 0.064].map((x) => seen(x, 0.01)), [true, true, false]);
});
