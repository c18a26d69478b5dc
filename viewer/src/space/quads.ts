/**
 * Many squares in one geometry, each with its own attributes.
 *
 * All corners are stored, instead of instances of one square, because software rendering draws each instance by itself.
 */

import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from "three";

const CORNERS = [-1, -1, 1, -1, 1, 1, -1, 1];
const FACES = [0, 1, 2, 0, 2, 3];

/** GLSL function: returns a point of a square that faces a direction. */
export const FACED = `
vec3 faced(vec3 facing, vec2 at) {
  vec3 other = abs(facing.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0);
  vec3 x = normalize(cross(other, facing));
  return at.x * x + at.y * cross(facing, x);
}`;

export class Quads {
  /** Attributes: `corner`, from -1 to 1, and those of the squares. */
  readonly geometry = new BufferGeometry();
  count = 0;
  private capacity = 0;

  /** widths: for each attribute, its number of components. */
  constructor(private readonly widths: Record<string, number>) {
    this.resize(0);
  }

  /**
   * Set the number of squares. If there is no room, new buffers at least twice as large replace the old: write all
   * attributes again.
   */
  resize(count: number): void {
    if (count > this.capacity || !this.capacity) this.allocate(Math.max(2 * this.capacity, count, 1));
    this.count = count;
    this.geometry.setDrawRange(0, FACES.length * count);
  }

  /** Set an attribute of all squares. values: the components of one square after those of another. */
  write(name: string, values: ArrayLike<number>): void {
    const attribute = this.geometry.getAttribute(name) as BufferAttribute;
    const { array, itemSize } = attribute;
    const end = Math.min(values.length, this.count * itemSize);
    for (let k = 0, to = 0; k < end; k += itemSize) {
      for (let corner = 0; corner < 4; corner++) {
        for (let n = 0; n < itemSize; n++) array[to++] = values[k + n] ?? 0;
      }
    }
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, 4 * end);
    attribute.needsUpdate = true;
  }

  private allocate(capacity: number): void {
    this.capacity = capacity;
    this.geometry.dispose(); // the buffers on the graphics card are too small
    const squares = Array.from({ length: capacity }, (_, k) => k);
    this.geometry.setIndex(squares.flatMap((k) => FACES.map((corner) => 4 * k + corner)));
    this.set("corner", Float32Array.from(squares.flatMap(() => CORNERS)), 2);
    for (const [name, width] of Object.entries(this.widths)) {
      this.set(name, new Float32Array(4 * width * capacity), width).setUsage(DynamicDrawUsage);
    }
  }

  private set(name: string, values: Float32Array, width: number): BufferAttribute {
    const attribute = new BufferAttribute(values, width);
    this.geometry.setAttribute(name, attribute);
    return attribute;
  }
}
