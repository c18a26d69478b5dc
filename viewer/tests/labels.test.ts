import assert from "node:assert/strict";
import { test } from "node:test";

import { Label, shorten, type Kept } from "../src/space/labels";

const WIDTH = 10; // of each character [px], in a texture with two pixels for each of the page's

/** A canvas that draws nothing. */
function canvas(): object {
  const context = { measureText: (text: string) => ({ width: 2 * WIDTH * text.length }), strokeText() {}, fillText() {} };
  return { getContext: () => context, width: 0, height: 0 };
}

Object.assign(globalThis, { document: { createElement: canvas } });

test("a long name is shortened, a short one is not", () => {
  for (const name of ["", "ball", "W".repeat(24), "漢".repeat(24)]) assert.equal(shorten(name), name);
  for (const letter of ["W", "漢", "👋"]) assert.equal(shorten(letter.repeat(64)), `${letter.repeat(23)}…`);
});

test("a label is shown if it overlaps none that is shown", () => {
  const kept: Kept[] = [];
  const show = (x: number, y: number): boolean => {
    const label = new Label("ball"); // 46 px by 17.4 px
    label.showIfClear({ x, y }, kept);
    return label.visible;
  };
  assert.deepEqual([show(0, 0), show(30, 5), show(50, 5), show(30, 20), show(60, -15)], [true, false, true, true, true]);
  assert.equal(kept.length, 4);
  assert.equal(show(0, 0), false);
});
