/** Numbers as texts for people, and the ends of sentences. */

const DIGITS = 3;

/** Format a number with `count` digits, with a power of ten only if it is very large or small. */
export function digits(x: number, count = DIGITS): string {
  if (!Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-4) return x.toExponential(count - 1).replace("-", "−");
  const after = Math.max(count - 1 - Math.floor(Math.log10(size)), 0);
  return x.toFixed(Math.min(after, 6)).replace("-", "−");
}

/** Format a number like `digits`, but without zeros at its end. */
export function trimmed(x: number): string {
  return digits(x).replace(/(\.\d*?)0+(?=e|$)/, "$1").replace(/\.(?=e|$)/, "");
}

/** Format a whole number with thin spaces between thousands. */
export function whole(x: number): string {
  return Math.round(x).toString().replace(/\B(?=(\d{3})+$)/g, "\u2009").replace("-", "−");
}

export function percent(share: number): string {
  return `${digits(100 * share)} %`;
}

/** Format a time [s]. */
export function seconds(t: number): string {
  return t < 1 ? `${whole(1000 * t)} ms` : `${digits(t)} s`;
}

export function millimetres(length: number): string {
  return (Math.round(1e4 * length) / 10).toFixed(1).replace("-", "−");
}

export function plural(count: number, one: string): string {
  return `${whole(count)} ${one}${count === 1 ? "" : "s"}`;
}

/** Begin a text with a capital letter, and end it with a full stop. */
export function sentence(text: string): string {
  return ended(text.charAt(0).toUpperCase() + text.slice(1));
}

/** End a text with a full stop, if it has none. */
export function ended(text: string): string {
  return /[.?!]$/.test(text) || !text ? text : `${text}.`;
}
