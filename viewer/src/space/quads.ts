/**
 * Many squares in one geometry, each with numbers of its own.
 *
 * Their corners are written out, not drawn as copies of one square: where the processor draws, each copy would be a
 * drawing of its own.
 */

import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from "three";

const CORNERS = [-1, -1, 1, -1, 1, 1, -1, 1];
const FACES = [0, 1, 2, 0, 2, 3];

/** GLSL: a point of a square that faces a direction. */
export const FACED = `
vec3 faced(vec3 facing, vec2 at) {
  vec3 other = abs(facing.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0);
  vec3 x = normalize(cross(other, facing));
  return at.x * x + at.y * cross(facing, x);
}`;

export class Quads {
  /** Attributes: `corner`, from -1 to 1, and those of each square. */
  readonly geometry = new BufferGeometry();
  count = 0;
  private capacity = 0;

  /** widths: of each attribute, how many numbers a square has. */
  constructor(private readonly widths: Record<string, number>) {
    this.resize(0);
  }

  /** How many there are from now on; room for more is made at once for twice as many. */
  resize(count: number): void {
    if (count > this.capacity || !this.capacity) this.allocate(Math.max(2 * this.capacity, count, 1));
    this.count = count;
    this.geometry.setDrawRange(0, FACES.length * count);
  }

  /** Numbers of an attribute, one square's after the other's. */
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
    this.geometry.dispose(); // what the graphics card has of it is too small
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
