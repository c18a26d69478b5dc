/** Numbers for requests. Slices, volumes and skin maps must not share numbers. */

let last = 0;

export function nextId(): number {
  last += 1;
  return last;
}
