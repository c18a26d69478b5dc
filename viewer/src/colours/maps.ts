/**
 * Colour maps of 256 colours, RGBA bytes.
 *
 * Phase follows an ellipse in OKLab, with lightness along one axis and blue to orange along the other. Phases a quarter
 * turn apart therefore differ also for people who lack one kind of cone. Pressure uses viridis, and an error uses
 * ColorBrewer's RdBu, both from D3.
 */

import { interpolateRdBu, interpolateViridis } from "d3-scale-chromatic";

import { byte, linear, type Colour } from "./oklab";

export const COLOURS = 256;
export type Map256 = Uint8Array<ArrayBuffer>;

/** Return the colour of a phase [rad] in OKLab. */
export function phased(angle: number): Colour {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return [0.66 + 0.23 * c, 0.06 * s - 0.05 * c, 0.11 * s + 0.03 * c];
}

/** Make the map of phases, from 0 to one turn. */
export function cyclic(): Map256 {
  return filled((k) => linear(phased((2 * Math.PI * k) / COLOURS)).map(byte));
}

/** Make the map of pressures, from 0 to the maximum. */
export function viridis(): Map256 {
  return filled((k) => {
    const found = interpolateViridis(k / (COLOURS - 1)).match(/[0-9a-f]{2}/g) ?? [];
    return found.map((pair) => parseInt(pair, 16));
  });
}

/** Make the map of errors: blue is too little, white is right, red is too much. */
export function diverging(): Map256 {
  return filled((k) => (interpolateRdBu(1 - k / (COLOURS - 1)).match(/\d+/g) ?? []).map(Number));
}

/** Return a colour of a map as CSS. share: 0 for the first colour, 1 for the last. */
export function css(map: Map256, share: number): string {
  const held = Math.min(Math.max(share, 0), 1);
  const k = 4 * Math.round(held * (COLOURS - 1));
  return `rgb(${map[k]}, ${map[k + 1]}, ${map[k + 2]})`;
}

function filled(colour: (k: number) => number[]): Map256 {
  const map = new Uint8Array(4 * COLOURS);
  for (let k = 0; k < COLOURS; k++) map.set([...colour(k), 255], 4 * k);
  return map;
}
