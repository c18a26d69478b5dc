/** Solids as closed triangle meshes. three-bvh-csg combines them. */

import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  Matrix4,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { ADDITION, Brush, Evaluator, INTERSECTION, SUBTRACTION } from "three-bvh-csg";

import { floats, indices } from "../feed/numbers";
import type { Part, Pose, Primitive, Solid } from "../feed/objects";
import { surface } from "./marching-cubes";

/** Return the meshes of a combined solid's parts, of a difference only the first; none for other solids. */
export function parts(shape: Solid): BufferGeometry[] {
  if (shape.type === "difference") return [part(shape.of)];
  if (shape.type === "union" || shape.type === "intersection") return shape.parts.map(part);
  return [];
}

/** Return the mesh in the solid's own frame. Throws three-bvh-csg's error if a part is not closed. */
export function solid(shape: Solid): BufferGeometry {
  switch (shape.type) {
    case "union":
      return combined(shape.parts, ADDITION);
    case "intersection":
      return combined(shape.parts, INTERSECTION);
    case "difference":
      return combined([shape.of, ...shape.less], SUBTRACTION);
    default:
      return part(shape);
  }
}

function part(shape: Part): BufferGeometry {
  return shape.type === "placed"
    ? primitive(shape.shape).applyMatrix4(matrix(shape.pose))
    : primitive(shape);
}

function primitive(shape: Primitive): BufferGeometry {
  switch (shape.type) {
    case "sphere":
      return new SphereGeometry(shape.radius, 48, 32).rotateX(Math.PI / 2);
    case "box":
      return new BoxGeometry(...shape.size);
    case "capsule":
      return new CapsuleGeometry(shape.radius, shape.length, 12, 40).rotateX(Math.PI / 2);
    case "mesh":
      return mesh(floats(shape.vertices), indices(shape.faces), shape.scale);
    case "voxels":
      return voxels(shape);
  }
}

function mesh(points: Float32Array, faces: Uint32Array, scale: number): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setIndex(new BufferAttribute(faces, 1));
  geometry.scale(scale, scale, scale);
  const free = geometry.toNonIndexed(); // so that edges stay sharp
  free.computeVertexNormals();
  return free;
}

/** Return the surface of voxels. The grid gets a border of zeros, so that the surface is closed. */
function voxels(shape: Extract<Primitive, { type: "voxels" }>): BufferGeometry {
  const { grid, pitch, level } = shape;
  const values = floats(shape.values);
  const [X, Y, Z] = [grid[0] + 2, grid[1] + 2, grid[2] + 2];
  const padded = new Float32Array(X * Y * Z);
  for (let x = 0; x < grid[0]; x++) {
    for (let y = 0; y < grid[1]; y++) {
      const row = (x * grid[1] + y) * grid[2];
      const place = ((x + 1) * Y + y + 1) * Z + 1;
      padded.set(values.subarray(row, row + grid[2]), place);
    }
  }
  const half = (n: number): number => (-pitch * (n - 1)) / 2;
  return surface(
    {
      values: padded,
      shape: [X, Y, Z],
      origin: [half(X), half(Y), half(Z)],
      spacing: pitch,
    },
    level,
  );
}

function combined(parts: Part[], how: typeof ADDITION): BufferGeometry {
  const evaluator = new Evaluator();
  evaluator.attributes = ["position", "normal"];
  evaluator.useGroups = false;
  const [first, ...others] = parts.map((each) => {
    const brush = new Brush(part(each));
    brush.updateMatrixWorld();
    return brush;
  });
  if (!first) return new BufferGeometry();
  return others.reduce((made, next) => evaluator.evaluate(made, next, how), first).geometry;
}

/** Convert a pose to a matrix. */
export function matrix({ position, rotation }: Pose): Matrix4 {
  return new Matrix4().compose(
    new Vector3(...position),
    new Quaternion(...rotation),
    new Vector3(1, 1, 1),
  );
}
