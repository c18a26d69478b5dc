/** How a pressure becomes a place on the colour bar: as it is, by its root, or in decibels. */

export const SCALE_LAWS = ["linear", "root", "decibel"] as const;
export type ScaleLaw = (typeof SCALE_LAWS)[number];

/** Below the top, where the bar in decibels begins. */
export const DECIBELS = 30;

/** Place on the bar, 0..1, of a share of its top. */
export function place(share: number, law: ScaleLaw): number {
  const held = Math.min(Math.max(share, 0), 1);
  if (law === "root") return Math.sqrt(held);
  if (law === "decibel") return Math.max(1 + (10 * Math.log10(Math.max(held, 1e-30))) / DECIBELS, 0);
  return held;
}

/** The share of the top that is at a place of the bar, 0..1. */
export function shareAt(at: number, law: ScaleLaw): number {
  if (law === "root") return at * at;
  if (law === "decibel") return 10 ** (((at - 1) * DECIBELS) / 10);
  return at;
}

/** Opacity of a place on the bar: what is weak does not hide what is behind it. */
export function opacity(at: number): number {
  const t = Math.min(Math.max((at - 0.03) / 0.32, 0), 1);
  return 0.96 * t * t * (3 - 2 * t);
}
