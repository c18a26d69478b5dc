/** Planes in space: their geometry, rays that meet them, and the values on them. */

import { Matrix4, Vector3, type Ray } from "three";

import type { Plane, Triple } from "../feed/messages";

export type Axis = "x" | "y" | "z";

/** Directions to the right and up in a plane across an axis, as such planes are usually drawn. */
const SIDES: Record<Axis, readonly [Triple, Triple]> = {
  x: [[0, 1, 0], [0, 0, 1]], // prettier-ignore
  y: [[1, 0, 0], [0, 0, 1]], // prettier-ignore
  z: [[1, 0, 0], [0, 1, 0]], // prettier-ignore
};
export const AXES = ["x", "y", "z"] as const;

/** Return a square plane across an axis. */
export function across(axis: Axis, centre: Triple, size: number, cells: number): Plane {
  const [u, v] = SIDES[axis];
  return { centre, u, v, size: [size, size], shape: [cells, cells] };
}

export function number(axis: Axis): 0 | 1 | 2 {
  return axis === "x" ? 0 : axis === "y" ? 1 : 2;
}

/** Return the matrix that maps a square of side 1 around the origin to a plane. */
export function matrix(plane: Plane, into: Matrix4): Matrix4 {
  const u = new Vector3(...plane.u).multiplyScalar(plane.size[0]);
  const v = new Vector3(...plane.v).multiplyScalar(plane.size[1]);
  const n = new Vector3().crossVectors(u, v).normalize();
  return into.makeBasis(u, v, n).setPosition(...plane.centre);
}

/** Return where a ray meets a plane, as shares of its width and height, 0..1; null if it misses the plane. */
export function hit(plane: Plane, ray: Ray): { s: number; t: number; at: Vector3 } | null {
  const u = new Vector3(...plane.u);
  const v = new Vector3(...plane.v);
  const centre = new Vector3(...plane.centre);
  const n = u.clone().cross(v);
  const slope = ray.direction.dot(n);
  if (Math.abs(slope) < 1e-6) return null;
  const away = centre.clone().sub(ray.origin).dot(n) / slope;
  if (away <= 0) return null;
  const at = ray.at(away, new Vector3());
  const d = at.clone().sub(centre);
  const s = d.dot(u) / plane.size[0] + 0.5;
  const t = d.dot(v) / plane.size[1] + 0.5;
  return s < 0 || s > 1 || t < 0 || t > 1 ? null : { s, t, at };
}

/** Interpolate the value at shares of width and height, linearly between the middles of cells. */
export function value(plane: Plane, values: Float32Array, s: number, t: number): number {
  const [rows, columns] = plane.shape;
  const x = Math.min(Math.max(s * columns - 0.5, 0), columns - 1);
  const y = Math.min(Math.max(t * rows - 0.5, 0), rows - 1);
  const c = Math.min(Math.floor(x), Math.max(columns - 2, 0));
  const r = Math.min(Math.floor(y), Math.max(rows - 2, 0));
  const at = (i: number, j: number): number =>
    values[Math.min(i, rows - 1) * columns + Math.min(j, columns - 1)] ?? 0;
  const [p, q] = [x - c, y - r];
  return (
    (1 - q) * ((1 - p) * at(r, c) + p * at(r, c + 1)) +
    q * ((1 - p) * at(r + 1, c) + p * at(r + 1, c + 1))
  );
}

/** Return the largest magnitude of the values on a plane, and its position. NaN is ignored. */
export function peak(plane: Plane, values: Float32Array): { most: number; at: Triple } {
  let most = 0;
  let best = 0;
  for (let k = 0; k < values.length; k++) {
    const each = Math.abs(values[k] ?? 0);
    if (each > most) [most, best] = [each, k];
  }
  const [rows, columns] = plane.shape;
  const s = ((best % columns) + 0.5) / columns - 0.5;
  const t = (Math.floor(best / columns) + 0.5) / rows - 0.5;
  const along = (n: 0 | 1 | 2): number =>
    plane.centre[n] + s * plane.size[0] * plane.u[n] + t * plane.size[1] * plane.v[n];
  return { most, at: [along(0), along(1), along(2)] };
}

/** Return the range of the values and 0; null if all values are NaN. */
export function range(values: Float32Array): { low: number; high: number } | null {
  let [low, high] = [0, 0];
  let known = false;
  for (const each of values) {
    if (Number.isNaN(each)) continue;
    known = true;
    low = Math.min(low, each);
    high = Math.max(high, each);
  }
  return known ? { low, high } : null;
}
