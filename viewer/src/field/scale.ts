/** A scale from nothing to a round number, which does not change with every value. */

const ROUND = [1, 1.5, 2, 3, 4, 5, 6, 8, 10];
const FADE = 0.8; // of what is held, each second
const ROOM = 0.5; // share of a scale below which it is too large

/** The next round number that is not below x; 1 of nothing. */
export function round(x: number): number {
  if (!(x > 0) || !Number.isFinite(x)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  const found = ROUND.find((each) => each * power >= x * (1 - 1e-9)) ?? 10;
  return Number((found * power).toPrecision(2));
}

export class Scale {
  /** The top of it. */
  most = 1;
  /** Whether it follows what is seen. */
  auto = true;
  private held = 0;
  private seen = -Infinity;

  /** Another most has been seen, at a time [s]; whether the scale is another. */
  see(most: number, time = performance.now() / 1000): boolean {
    if (!Number.isFinite(most)) return false;
    this.held = Math.max(most, FADE ** (time - this.seen) * this.held);
    this.seen = time;
    if (!this.auto) return false;
    const small = this.held > this.most;
    const large = this.held > 0 && this.held < ROOM * this.most;
    if (!small && !large) return false;
    this.most = round(this.held);
    return true;
  }
}
