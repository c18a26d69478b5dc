/** An object of the scene as something to be drawn, in its own frame. */

import {
  Box3,
  Box3Helper,
  BufferGeometry,
  Color,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  Mesh,
  Object3D,
  SphereGeometry,
  TubeGeometry,
  Vector3,
} from "three";

import { floats } from "../feed/numbers";
import type { Shape, Thing } from "../feed/objects";
import { Translucent } from "../space/translucent";
import { way } from "./curves";
import { flat, isFlat } from "./flat";
import { parts, solid } from "./solid";
import { image } from "./texture";

const SOLID = "#6f9ed6";
const OPEN = "#7fb8c9";
const LINE = "#9ad0e0";
const BODY = 0.34;
const THIN = 0.0011; // [m] radius of a drawn line
const PIECES = 256; // of a tube

/** What is drawn. drawn: false where only its outline is. reach: of its farthest point from its origin [m]. */
export interface Made {
  object: Object3D;
  drawn: boolean;
  reach: number;
}

/** Never throws: of what cannot be meshed the outline is left. */
export function made(thing: Thing): Made {
  try {
    const object = model(thing);
    return { object, drawn: true, reach: reach(object) };
  } catch {
    const object = outline(thing);
    return { object, drawn: false, reach: reach(object) };
  }
}

function model(thing: Thing): Object3D {
  switch (thing.type) {
    case "point":
      return balls([0, 0, 0], Math.sqrt(thing.area / Math.PI) / 2);
    case "particles":
      return balls(floats(thing.positions), thing.radius / 3);
    case "path": {
      const curve = way(thing.shape);
      const closed = thing.shape.type !== "line" && thing.shape.type !== "polyline";
      return new Mesh(new TubeGeometry(curve, PIECES, THIN, 8, closed), plain(LINE));
    }
    case "surface":
    case "volume": {
      const open = isFlat(thing.shape);
      const geometry = shaped(thing.shape);
      if (!geometry.getAttribute("position")?.count) throw new Error("has no surface");
      const texture = thing.texture;
      return new Translucent(geometry, {
        colour: open ? OPEN : SOLID,
        body: BODY,
        open: open || thing.type === "surface",
        ...(texture ? { texture: { map: image(texture), size: texture.size } } : {}),
      });
    }
  }
}

/** The geometry of a shape in its own frame. */
export function shaped(shape: Shape): BufferGeometry {
  return isFlat(shape) ? flat(shape) : solid(shape);
}

function balls(centres: ArrayLike<number>, radius: number): InstancedMesh {
  const count = centres.length / 3;
  const ball = new SphereGeometry(radius, 16, 10);
  const mesh = new InstancedMesh(ball, plain(LINE, 0.75), count);
  const matrix = new Matrix4();
  for (let k = 0; k < count; k++) {
    const [x, y, z] = [centres[3 * k] ?? 0, centres[3 * k + 1] ?? 0, centres[3 * k + 2] ?? 0];
    mesh.setMatrixAt(k, matrix.makeTranslation(x, y, z));
  }
  return mesh;
}

function plain(color: string, opacity = 1): MeshBasicMaterial {
  return new MeshBasicMaterial({ color, opacity, transparent: opacity < 1, depthWrite: true });
}

/** The box around the parts of what cannot be drawn itself. */
function outline(thing: Thing): Box3Helper {
  const box = new Box3();
  if (thing.type === "surface" || thing.type === "volume") {
    for (const geometry of isFlat(thing.shape) ? [] : parts(thing.shape)) {
      geometry.computeBoundingBox();
      if (geometry.boundingBox) box.union(geometry.boundingBox);
    }
  }
  if (box.isEmpty()) box.setFromCenterAndSize(new Vector3(), new Vector3(0.01, 0.01, 0.01));
  return new Box3Helper(box, new Color(LINE));
}

/** Of its farthest point from its origin [m]. */
function reach(object: Object3D): number {
  const box = new Box3().setFromObject(object);
  return Math.max(box.min.length(), box.max.length());
}
