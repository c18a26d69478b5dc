/** Textures on pressure, for the graphics card. */

import {
  ClampToEdgeWrapping,
  DataTexture,
  LinearFilter,
  NoColorSpace,
  RedFormat,
  RepeatWrapping,
} from "three";

import { floats } from "../feed/numbers";
import type { Texture } from "../feed/objects";

/** Convert a texture, with one byte for each value. Rows are reversed, because v grows with y. */
export function image(texture: Texture): DataTexture {
  const [rows, columns] = texture.grid;
  const values = floats(texture.values);
  const bytes = new Uint8Array(rows * columns);
  for (let r = 0; r < rows; r++) {
    for (let c = 0; c < columns; c++) {
      bytes[(rows - 1 - r) * columns + c] = Math.round(255 * (values[r * columns + c] ?? 0));
    }
  }
  const made = new DataTexture(bytes, columns, rows, RedFormat);
  made.unpackAlignment = 1;
  made.colorSpace = NoColorSpace;
  made.minFilter = made.magFilter = LinearFilter;
  made.wrapS = made.wrapT = texture.repeat ? RepeatWrapping : ClampToEdgeWrapping;
  made.needsUpdate = true;
  return made;
}
