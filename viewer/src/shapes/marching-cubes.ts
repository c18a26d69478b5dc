/** Marching cubes (Lorensen and Cline, 1987) with three's tables: the surface at which values equal a level. */

import { BufferAttribute, BufferGeometry } from "three";
import { edgeTable, triTable } from "three/addons/objects/MarchingCubes.js";

import type { Triple } from "../feed/messages";

/** Values at the points of a grid; z varies fastest. NaN counts as 0. */
export interface Grid {
  values: Float32Array;
  shape: Triple;
  origin: Triple;
  spacing: number;
}

// Corners of a cell in the order of the tables, and the two corners of each edge.
const CORNERS = [
  [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
] as const; // prettier-ignore
const EDGES = [
  [0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7],
] as const; // prettier-ignore

/** Return the surface at `level`, with normals towards lower values; empty if the level is not crossed. */
export function surface(grid: Grid, level: number): BufferGeometry {
  const { values, shape, origin, spacing } = grid;
  const [X, Y, Z] = shape;
  const step = [Y * Z, Z, 1] as const;
  const at = (k: number): number => {
    const value = values[k] ?? 0;
    return value === value ? value : 0;
  };
  const points: number[] = [];
  const faces: number[] = [];
  const made = new Map<number, number>(); // index of each vertex, by its edge
  const offsets = CORNERS.map(([x, y, z]) => x * step[0] + y * step[1] + z * step[2]);
  const cell = new Int32Array(12);

  const vertex = (i: number, j: number, k: number, edge: number): number => {
    const [a, b] = EDGES[edge] ?? EDGES[0];
    const low = CORNERS[a];
    const high = CORNERS[b];
    const axis = low.findIndex((x, n) => x !== high[n]);
    const first = (i * Y + j) * Z + k;
    const p = first + (offsets[a] ?? 0);
    const q = first + (offsets[b] ?? 0);
    const key = 3 * Math.min(p, q) + axis;
    const known = made.get(key);
    if (known !== undefined) return known;
    const u = at(p);
    const v = at(q);
    const t = u === v ? 0.5 : (level - u) / (v - u);
    const place = [i, j, k];
    for (let n = 0; n < 3; n++) {
      const x = (place[n] ?? 0) + (low[n] ?? 0) + t * ((high[n] ?? 0) - (low[n] ?? 0));
      points.push((origin[n] ?? 0) + spacing * x);
    }
    const index = points.length / 3 - 1;
    made.set(key, index);
    return index;
  };

  for (let i = 0; i < X - 1; i++) {
    for (let j = 0; j < Y - 1; j++) {
      for (let k = 0; k < Z - 1; k++) {
        const first = (i * Y + j) * Z + k;
        let kind = 0;
        for (let c = 0; c < 8; c++) {
          if (at(first + (offsets[c] ?? 0)) < level) kind |= 1 << c;
        }
        const crossed = edgeTable[kind] ?? 0;
        if (!crossed) continue;
        for (let edge = 0; edge < 12; edge++) {
          if (crossed & (1 << edge)) cell[edge] = vertex(i, j, k, edge);
        }
        for (let n = 16 * kind; (triTable[n] ?? -1) >= 0; n += 3) {
          for (let corner = 0; corner < 3; corner++) {
            faces.push(cell[triTable[n + corner] ?? 0] ?? 0);
          }
        }
      }
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(faces), 1));
  geometry.computeVertexNormals();
  return geometry;
}
