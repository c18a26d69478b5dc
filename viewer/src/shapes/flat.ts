/** Open surfaces: rectangles, discs, height maps. */

import { BufferAttribute, BufferGeometry, CircleGeometry, PlaneGeometry } from "three";

import { floats } from "../feed/numbers";
import type { Shell } from "../feed/objects";

const OUTLINE_POINTS = 72;

type Flat = Extract<Shell, { type: "rectangle" | "disc" | "height-map" }>;

export function isFlat(shape: { type: string }): shape is Flat {
  return ["rectangle", "disc", "height-map"].includes(shape.type);
}

/** Return the geometry of an open surface in its own frame, facing +z. */
export function flat(shape: Flat): BufferGeometry {
  switch (shape.type) {
    case "rectangle":
      return new PlaneGeometry(shape.width, shape.height);
    case "disc":
      return new CircleGeometry(shape.radius, OUTLINE_POINTS);
    case "height-map":
      return heightMap(shape);
  }
}

/** Rows are those of a picture: the first one has the largest y. */
function heightMap(shape: Extract<Flat, { type: "height-map" }>): BufferGeometry {
  const { width, height, depth } = shape;
  const [rows, columns] = shape.grid;
  const heights = floats(shape.heights);
  const points = new Float32Array(3 * rows * columns);
  const faces: number[] = [];
  for (let r = 0; r < rows; r++) {
    for (let c = 0; c < columns; c++) {
      const k = r * columns + c;
      points[3 * k] = (c / (columns - 1) - 0.5) * width;
      points[3 * k + 1] = (0.5 - r / (rows - 1)) * height;
      points[3 * k + 2] = depth * (heights[k] ?? 0);
      if (r && c) faces.push(k, k - columns, k - columns - 1, k, k - columns - 1, k - 1);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  geometry.setIndex(faces);
  geometry.computeVertexNormals();
  return geometry;
}
