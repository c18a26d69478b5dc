/** Values of the last seconds, for a chart: the mean or the maximum of each short interval. */

import type { AlignedData } from "uplot";

export const SPAN = 30; // time that the charts show [s]; also in core/pacinian/viewing/history.py
const POINT_INTERVAL = 0.25; // interval of one point of the chart, one or two pixels wide [s]
const POINT_WINDOW = 1; // time that each point covers [s]; the mean of fewer frames of a modulation would scatter
const MAX_STEP_BACK = 0.2; // largest step back between messages [s]
const MIN_GAP = 1; // time without values from which the line is broken [s]

export type Kind = "mean" | "max";

export class ChartSeries {
  private readonly times: number[] = [];
  private readonly values: (number | null)[][];
  /** Number of values in each bin. */
  private readonly counts: number[][];
  private last: number | undefined;

  constructor(private readonly kinds: readonly Kind[]) {
    this.values = kinds.map(() => []);
    this.counts = kinds.map(() => []);
  }

  /**
   * Add values. moment: by the server's clock [s]; if it lies more than MAX_STEP_BACK before the last one, the history starts
   * again. A value that is not finite leaves a gap.
   */
  add(moment: number, ...values: number[]): void {
    if (this.last !== undefined && moment < this.last - MAX_STEP_BACK) this.clear();
    const { last } = this;
    const time = Math.max(moment, last ?? moment);
    if (last !== undefined && time - last > MIN_GAP) this.push((last + time) / 2);
    const bin = (at: number): number => Math.floor(at / POINT_INTERVAL);
    if (last === undefined || time - last > MIN_GAP || bin(time) !== bin(last)) this.push(time);
    this.last = time;
    values.forEach((value, k) => this.join(k, value));
    let old = 0;
    while ((this.times[old] ?? time) < time - SPAN) old += 1;
    if (old) for (const each of [this.times, ...this.values, ...this.counts]) each.splice(0, old);
  }

  clear(): void {
    for (const each of [this.times, ...this.values, ...this.counts]) each.length = 0;
    this.last = undefined;
  }

  /** The data of the chart, with times relative to the newest [s]. */
  get data(): AlignedData {
    const now = this.last ?? 0;
    return [this.times.map((t) => t - now), ...this.kinds.map((_, k) => this.times.map((_time, bin) => this.over(k, bin)))];
  }

  /** The newest value of each kind; NaN if there is none. */
  get latest(): number[] {
    return this.kinds.map((_, k) => this.over(k, this.times.length - 1) ?? NaN);
  }

  private push(time: number): void {
    this.times.push(time);
    for (const each of this.values) each.push(null);
    for (const each of this.counts) each.push(0);
  }

  private join(k: number, value: number): void {
    const [values, counts] = [this.values[k], this.counts[k]];
    if (!values || !counts || !Number.isFinite(value)) return;
    const count = counts.at(-1) ?? 0;
    const before = values.at(-1) ?? 0;
    const mean = before + (value - before) / (count + 1);
    values[values.length - 1] = !count ? value : this.kinds[k] === "max" ? Math.max(before, value) : mean;
    counts[counts.length - 1] = count + 1;
  }

  /** Return the mean or maximum over the window that ends at a bin, back to the last gap; null in a gap. */
  private over(k: number, bin: number): number | null {
    const [values, counts] = [this.values[k] ?? [], this.counts[k] ?? []];
    const end = this.times[bin] ?? 0;
    let [sum, count, most] = [0, 0, -Infinity];
    for (let each = bin; each >= 0 && end - (this.times[each] ?? end) < POINT_WINDOW; each--) {
      const value = values[each] ?? null;
      if (value === null) break;
      sum += value * (counts[each] ?? 0);
      count += counts[each] ?? 0;
      most = Math.max(most, value);
    }
    if (!count) return null;
    return this.kinds[k] === "max" ? most : sum / count;
  }
}
