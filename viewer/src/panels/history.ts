/** Values over the last seconds, for a chart: of each short time their mean, or the largest. */

import type { AlignedData } from "uplot";

export const SPAN = 30; // [s]
const BIN = 0.25; // [s]: as short as a pixel or two, and longer than a modulation
const BACK = 0.2; // [s]
const GAP = 1; // [s] over which no line is drawn

export type Kind = "mean" | "max";

export class History {
  private readonly times: number[] = [];
  private readonly values: (number | null)[][];
  /** How many values the last bin of each has. */
  private readonly counts: number[];
  private last: number | undefined;

  constructor(private readonly kinds: readonly Kind[]) {
    this.values = kinds.map(() => []);
    this.counts = kinds.map(() => 0);
  }

  /** moment: of the server's clock [s]; one that goes back by more than messages do begins anew. A value that is no number leaves a gap. */
  add(moment: number, ...values: number[]): void {
    if (this.last !== undefined && moment < this.last - BACK) this.clear();
    const { last } = this;
    const time = Math.max(moment, last ?? moment);
    if (last !== undefined && time - last > GAP) this.push((last + time) / 2);
    if (last === undefined || time - last > GAP || Math.floor(time / BIN) !== Math.floor(last / BIN)) this.push(time);
    this.last = time;
    values.forEach((value, k) => this.join(k, value));
    let old = 0;
    while ((this.times[old] ?? time) < time - SPAN) old += 1;
    if (old) for (const each of [this.times, ...this.values]) each.splice(0, old);
  }

  clear(): void {
    for (const each of [this.times, ...this.values]) each.length = 0;
    this.last = undefined;
  }

  /** With times before the newest [s]. */
  get data(): AlignedData {
    const now = this.last ?? 0;
    return [this.times.map((t) => t - now), ...this.values];
  }

  /** The newest of each; NaN without any. */
  get latest(): number[] {
    return this.values.map((each) => each.at(-1) ?? NaN);
  }

  private push(time: number): void {
    this.times.push(time);
    for (const each of this.values) each.push(null);
    this.counts.fill(0);
  }

  private join(k: number, value: number): void {
    const [values, count] = [this.values[k], this.counts[k] ?? 0];
    if (!values || !Number.isFinite(value)) return;
    const before = values.at(-1) ?? 0;
    const mean = before + (value - before) / (count + 1);
    values[values.length - 1] = !count ? value : this.kinds[k] === "max" ? Math.max(before, value) : mean;
    this.counts[k] = count + 1;
  }
}
