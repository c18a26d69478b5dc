/** Curves of the wire as three's curves. */

import { CatmullRomCurve3, CurvePath, LineCurve3, Vector3, type Curve as Way } from "three";

import { floats } from "../feed/numbers";
import type { Curve } from "../feed/objects";

const CLOSED_CURVE_POINTS = 128; // number of points of a closed curve
const MERGE_DISTANCE = 1e-6; // distance up to which two points count as one [m]

/** Convert a curve to one of three. */
export function way(curve: Curve): Way<Vector3> {
  const points = placed(curve);
  if (curve.type === "circle" || curve.type === "lissajous") {
    return new CatmullRomCurve3(points, true);
  }
  const path = new CurvePath<Vector3>();
  for (let k = 1; k < points.length; k++) {
    const [a, b] = [points[k - 1], points[k]];
    if (a && b && a.distanceTo(b) > MERGE_DISTANCE) path.add(new LineCurve3(a, b));
  }
  return path;
}

function placed(curve: Curve): Vector3[] {
  switch (curve.type) {
    case "line":
      return [new Vector3(-curve.length / 2, 0, 0), new Vector3(curve.length / 2, 0, 0)];
    case "circle":
      return around((s) => new Vector3(Math.cos(s), Math.sin(s), 0).multiplyScalar(curve.radius));
    case "lissajous": {
      const { width, height, a, b } = curve;
      const phase = (curve.phase * Math.PI) / 180;
      return around(
        (s) =>
          new Vector3((width / 2) * Math.sin(a * s + phase), (height / 2) * Math.sin(b * s), 0),
        Math.max(a, b),
      );
    }
    case "polyline": {
      const numbers = floats(curve.points);
      const points: Vector3[] = [];
      for (let k = 0; k + 2 < numbers.length; k += 3) {
        points.push(new Vector3(numbers[k], numbers[k + 1], numbers[k + 2]));
      }
      const [first] = points;
      if (curve.closed && first) points.push(first.clone());
      return points;
    }
  }
}

function around(at: (angle: number) => Vector3, turns = 1): Vector3[] {
  const count = CLOSED_CURVE_POINTS * Math.min(turns, 16);
  return Array.from({ length: count }, (_, k) => at((2 * Math.PI * k) / count));
}
