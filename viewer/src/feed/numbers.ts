/** Bulk numbers: bytes that may begin anywhere in a message, as arrays of numbers that may not. */

import type { Bytes } from "./messages";

/** float64 numbers, a copy. */
export function doubles(data: Bytes): Float64Array<ArrayBuffer> {
  return new Float64Array(copied(data, 8));
}

/** float32 numbers, a copy. */
export function floats(data: Bytes): Float32Array<ArrayBuffer> {
  return new Float32Array(copied(data, 4));
}

/** uint32 numbers, a copy. */
export function indices(data: Bytes): Uint32Array<ArrayBuffer> {
  return new Uint32Array(copied(data, 4));
}

/** Write bytes over the numbers of an array, as many as both have. */
export function into(
  target: Float32Array<ArrayBuffer> | Uint16Array<ArrayBuffer>,
  data: Bytes,
): void {
  const size = target.BYTES_PER_ELEMENT;
  const bytes = Math.min(target.byteLength, data.length - (data.length % size));
  new Uint8Array(target.buffer, target.byteOffset, bytes).set(data.subarray(0, bytes));
}

/** Whether these of two messages are byte for byte the same. */
export function same<K extends string>(a: Record<K, Bytes>, b: Record<K, Bytes>, ...names: K[]): boolean {
  return names.every((name) => {
    const [x, y] = [a[name], b[name]];
    return x.length === y.length && x.every((byte, k) => byte === y[k]);
  });
}

function copied(data: Bytes, size: number): ArrayBuffer {
  const end = data.byteOffset + data.length - (data.length % size);
  return data.buffer.slice(data.byteOffset, end);
}
