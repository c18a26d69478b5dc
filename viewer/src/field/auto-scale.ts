/** A scale from 0 to a round number that does not change with every value. */

const ROUND_STEPS = [1, 1.5, 2, 3, 4, 5, 6, 8, 10];
const DECAY_PER_SECOND = 0.8; // factor by which the largest value seen decays each second
const MIN_USED_SHARE = 0.5; // share of its top: the scale shrinks if the decayed largest value is below it

/** Return the smallest round number that is not below x; 1 if x is not positive. */
export function round(x: number): number {
  if (!(x > 0) || !Number.isFinite(x)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  const found = ROUND_STEPS.find((each) => each * power >= x * (1 - 1e-9)) ?? 10;
  return Number((found * power).toPrecision(2));
}

export class AutoScale {
  /** Top of the scale. */
  most = 1;
  /** Whether the scale follows the values seen. */
  auto = true;
  private held = 0;
  private seen = -Infinity;

  /** Note the largest value seen at `time` [s]; return whether the top of the scale has changed. */
  see(most: number, time = performance.now() / 1000): boolean {
    if (!Number.isFinite(most)) return false;
    this.held = Math.max(most, DECAY_PER_SECOND ** (time - this.seen) * this.held);
    this.seen = time;
    if (!this.auto) return false;
    const small = this.held > this.most;
    const large = this.held > 0 && this.held < MIN_USED_SHARE * this.most;
    if (!small && !large) return false;
    this.most = round(this.held);
    return true;
  }
}
