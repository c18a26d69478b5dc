/** How a pressure becomes a position on the colour bar: linear, by its square root, or in decibels. */

export const SCALE_LAWS = ["linear", "root", "decibel"] as const;
export type ScaleLaw = (typeof SCALE_LAWS)[number];

/** Range of the decibel scale [dB]. */
export const DECIBELS = 30;

/** Return the position on the bar, 0..1, of a share of its top. */
export function place(share: number, law: ScaleLaw): number {
  const held = Math.min(Math.max(share, 0), 1);
  if (law === "root") return Math.sqrt(held);
  if (law === "decibel") return Math.max(1 + (10 * Math.log10(Math.max(held, 1e-30))) / DECIBELS, 0);
  return held;
}

/** Return the share of the top at a position on the bar, 0..1. */
export function shareAt(at: number, law: ScaleLaw): number {
  if (law === "root") return at * at;
  if (law === "decibel") return 10 ** (((at - 1) * DECIBELS) / 10);
  return at;
}

/** Return the opacity at a position on the bar. Weak pressure is transparent, to show what is behind it. */
export function opacity(at: number): number {
  const t = Math.min(Math.max((at - 0.03) / 0.32, 0), 1);
  return 0.96 * t * t * (3 - 2 * t);
}
