/** `window.pacinian`: a read-only view of what the page shows, for tests and for curious users. */

import { Vector3 } from "three";

import type { SurfaceBox } from "./field/surface-box";
import type { SlicePlane } from "./field/slice-plane";
import type { Over, Quantity, Triple } from "./feed/messages";
import { floats } from "./feed/numbers";
import type { Link, Store } from "./feed/store";
import type { Space } from "./space/space";

export interface Shown {
  readonly link: Link;
  readonly output: string;
  readonly transducers: number;
  readonly drive: { mean: number; most: number };
  readonly hands: number;
  readonly objects: Record<string, { type: string; position: number[]; drawn: boolean }>;
  readonly samples: { position: number[]; asked: number; achieved: number }[];
  readonly slice: { quantity: Quantity; average: Over; centre: Triple; size: number[]; shape: number[]; pressure: number[] } | null;
  readonly wanted: { axis: string; position: number; shown: boolean; average: Over; follows: boolean; faces: boolean };
  readonly surface: { triangles: number; level: number };
  readonly scale: number;
  /** Whether the achieved pressure is painted on the hands. */
  readonly painted: boolean;
  /** Numbers of frames and slices so far. */
  readonly frames: number;
  readonly slices: number;
  /** Return where a point in space [m] is on the page [px]. */
  project(point: Triple): [number, number];
  /** Return where the slice's arrow is on the page [px]. */
  grip(): [number, number];
}

declare global {
  interface Window {
    pacinian?: Shown;
  }
}

/** Make the read-only view. */
export function shown(store: Store, space: Space, slicePlane: SlicePlane, surfaceBox: SurfaceBox): Shown {
  const page = (point: Vector3): [number, number] => {
    const { x, y } = space.viewport.project(point);
    return [x, y];
  };
  return Object.freeze({
    get link() {
      return store.link;
    },
    get output() {
      return store.newest.state?.output ?? "";
    },
    get transducers() {
      return space.transducers.count;
    },
    get drive() {
      return { ...space.transducers.drive };
    },
    get hands() {
      return space.hands.count;
    },
    get objects() {
      return Object.fromEntries(
        [...space.objects.all].map(([name, { thing, position, drawn }]) => [
          name,
          { type: thing.type, position: position.toArray(), drawn },
        ]),
      );
    },
    get samples() {
      const { state } = store.newest;
      if (!state) return [];
      const [points, asked, achieved] = [state.points, state.asked, state.achieved].map(floats);
      return [...(asked ?? [])].map((pressure, k) => ({
        position: [...(points ?? []).slice(3 * k, 3 * k + 3)],
        asked: pressure,
        achieved: achieved?.[k] ?? NaN,
      }));
    },
    get slice() {
      const { plane, values, quantity, average } = space.slice;
      if (!plane) return null;
      const { centre, size, shape } = plane;
      return { quantity, average, centre, size, shape, pressure: [...values] };
    },
    get wanted() {
      const { axis, position, average, follows, faces } = slicePlane;
      return { axis, position, shown: slicePlane.shown, average, follows, faces };
    },
    get surface() {
      return { triangles: surfaceBox.shown ? space.surface.triangles : 0, level: space.level };
    },
    get painted() {
      return space.hands.painted;
    },
    get scale() {
      return space.scale.most;
    },
    get frames() {
      return space.viewport.frames;
    },
    get slices() {
      return space.slice.count;
    },
    project: (point: Triple) => page(new Vector3(...point)),
    grip: () => page(space.slice.gripped),
  });
}
