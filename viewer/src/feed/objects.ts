/** Objects and shapes, as the wire has them. */

import type { Bytes, Triple } from "./messages";

export interface Pose {
  position: Triple;
  rotation: [number, number, number, number];
}

export type Primitive =
  | { type: "sphere"; radius: number }
  | { type: "box"; size: Triple }
  | { type: "capsule"; radius: number; length: number }
  | { type: "mesh"; vertices: Bytes; faces: Bytes; scale: number }
  | { type: "voxels"; values: Bytes; grid: Triple; pitch: number; level: number };

export type Part = Primitive | { type: "placed"; shape: Primitive; pose: Pose };

export type Solid =
  | Part
  | { type: "union"; parts: Part[] }
  | { type: "intersection"; parts: Part[] }
  | { type: "difference"; of: Part; less: Part[] };

export type Shell =
  | Primitive
  | { type: "rectangle"; width: number; height: number }
  | { type: "disc"; radius: number }
  | {
      type: "height-map";
      heights: Bytes;
      grid: [number, number];
      width: number;
      height: number;
      depth: number;
    };

export type Curve =
  | { type: "line"; length: number }
  | { type: "circle"; radius: number }
  | {
      type: "lissajous";
      width: number;
      height: number;
      a: number;
      b: number;
      phase: number;
    }
  | { type: "polyline"; points: Bytes; closed: boolean };

export type Shape = Shell | Solid;

/** A factor on pressure over x and y. Rows are those of a picture seen from +z. */
export interface Texture {
  values: Bytes;
  grid: [number, number];
  size: [number, number];
  repeat: boolean;
}

export type Thing =
  | { type: "point"; position: Triple; area: number }
  | { type: "path"; shape: Curve; width: number }
  | { type: "particles"; positions: Bytes; radius: number }
  | { type: "surface"; shape: Shell; texture?: Texture | null }
  | { type: "volume"; shape: Solid; texture?: Texture | null };
