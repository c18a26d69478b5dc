/** Floor and axes around the array, in millimetres. */

import {
  Box3,
  BufferGeometry,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  Ray,
  Vector3,
} from "three";

import type { Hands } from "./hands";
import { Label, type Kept } from "./labels";

const STEPS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1];
const MAX_STEPS = 7; // largest number of steps on the longer side, roughly
const FLOOR_DEPTH = 0.006; // distance of the floor below the array [m]
const AXIS_NAME_COUNT = 3; // the last labels are the names x, y, z
const LABEL_DISTANCE = 0.018; // distance from an axis to its numbers, relative to the diagonal
const GRID = new LineBasicMaterial({ color: "#2a323d" });
const AXIS = new LineBasicMaterial({ color: "#55606f" });

/** Bounds of the visible space [m]. */
export interface Extent {
  low: readonly [number, number, number];
  high: readonly [number, number, number];
}

/** Return the step of a scale of this length [m]. */
export function step(length: number): number {
  return STEPS.find((each) => length / each <= MAX_STEPS) ?? 1;
}

export class Axes extends Group {
  readonly labels: Label[] = [];
  /** The box that the axes enclose [m]. */
  readonly box = new Box3();
  private readonly ray = new Ray();

  /** Draw the axes around an array. */
  place({ low, high }: Extent): void {
    for (const label of this.labels) label.dispose();
    this.labels.length = 0;
    for (const child of [...this.children]) {
      this.remove(child);
      if (child instanceof LineSegments) child.geometry.dispose();
    }
    const apart = step(Math.max(high[0] - low[0], high[1] - low[1]));
    const x = ticks(low[0], high[0], apart);
    const y = ticks(low[1], high[1], apart);
    const floor = low[2] - FLOOR_DEPTH;
    const tall = ticks(low[2], high[2], step(high[2] - low[2])).filter((z) => z >= low[2]);
    const [left, right, near, far] = [x[0], x.at(-1), y[0], y.at(-1)].map((each) => each ?? 0);
    if (left === undefined || right === undefined || near === undefined || far === undefined) {
      return;
    }
    const top = tall.at(-1) ?? floor;
    this.box.set(new Vector3(left, near, floor), new Vector3(right, far, top));
    const away = LABEL_DISTANCE * Math.hypot(right - left, far - near);
    this.lines(GRID, [
      ...x.flatMap((each) => [each, near, floor, each, far, floor]),
      ...y.flatMap((each) => [left, each, floor, right, each, floor]),
    ]);
    this.lines(AXIS, [
      ...[left, near, floor, right, near, floor, right, near, floor, right, far, floor],
      ...[left, far, floor, left, far, top],
      ...tall.flatMap((z) => [left, far, z, left - away / 3, far, z]),
    ]);
    for (const each of x) this.label(millimetres(each), each, near - 1.6 * away, floor);
    for (const each of y) this.label(millimetres(each), right + 1.6 * away, each, floor);
    for (const z of tall) this.label(millimetres(z), left - 1.6 * away, far, z);
    this.label("x [mm]", (left + right + apart) / 2, near - 3.8 * away, floor, true);
    this.label("y [mm]", right + 3.8 * away, (near + far + apart) / 2, floor, true);
    this.label("z [mm]", left, far, top + 1.6 * away, true);
  }

  /**
   * Hide labels that would cover a hand or one of `kept`, and numbers that would cover a name or another number. Add the
   * visible ones to `kept`. project: returns where a point is on the page [px].
   */
  separate(project: (point: Vector3) => { x: number; y: number }, camera: Vector3, hands: Hands, kept: Kept[]): void {
    for (const label of [...this.labels.slice(-AXIS_NAME_COUNT), ...this.labels.slice(0, -AXIS_NAME_COUNT)]) {
      this.ray.set(camera, this.ray.direction.subVectors(label.position, camera).normalize());
      if (hands.covers(this.ray, label.scale.x / 2)) label.visible = false;
      else label.showIfClear(project(label.position), kept);
    }
  }

  private lines(material: LineBasicMaterial, points: number[]): void {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    this.add(new LineSegments(geometry, material));
  }

  private label(text: string, x: number, y: number, z: number, name = false): void {
    const label = new Label(text, name ? { colour: "#9aa6b5" } : { colour: "#7f8b9b", size: 10 });
    label.position.set(x, y, z);
    this.labels.push(label);
    this.add(label);
  }
}

/** Return the multiples of a step that enclose a range. */
export function ticks(low: number, high: number, apart: number): number[] {
  const first = Math.floor(low / apart + 1e-6);
  const last = Math.ceil(high / apart - 1e-6);
  return Array.from({ length: last - first + 1 }, (_, k) => (first + k) * apart);
}

function millimetres(length: number): string {
  return (Math.round(1e4 * length) / 10).toString().replace("-", "−");
}
