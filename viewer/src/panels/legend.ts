/** What the colours mean: the wheel of phases, the bar of pressures, the sizes of samples. */

import { COLOURS } from "../colours/maps";
import type { Quantity } from "../feed/messages";
import { ERRORS, PHASES, PRESSURES } from "../space/maps";
import { element, get, made, say } from "./dom";
import { digits } from "./words";

const HOLE = 0.62; // of the wheel's radius
const TICKS = 5;
const CAPTIONS = { pressure: "radiation pressure [Pa]", error: "made − asked [Pa]" };

/** What the bar shows. */
let painted: Quantity | undefined;

/** Drawn once. */
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
        const soft = Math.min((1 - radius) * middle, (radius - HOLE) * middle);
        image.data[4 * (y * side + x) + 3] = 255 * Math.min(Math.max(soft, 0), 1);
      }
    }
    draw.putImageData(image, 0, 0);
  }
  scaleBar(1, "pressure");
}

/** most: top of the colour scale [Pa]; an error goes as far below zero. */
export function scaleBar(most: number, of: Quantity): void {
  if (of !== painted) paintBar(of);
  painted = of;
  const low = of === "error" ? -most : 0;
  const ticks = Array.from({ length: TICKS }, (_, k) => most - ((most - low) * k) / (TICKS - 1));
  const list = element("bar-ticks");
  ticks.forEach((tick, k) => {
    const item = list.children[k] ?? list.appendChild(made("li"));
    say(item, digits(tick, 3).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, ""));
  });
}

function paintBar(of: Quantity): void {
  const map = of === "error" ? ERRORS : PRESSURES;
  say(element("bar-caption"), CAPTIONS[of]);
  const paint = get("bar-colours", HTMLCanvasElement).getContext("2d");
  if (!paint) return;
  const image = paint.createImageData(1, COLOURS);
  for (let k = 0; k < COLOURS; k++) image.data.set(map.subarray(4 * k, 4 * k + 4), 4 * (COLOURS - 1 - k));
  paint.putImageData(image, 0, 0);
}

/** most: pressure of the largest ring [Pa]. */
export function scaleSamples(most: number): void {
  say(element("sample-scale"), most ? `largest ${digits(most)} Pa` : "");
}
