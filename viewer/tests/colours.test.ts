import assert from "node:assert/strict";
import { test } from "node:test";

import { Color, LinearSRGBColorSpace } from "three";

import { COLOURS, css, cyclic, diverging, phased, viridis } from "../src/colours/maps";
import { byte, linear, oklab, part, type Colour } from "../src/colours/oklab";

/** Linear sRGB as seen by people who lack one kind of cone (Machado, Oliveira and Fernandes, 2009). */
const EYES: Record<string, readonly Colour[]> = {
  normal: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
}; // prettier-ignore

function seen(map: Uint8Array, eye: readonly Colour[]): Colour[] {
  return Array.from({ length: COLOURS }, (_, k) => {
    const c = [...map.subarray(4 * k, 4 * k + 3)].map(part);
    const cones = eye.map((row) => row.reduce((sum, weight, n) => sum + weight * (c[n] ?? 0), 0));
    return oklab(cones.map((x) => Math.min(Math.max(x, 0), 1)) as Colour);
  });
}

function apart(a: Colour | undefined, b: Colour | undefined): number {
  return a && b ? Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) : NaN;
}

for (const [name, eye] of Object.entries(EYES)) {
  test(`phases a quarter turn apart look different, with ${name}`, () => {
    const colours = seen(cyclic(), eye);
    for (let i = 0; i < COLOURS; i++) {
      for (let away = COLOURS / 4; away <= COLOURS / 2; away++) {
        const d = apart(colours[i], colours[(i + away) % COLOURS]);
        assert.ok(d > 0.1, `${i} and ${i + away}: ${d}`);
      }
    }
  });

  test(`higher pressure is lighter, with ${name}`, () => {
    const light = seen(viridis(), eye).map(([L]) => L);
    for (let k = 16; k < COLOURS; k++) {
      assert.ok((light[k] ?? 0) > (light[k - 16] ?? 1) + 0.01, `${k}`);
    }
  });

  test(`larger errors are darker, and both signs look different, with ${name}`, () => {
    const colours = seen(diverging(), eye);
    const light = colours.map(([L]) => L);
    for (let k = 16; k < COLOURS / 2; k++) {
      assert.ok((light[k] ?? 0) > (light[k - 16] ?? 1) + 0.01, `${k}`);
      assert.ok((light[COLOURS - 1 - k] ?? 0) > (light[COLOURS - 1 - k + 16] ?? 1) + 0.01, `${k}`);
      const d = apart(colours[k - 16], colours[COLOURS - 1 - k + 16]);
      if (k < COLOURS / 4) assert.ok(d > 0.1, `${k}: ${d}`);
    }
  });
}

test("the map of phases has no seam, and a screen can show all of it", () => {
  const colours = seen(cyclic(), EYES["normal"] ?? []);
  const steps = colours.map((colour, k) => apart(colour, colours[(k + 1) % COLOURS]));
  assert.ok(Math.max(...steps) < 3 * (steps.reduce((a, b) => a + b) / COLOURS));
  for (let k = 0; k < COLOURS; k++) {
    for (const x of linear(phased((2 * Math.PI * k) / COLOURS))) assert.ok(x >= 0 && x <= 1);
  }
});

test("conversion to OKLab and back changes nothing; white is light and has no hue", () => {
  const [L, a, b] = oklab([1, 1, 1]);
  assert.ok(Math.abs(L - 1) < 1e-6 && Math.hypot(a, b) < 1e-6);
  const c: Colour = [0.2, 0.7, 0.05];
  linear(oklab(c)).forEach((x, k) => assert.ok(Math.abs(x - (c[k] ?? NaN)) < 1e-5));
  for (let x = 0; x < 256; x++) assert.equal(byte(part(x)), x);
});

test("an error of 0 is white, too little is blue, too much is red", () => {
  const map = diverging();
  const [blue, white, red] = [0, 128, 255].map((k) => [...map.subarray(4 * k, 4 * k + 3)]);
  assert.ok(Math.min(...(white ?? [])) > 235);
  assert.ok((blue?.[2] ?? 0) > 2 * (blue?.[0] ?? 1));
  assert.ok((red?.[0] ?? 0) > 2 * (red?.[2] ?? 1));
});

test("viridis begins and ends with its published colours, and is constant beyond its ends", () => {
  const map = viridis();
  assert.equal(css(map, 0), "rgb(68, 1, 84)");
  assert.equal(css(map, 1), "rgb(253, 231, 37)");
  const colour = new Color().setStyle(css(map, 1), LinearSRGBColorSpace); // without conversion by three
  assert.deepEqual(colour.toArray().map((x) => Math.round(255 * x)), [253, 231, 37]);
  assert.equal(css(map, -3), css(map, 0));
  assert.equal(css(map, 7), css(map, 1));
});
