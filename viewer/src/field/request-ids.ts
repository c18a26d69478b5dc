/** Numbers of requests for slices and volumes, which must not share them. */

let last = 0;

export function nextId(): number {
  last += 1;
  return last;
}
