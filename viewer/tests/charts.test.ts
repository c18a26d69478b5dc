import assert from "node:assert/strict";
import { test } from "node:test";

import { ChartSeries } from "../src/panels/chart-series";

test("the history keeps half a minute, and does not grow", () => {
  const series = new ChartSeries(["mean", "max"]);
  for (let k = 0; k <= 3000; k++) series.add(k / 30, k, k);
  const [times, first, second] = series.data as unknown as number[][];
  assert.ok(times && first && second);
  assert.equal(times.length, first.length);
  assert.ok((times[0] ?? 0) >= -30 && times.length > 115 && times.length < 125);
  assert.equal(second.at(-1), 3000);
  assert.ok(Math.abs((first.at(-1) ?? 0) - 2985) < 5, String(first.at(-1))); // the mean of the last second
});

test("a modulation shows as its mean and its maximum, not as beats", () => {
  const series = new ChartSeries(["mean", "max"]);
  const strength = (t: number): number => 0.5 - 0.5 * Math.cos(2 * Math.PI * 29.7 * t);
  for (let k = 0; k < 300; k++) series.add(k / 30 + 0.02 * ((k * 0.618) % 1), strength(k / 30 + 0.02 * ((k * 0.618) % 1)), strength(k / 30 + 0.02 * ((k * 0.618) % 1)));
  const [, mean, max] = series.data as unknown as number[][];
  for (const each of mean?.slice(4) ?? []) assert.ok(Math.abs(each - 0.5) < 0.25, String(each));
  for (const each of max?.slice(4) ?? []) assert.ok(each > 0.7, String(each));
});

test("the line is broken by NaN and by a gap; a time that goes back restarts the history", () => {
  const series = new ChartSeries(["mean"]);
  series.add(1, 5);
  series.add(1.1, 7);
  series.add(1.3, NaN);
  series.add(4, 7);
  assert.deepEqual(series.data, [[-3, -2.7, -1.35, 0], [6, null, null, 7]]);
  series.add(2, 8);
  assert.deepEqual(series.data, [[0], [8]]);
});
