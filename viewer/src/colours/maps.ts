/**
 * Colour maps of 256 colours, RGBA bytes.
 *
 * Phase goes once around an ellipse in OKLab: light and dark across, blue and orange across the other way, so that
 * phases a quarter apart differ also for eyes that lack one kind of cone. Pressure is viridis, an error ColorBrewer's
 * RdBu, both from D3.
 */

import { interpolateRdBu, interpolateViridis } from "d3-scale-chromatic";

import { byte, linear, type Colour } from "./oklab";

export const COLOURS = 256;
export type Map256 = Uint8Array<ArrayBuffer>;

/** The colour of a phase [rad], in OKLab. */
export function phased(angle: number): Colour {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return [0.66 + 0.23 * c, 0.06 * s - 0.05 * c, 0.11 * s + 0.03 * c];
}

/** Phase, from 0 to one turn. */
export function cyclic(): Map256 {
  return filled((k) => linear(phased((2 * Math.PI * k) / COLOURS)).map(byte));
}

/** Pressure, from 0 to the most. */
export function viridis(): Map256 {
  return filled((k) => {
    const found = interpolateViridis(k / (COLOURS - 1)).match(/[0-9a-f]{2}/g) ?? [];
    return found.map((pair) => parseInt(pair, 16));
  });
}

/** Error, from as much too little, blue, over right, white, to as much too much, red. */
export function diverging(): Map256 {
  return filled((k) => (interpolateRdBu(1 - k / (COLOURS - 1)).match(/\d+/g) ?? []).map(Number));
}

/** A colour of a map, 0..1 from first to last, for a style. */
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
