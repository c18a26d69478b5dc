/** How large the rings of samples may be, so that neighbours do not cover each other. */

const SHARE = 0.55; // of the distance of neighbours: rings of equal pressure just overlap
const LEAST = 0.0007; // [m]
const SAME = 1e-4; // [m]: no farther apart is in one place

/**
 * The radius of each object's largest ring [m], for each sample: by the median distance of its samples to the nearest
 * other one, and at most `most`. points: three numbers of each [m]. index: which object each is of.
 */
export function radii(points: Float32Array, index: ArrayLike<number>, most: number): Float32Array {
  const count = Math.floor(points.length / 3);
  const nearest = new Map<number, number[]>();
  for (let m = 0; m < count; m++) {
    const own = index[m] ?? 0;
    let least = Infinity;
    for (let n = 0; n < count; n++) {
      if (n === m || (index[n] ?? 0) !== own) continue;
      let square = 0;
      for (let k = 0; k < 3; k++) square += ((points[3 * m + k] ?? 0) - (points[3 * n + k] ?? 0)) ** 2;
      if (square > SAME * SAME && square < least) least = square;
    }
    nearest.set(own, [...(nearest.get(own) ?? []), Math.sqrt(least)]);
  }
  const sizes = new Map<number, number>();
  for (const [own, distances] of nearest) {
    const middle = distances.sort((a, b) => a - b)[distances.length >> 1] ?? Infinity;
    sizes.set(own, Math.min(Math.max(SHARE * middle, LEAST), most));
  }
  return Float32Array.from({ length: count }, (_, m) => sizes.get(index[m] ?? 0) ?? most);
}
