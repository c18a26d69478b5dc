/** Many copies of one geometry, each with numbers of its own; they are written in place, and grow when they must. */

import {
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  PlaneGeometry,
  type BufferGeometry,
} from "three";

/** A square from -1 to 1. */
export function square(): BufferGeometry {
  return new PlaneGeometry(2, 2);
}

/** GLSL: a point of a square that faces a direction. */
export const FACED = `
vec3 faced(vec3 facing, vec2 at) {
  vec3 other = abs(facing.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0);
  vec3 x = normalize(cross(other, facing));
  return at.x * x + at.y * cross(facing, x);
}`;

export class Instances {
  readonly geometry = new InstancedBufferGeometry();
  private capacity = 0;
  private readonly arrays = new Map<string, Float32Array<ArrayBuffer>>();

  /** widths: of each attribute, how many numbers a copy has. */
  constructor(
    base: BufferGeometry,
    private readonly widths: Record<string, number>,
  ) {
    for (const [name, attribute] of Object.entries(base.attributes)) {
      this.geometry.setAttribute(name, attribute);
    }
    this.geometry.setIndex(base.getIndex());
    this.resize(0);
  }

  get count(): number {
    return this.geometry.instanceCount;
  }

  /** How many there are from now on; room for more is made at once for twice as many. */
  resize(count: number): void {
    if (count > this.capacity || !this.capacity) this.allocate(Math.max(2 * this.capacity, count, 1));
    this.geometry.instanceCount = count;
  }

  /** The numbers of an attribute, to be written; then call `change`. */
  values(name: string): Float32Array<ArrayBuffer> {
    const values = this.arrays.get(name);
    if (!values) throw new Error(`no attribute ${name}`);
    return values;
  }

  /** What was written is to be shown. */
  change(...names: string[]): void {
    for (const name of names) this.geometry.getAttribute(name).needsUpdate = true;
  }

  private allocate(capacity: number): void {
    this.capacity = capacity;
    this.geometry.dispose(); // what the graphics card has of it is too small
    for (const [name, width] of Object.entries(this.widths)) {
      const values = new Float32Array(width * capacity);
      const attribute = new InstancedBufferAttribute(values, width);
      attribute.setUsage(DynamicDrawUsage);
      this.arrays.set(name, values);
      this.geometry.setAttribute(name, attribute);
    }
  }
}
