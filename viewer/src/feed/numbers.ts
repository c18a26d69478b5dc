/** Packed numbers of messages as typed arrays. They are copied, because typed arrays need aligned bytes. */

import type { Bytes } from "./messages";

/** Copy float64 numbers. */
export function doubles(data: Bytes): Float64Array<ArrayBuffer> {
  return new Float64Array(copied(data, 8));
}

/** Copy float32 numbers. */
export function floats(data: Bytes): Float32Array<ArrayBuffer> {
  return new Float32Array(copied(data, 4));
}

/** Copy uint32 numbers. */
export function indices(data: Bytes): Uint32Array<ArrayBuffer> {
  return new Uint32Array(copied(data, 4));
}

/** Overwrite the numbers of an array with packed ones, as far as both reach. */
export function into(
  target: Float32Array<ArrayBuffer> | Uint16Array<ArrayBuffer>,
  data: Bytes,
): void {
  const size = target.BYTES_PER_ELEMENT;
  const bytes = Math.min(target.byteLength, data.length - (data.length % size));
  new Uint8Array(target.buffer, target.byteOffset, bytes).set(data.subarray(0, bytes));
}

/** Return whether these fields of two messages have the same bytes. */
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
