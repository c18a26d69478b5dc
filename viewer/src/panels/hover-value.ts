/** Shows the value under the mouse. */

import type { HoverValue } from "../space/pointer";
import { element, say } from "./dom";
import { digits, millimetres } from "./format";

const MOUSE_DISTANCE = 14; // distance from the mouse [px]

export function showHoverValue(told: HoverValue | null): void {
  const note = element("told");
  note.hidden = !told;
  if (!told) return;
  const { x, y, at } = told;
  const place = [at.x, at.y, at.z].map(millimetres).join(", ");
  say(note, `${words(told)} at (${place}) mm`);
  const { left, top, right } = element("space").getBoundingClientRect();
  const over = x + MOUSE_DISTANCE + note.offsetWidth > right;
  const across = x - left + (over ? -MOUSE_DISTANCE - note.offsetWidth : MOUSE_DISTANCE);
  note.style.transform = `translate(${across}px, ${y - top + MOUSE_DISTANCE}px)`;
}

function words({ value, quantity }: HoverValue): string {
  if (quantity === "pressure") return `${digits(value)} Pa`;
  if (Number.isNaN(value)) return "nothing asked";
  return `${digits(Math.abs(value))} Pa too ${value < 0 ? "little" : "much"}`;
}
