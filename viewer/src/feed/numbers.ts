/** Bulk numbers: bytes that may begin anywhere in a message, as arrays of numbers that may not. */

import type { Bytes } from "./messages";

/** float32 numbers, a copy. */
export function floats(data: Bytes): Float32Array<ArrayBuffer> {
  return new Float32Array(copied(data, 4));
}

/** uint32 numbers, a copy. */
export function indices(data: Bytes): Uint32Array<ArrayBuffer> {
  return new Uint32Array(copied(data, 4));
}

/** Write bytes over the numbers of an array, as many as both have; the count of them. */
export function into(
  target: Float32Array<ArrayBuffer> | Uint16Array<ArrayBuffer>,
  data: Bytes,
): number {
  const size = target.BYTES_PER_ELEMENT;
  const bytes = Math.min(target.byteLength, data.length - (data.length % size));
  const from = bytes === data.length ? data : data.subarray(0, bytes);
  new Uint8Array(target.buffer, target.byteOffset, bytes).set(from);
  return bytes / size;
}

function copied(data: Bytes, size: number): ArrayBuffer {
  const end = data.byteOffset + data.length - (data.length % size);
  return data.buffer.slice(data.byteOffset, end);
}
