/** Makes three's objects for the objects of the scene, in their own frames. */

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
const BODY_OPACITY = 0.34;
const LINE_RADIUS = 0.0011; // radius of a drawn line [m]
const TUBE_SEGMENTS = 256; // number of segments of a tube

/** A drawn object. drawn: false if only its outline is. reach: distance from the origin to the farthest point [m]. */
export interface Made {
  object: Object3D;
  drawn: boolean;
  reach: number;
}

/** Make the object, or only its outline if it cannot be meshed. Never throws. */
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
      return new Mesh(new TubeGeometry(curve, TUBE_SEGMENTS, LINE_RADIUS, 8, closed), plain(LINE));
    }
    case "surface":
    case "volume": {
      const open = isFlat(thing.shape);
      const geometry = shaped(thing.shape);
      if (!geometry.getAttribute("position")?.count) throw new Error("has no surface");
      const texture = thing.texture;
      return new Translucent(geometry, {
        colour: open ? OPEN : SOLID,
        body: BODY_OPACITY,
        open: open || thing.type === "surface",
        ...(texture ? { texture: { map: image(texture), size: texture.size } } : {}),
      });
    }
  }
}

/** Return the geometry of a shape in its own frame. */
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

/** Return the box around the parts of an object that cannot be drawn. */
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

/** Return the distance from the origin to the farthest corner of the bounding box [m]. */
function reach(object: Object3D): number {
  const box = new Box3().setFromObject(object);
  return Math.max(box.min.length(), box.max.length());
}
