/** The legend: the wheel of phases, the bar of pressures, the scale of the samples. */

import { COLOURS } from "../colours/maps";
import { opacity, shareAt, type ScaleLaw } from "../field/scale-law";
import type { Over, Quantity } from "../feed/messages";
import { ERRORS, PHASES, PRESSURES } from "../space/map-textures";
import { element, get, made, say } from "./dom";
import { digits, trimmed } from "./format";

const HOLE_RADIUS = 0.62; // radius of the hole, relative to the wheel's
const TICK_COUNT = 5;
const CAPTIONS: Record<Over, string> = {
  mean: "mean pressure [Pa]",
  peak: "peak pressure [Pa]",
  instant: "pressure now [Pa]",
};

/** The quantity that the bar shows. */
let painted: Quantity | undefined;

/** Draw the wheel and the bar. */
export function drawLegend(): void {
  const canvas = get("wheel", HTMLCanvasElement);
  const draw = canvas.getContext("2d");
  const side = canvas.width;
  if (draw) {
    const image = draw.createImageData(side, side);
    const middle = (side - 1) / 2;
    for (let y = 0; y < side; y++) {
      for (let x = 0; x < side; x++) {
        const radius = Math.hypot(x - middle, y - middle) / middle;
        const angle = Math.atan2(middle - y, x - middle) / (2 * Math.PI);
        const k = 4 * (Math.round(((angle + 1) % 1) * COLOURS) % COLOURS);
        image.data.set(PHASES.subarray(k, k + 3), 4 * (y * side + x));
        const soft = Math.min((1 - radius) * middle, (radius - HOLE_RADIUS) * middle);
        image.data[4 * (y * side + x) + 3] = 255 * Math.min(Math.max(soft, 0), 1);
      }
    }
    draw.putImageData(image, 0, 0);
  }
  scaleBar(1, "pressure");
}

/** Label the bar. most: top of the colour scale [Pa]; the scale of an error begins at -most. */
export function scaleBar(most: number, quantity: Quantity, law: ScaleLaw = "linear", average: Over = "mean"): void {
  if (quantity !== painted) paintBar(quantity);
  painted = quantity;
  say(element("bar-caption"), quantity === "error" ? "made − asked [Pa]" : CAPTIONS[average]);
  const places = Array.from({ length: TICK_COUNT }, (_, k) => 1 - k / (TICK_COUNT - 1));
  const ticks = places.map((at) => (quantity === "error" ? most * (2 * at - 1) : most * shareAt(at, law)));
  const list = element("bar-ticks");
  ticks.forEach((tick, k) => {
    const item = list.children[k] ?? list.appendChild(made("li"));
    say(item, trimmed(tick));
  });
}

function paintBar(quantity: Quantity): void {
  const map = quantity === "error" ? ERRORS : PRESSURES;
  const paint = get("bar-colours", HTMLCanvasElement).getContext("2d");
  if (!paint) return;
  const image = paint.createImageData(1, COLOURS);
  for (let k = 0; k < COLOURS; k++) {
    const row = 4 * (COLOURS - 1 - k);
    image.data.set(map.subarray(4 * k, 4 * k + 4), row);
    if (quantity === "pressure") image.data[row + 3] = 255 * opacity(k / (COLOURS - 1));
  }
  paint.putImageData(image, 0, 0);
}

/** Label the samples. most: pressure of the largest ring [Pa]. */
export function scaleSamples(most: number): void {
  say(element("sample-scale"), most ? `largest ${digits(most)} Pa` : "");
}
