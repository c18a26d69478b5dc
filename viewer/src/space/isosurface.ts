/** The surface at which the radiation pressure equals a level. */

import { BufferGeometry, Vector3 } from "three";

import type { Volume } from "../feed/messages";
import { floats } from "../feed/numbers";
import { surface } from "../shapes/marching-cubes";
import { Translucent, type Turned } from "./translucent";

export class Isosurface implements Turned {
  readonly glass = new Translucent(new BufferGeometry(), { colour: "#9fd46b", body: 0.72 });
  readonly middle = new Vector3();
  private values = new Float32Array(0);
  private volume: Volume | undefined;

  set turn(turn: number) {
    this.glass.turn = turn;
  }

  /** Number of triangles. */
  get triangles(): number {
    return (this.glass.meshes[0]?.geometry.getIndex()?.count ?? 0) / 3;
  }

  show(volume: Volume): void {
    const { origin, spacing, shape } = volume;
    this.volume = volume;
    this.values = floats(volume.pressure);
    const half = ([0, 1, 2] as const).map((n) => origin[n] + ((shape[n] - 1) * spacing) / 2);
    this.middle.fromArray(half);
  }

  /** Compute the surface of a level [Pa], and set its colour. */
  cut(level: number, colour: string): void {
    if (!this.volume || !(level > 0)) return;
    for (const mesh of this.glass.meshes) mesh.geometry.dispose();
    this.glass.geometry = surface({ ...this.volume, values: this.values }, level);
    this.glass.colour = colour;
    this.glass.visible = true;
  }

  clear(): void {
    this.glass.visible = false;
    this.volume = undefined;
    this.values = new Float32Array(0);
  }
}
