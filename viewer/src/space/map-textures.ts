/** Colour maps as textures of one row. Our shaders use the colours without conversion. */

import {
  ClampToEdgeWrapping,
  DataTexture,
  LinearFilter,
  NoColorSpace,
  RepeatWrapping,
  type Wrapping,
} from "three";

import { COLOURS, cyclic, diverging, viridis, type Map256 } from "../colours/maps";

export const PHASES = cyclic();
export const PRESSURES = viridis();
export const ERRORS = diverging();

function row(map: Map256, wrapping: Wrapping): DataTexture {
  const texture = new DataTexture(map, COLOURS, 1);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.wrapS = wrapping;
  texture.colorSpace = NoColorSpace;
  texture.needsUpdate = true;
  return texture;
}

export const phaseMap = row(PHASES, RepeatWrapping);
export const pressureMap = row(PRESSURES, ClampToEdgeWrapping);
export const errorMap = row(ERRORS, ClampToEdgeWrapping);
