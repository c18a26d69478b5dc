/** Sizes of the rings of samples, chosen so that neighbours do not cover each other. */

const RADIUS_SHARE = 0.55; // radius relative to the distance of neighbours; rings of equal pressure just overlap
const MIN_RADIUS = 0.0007; // smallest radius [m]
const SAME_PLACE_DISTANCE = 1e-4; // distance up to which two samples are at one place [m]

/**
 * Return, for each sample, the radius of its object's largest ring [m]. It follows from the median distance between the
 * object's nearest samples, and is at most `most`. points: three numbers each [m]. index: the object of each sample.
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
      if (square > SAME_PLACE_DISTANCE * SAME_PLACE_DISTANCE && square < least) least = square;
    }
    nearest.set(own, [...(nearest.get(own) ?? []), Math.sqrt(least)]);
  }
  const sizes = new Map<number, number>();
  for (const [own, distances] of nearest) {
    const middle = distances.sort((a, b) => a - b)[distances.length >> 1] ?? Infinity;
    sizes.set(own, Math.min(Math.max(RADIUS_SHARE * middle, MIN_RADIUS), most));
  }
  return Float32Array.from({ length: count }, (_, m) => sizes.get(index[m] ?? 0) ?? most);
}
