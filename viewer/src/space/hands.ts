/** Hands: a capsule around each bone, and some that fill the palm, as the server's own hands have them. */

import { CapsuleGeometry, Vector3 } from "three";

import type { Bytes } from "../feed/messages";
import { into } from "../feed/numbers";
import { Glass, SHADED } from "./glass";
import { Instances } from "./instances";

export const JOINTS = 26; // of OpenXR
const PALM = 0;
const SKIN = "#f2c4a4";

/** From each joint to the skin, an adult's [m]. */
const RADII = [
  20, 21, 19, 12.5, 10, 8.5, 20, 10.5, 8.5, 7.5, 6.5, 20, 11, 8.5, 7.5, 6.5, 19, 10, 8, 7.5,
  6.5, 18, 8.5, 7, 6.5, 5.5,
].map((millimetres) => millimetres / 1000);

/** A line from the middle of two joints to the middle of two others. */
type Bone = readonly [number, number, number, number];

function between(a: number, b: number): Bone {
  return [a, a, b, b];
}

const DIGITS = [6, 11, 16, 21];
const BONES: Bone[] = [
  between(2, 3),
  between(3, 4),
  between(4, 5),
  ...DIGITS.flatMap((first) => [0, 1, 2, 3].map((k) => between(first + k, first + k + 1))),
  ...[6, 11, 16].map((j): Bone => [j, j + 5, j + 1, j + 6]), // among the metacarpals
  ...[2, 6, 11, 21].map((j) => between(1, j)), // the wrist
  [2, 3, 6, 7], // the web of the thumb
];

const VERTEX = `
attribute vec3 base, tip;
attribute float thick;
${SHADED}
void main() {
  vec3 z = tip - base;
  float size = length(z);
  z = size > 1e-6 ? z / size : vec3(0.0, 0.0, 1.0);
  vec3 x = normalize(cross(abs(z.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0), z));
  mat3 turned = mat3(x, z, cross(x, z));
  vec3 outward = turned * normal;
  vec4 p = modelViewMatrix * vec4((position.y > 0.0 ? tip : base) + thick * outward, 1.0);
  facing = normalMatrix * outward;
  seen = -p.xyz;
  gl_Position = projectionMatrix * p;
}`;

export class Hands {
  readonly glass: Glass;
  /** Where the first palm is. */
  readonly middle = new Vector3();
  private readonly bones: Instances;
  private joints = new Float32Array(0);

  constructor() {
    // its own vertices only tell the end and the direction
    const capsule = new CapsuleGeometry(1, 1, 6, 14);
    this.bones = new Instances(capsule, { base: 3, tip: 3, thick: 1 });
    this.glass = new Glass(this.bones.geometry, { colour: SKIN, body: 0.42, vertex: VERTEX });
    this.glass.visible = false;
  }

  get count(): number {
    return Math.floor(this.joints.length / (3 * JOINTS));
  }

  set turn(turn: number) {
    this.glass.turn = turn;
  }

  /** Their joints, (hands, 26, 3) float32 [m]. */
  show(data: Bytes): void {
    const numbers = Math.floor(data.length / (12 * JOINTS)) * 3 * JOINTS;
    if (numbers !== this.joints.length) this.joints = new Float32Array(numbers);
    into(this.joints, data);
    this.glass.visible = numbers > 0;
    this.bones.resize(this.count * BONES.length);
    this.middle.fromArray(this.joints.length ? this.joints : [0, 0, 0], 3 * PALM);
    for (let hand = 0; hand < this.count; hand++) this.write(hand);
    this.bones.change("base", "tip", "thick");
  }

  private write(hand: number): void {
    const base = this.bones.values("base");
    const tip = this.bones.values("tip");
    const thick = this.bones.values("thick");
    const J = this.joints;
    const first = 3 * JOINTS * hand;
    let k = BONES.length * hand;
    for (const [i, j, l, m] of BONES) {
      for (let x = 0; x < 3; x++) {
        base[3 * k + x] = ((J[first + 3 * i + x] ?? 0) + (J[first + 3 * j + x] ?? 0)) / 2;
        tip[3 * k + x] = ((J[first + 3 * l + x] ?? 0) + (J[first + 3 * m + x] ?? 0)) / 2;
      }
      thick[k] = ((RADII[i] ?? 0) + (RADII[j] ?? 0) + (RADII[l] ?? 0) + (RADII[m] ?? 0)) / 4;
      k += 1;
    }
  }
}
