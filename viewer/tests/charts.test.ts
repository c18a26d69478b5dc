import assert from "node:assert/strict";
import { test } from "node:test";

import { History } from "../src/panels/history";

test("values over the last half minute, without growing", () => {
  const history = new History(2);
  for (let k = 0; k <= 3000; k++) history.add(k / 30, k, -k);
  const [times, first, second] = history.data as unknown as number[][];
  assert.ok(times && first && second);
  assert.equal(times.length, first.length);
  assert.equal(times.at(-1), 0);
  assert.ok((times[0] ?? 0) >= -30 && times.length > 290 && times.length < 310);
  assert.equal(first.at(-1), 3000);
  assert.equal(second.at(-1), -3000);
});

test("no line over a gap; what comes too soon does not count; a time that goes back begins anew", () => {
  const history = new History(1);
  history.add(1, 5);
  history.add(1, 6);
  history.add(4, 7);
  assert.deepEqual(history.data, [[-3, -1.5, 0], [5, null, 7]]);
  history.add(2, 8);
  assert.deepEqual(history.data, [[0], [8]]);
});
