/** The objects of the rendered scene, at their present poses. */

import { Group, InstancedMesh, Texture, Vector3, type Mesh, type Object3D, type ShaderMaterial } from "three";

import type { Bytes, Scenery } from "../feed/messages";
import { into } from "../feed/numbers";
import type { Thing } from "../feed/objects";
import { made, type Made } from "../shapes/geometry";
import { Translucent, type Turned } from "./translucent";
import { Label, shorten, type Kept } from "./labels";

const MAX_LABELS = 12; // largest number of objects whose names are shown
const LABEL_HEIGHT = 0.006; // distance of a name above its object [m]

export class Placed extends Group implements Turned {
  readonly middle = new Vector3();
  readonly label: Label;
  private readonly numbers = new Float32Array(7);

  constructor(
    name: string,
    readonly thing: Thing,
    private readonly shown: Made,
  ) {
    super();
    this.label = new Label(`${shorten(name)}${shown.drawn ? "" : " (outline)"}`);
    this.add(shown.object);
  }

  /** Distance from its origin to its farthest point [m]. */
  get reach(): number {
    return this.shown.reach;
  }

  get drawn(): boolean {
    return this.shown.drawn;
  }

  set turn(turn: number) {
    if (this.shown.object instanceof Translucent) this.shown.object.turn = turn;
  }

  /** Set the pose: x, y, z [m], quaternion x, y, z, w. */
  move(pose: Bytes): void {
    into(this.numbers, pose);
    this.position.fromArray(this.numbers);
    this.quaternion.fromArray(this.numbers, 3);
    this.middle.copy(this.position);
    this.label.position.copy(this.position);
    this.label.position.z += this.shown.reach + LABEL_HEIGHT;
  }

  override dispose(): void {
    this.label.dispose();
    this.shown.object.traverse(free);
  }
}

export class Objects {
  readonly group = new Group();
  readonly all = new Map<string, Placed>();

  show({ objects, poses }: Scenery): void {
    for (const name of this.all.keys()) {
      if (!Object.hasOwn(poses, name) || Object.hasOwn(objects, name)) this.remove(name);
    }
    for (const [name, thing] of Object.entries(objects)) {
      if (Object.hasOwn(poses, name)) this.add(name, thing);
    }
    for (const [name, pose] of Object.entries(poses)) this.all.get(name)?.move(pose);
  }

  /**
   * Hide names that would cover one of `kept` or another name, or all if there are many. Add the visible ones to `kept`.
   * project: returns where a point is on the page [px].
   */
  separate(project: (point: Vector3) => { x: number; y: number }, kept: Kept[]): void {
    const few = this.all.size <= MAX_LABELS;
    for (const { label } of this.all.values()) {
      if (few) label.showIfClear(project(label.position), kept);
      else label.visible = false;
    }
  }

  /** Remove all objects. */
  clear(): void {
    for (const name of [...this.all.keys()]) this.remove(name);
  }

  private add(name: string, thing: Thing): void {
    const placed = new Placed(name, thing, made(thing));
    this.all.set(name, placed);
    this.group.add(placed, placed.label);
  }

  private remove(name: string): void {
    const placed = this.all.get(name);
    if (!placed) return;
    this.group.remove(placed, placed.label);
    placed.dispose();
    this.all.delete(name);
  }
}

/** Free the memory of an object on the graphics card. */
function free(object: Object3D): void {
  const { geometry, material } = object as Partial<Mesh>;
  geometry?.dispose();
  for (const each of material ? [material].flat() : []) {
    for (const { value } of Object.values((each as Partial<ShaderMaterial>).uniforms ?? {})) {
      if (value instanceof Texture) value.dispose();
    }
    each.dispose();
  }
  if (object instanceof InstancedMesh) object.dispose();
}
