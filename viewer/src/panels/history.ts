/** Values over the last seconds, for a chart. */

import type { AlignedData } from "uplot";

export const SPAN = 30; // [s]
const APART = 0.09; // [s] from value to value, at least
const GAP = 1; // [s] over which no line is drawn

export class History {
  readonly times: number[] = [];
  readonly values: (number | null)[][];

  constructor(series: number) {
    this.values = Array.from({ length: series }, () => []);
  }

  /** time: of the server's clock [s]; one that goes back begins anew. */
  add(time: number, ...values: number[]): void {
    const last = this.times.at(-1);
    if (last !== undefined && time < last) this.clear();
    if (last !== undefined && time >= last && time - last < APART) return;
    if (last !== undefined && time - last > GAP) this.push((last + time) / 2, []);
    this.push(time, values);
    let old = 0;
    while ((this.times[old] ?? time) < time - SPAN) old += 1;
    if (old) for (const each of [this.times, ...this.values]) each.splice(0, old);
  }

  private push(time: number, values: number[]): void {
    this.times.push(time);
    this.values.forEach((each, k) => each.push(values[k] ?? null));
  }

  clear(): void {
    for (const each of [this.times, ...this.values]) each.length = 0;
  }

  /** With times before the newest [s]. */
  get data(): AlignedData {
    const now = this.times.at(-1) ?? 0;
    return [this.times.map((t) => t - now), ...this.values];
  }
}
