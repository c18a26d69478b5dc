/** Hands: a capsule around each bone, and capsules that fill the palm, as in the server's hand model. */

import {
  Box3,
  CapsuleGeometry,
  DataTexture,
  Float32BufferAttribute,
  FloatType,
  Group,
  Matrix4,
  NearestFilter,
  type Ray,
  RedFormat,
  Vector3,
  Vector4,
  type BufferGeometry,
  type IUniform,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

import type { Bytes, Plane } from "../feed/messages";
import { floats } from "../feed/numbers";
import { Translucent, SHADED, type Turned } from "./translucent";
import { pressureMap } from "./map-textures";
import { matrix } from "./planes";
import { drawnBySoftware } from "./software-rendering";

const JOINTS = 26; // joints of OpenXR
const PALM = 0;
const PAINTED_DEPTH = 0.025; // range of the painting, before and behind its square [m]
const SKIN = "#f2c4a4";

/** Distance from each joint to the skin of an adult [m]. */
const RADII = [
  20, 21, 19, 12.5, 10, 8.5, 20, 10.5, 8.5, 7.5, 6.5, 20, 11, 8.5, 7.5, 6.5, 19, 10, 8, 7.5,
  6.5, 18, 8.5, 7, 6.5, 5.5,
].map((millimetres) => millimetres / 1000);

/** Four joints; the bone goes from the middle of the first two to the middle of the others. */
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
  ...[6, 11, 16].map((j): Bone => [j, j + 5, j + 1, j + 6]), // between the metacarpals
  ...[2, 6, 11, 21].map((j) => between(1, j)), // the wrist
  [2, 3, 6, 7], // the web of the thumb
];
const THICK = BONES.map((joints) => joints.reduce((sum, j) => sum + (RADII[j] ?? 0) / 4, 0));

const VERTEX = `
attribute float bone;
uniform vec4 base[${BONES.length}]; // position and radius
uniform vec3 tip[${BONES.length}];
${SHADED}
uniform mat4 square; // from world coordinates to those of the painted square
uniform vec3 before; // normal of the painted square
varying vec4 spot;
void main() {
  vec4 from = base[int(bone)];
  vec3 to = tip[int(bone)];
  vec3 z = to - from.xyz;
  float size = length(z);
  z = size > 1e-6 ? z / size : vec3(0.0, 0.0, 1.0);
  vec3 x = normalize(cross(abs(z.z) < 0.9 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0), z));
  mat3 turned = mat3(x, z, cross(x, z));
  vec3 outward = turned * normal;
  vec3 place = (position.y > 0.0 ? to : from.xyz) + from.w * outward;
  spot = vec4((square * vec4(place, 1.0)).xyz, dot(outward, before));
  vec4 p = modelViewMatrix * vec4(place, 1.0);
  facing = normalMatrix * outward;
  seen = -p.xyz;
  gl_Position = projectionMatrix * p;
}`;

/** Make a capsule for each bone. The shader reads only the end and the direction of each vertex. */
function bones(): BufferGeometry {
  const [along, around] = drawnBySoftware() ? [4, 10] : [6, 14];
  const capsule = new CapsuleGeometry(1, 1, along, around);
  const count = capsule.getAttribute("position").count;
  return mergeGeometries(
    BONES.map((_, k) =>
      capsule.clone().setAttribute("bone", new Float32BufferAttribute(Array(count).fill(k), 1)),
    ),
  );
}

/** Uniforms of the painted pressure, which all hands share. */
interface Painting {
  [name: string]: IUniform;
  paint: IUniform<DataTexture | null>;
  colours: IUniform<DataTexture>;
  top: IUniform<number>;
  deep: IUniform<number>;
  square: IUniform<Matrix4>;
  before: IUniform<Vector3>;
}

class Hand extends Translucent implements Turned {
  /** Position of the palm [m]. */
  readonly middle = new Vector3();
  private readonly base: Vector4[];
  private readonly tip: Vector3[];
  private readonly from = new Vector3();

  constructor(geometry: BufferGeometry, painting: Painting) {
    const base = THICK.map((thick) => new Vector4(0, 0, 0, thick));
    const tip = THICK.map(() => new Vector3());
    const uniforms = { base: { value: base }, tip: { value: tip }, ...painting };
    super(geometry, { colour: SKIN, body: 0.42, vertex: VERTEX, uniforms, painted: true });
    this.base = base;
    this.tip = tip;
  }

  /** Set the positions of the joints, three numbers each [m]. */
  show(joints: Float32Array): void {
    const middle = (i: number, j: number, axis: number): number =>
      ((joints[3 * i + axis] ?? 0) + (joints[3 * j + axis] ?? 0)) / 2;
    for (const [k, [i, j, l, m]] of BONES.entries()) {
      this.base[k]?.setX(middle(i, j, 0)).setY(middle(i, j, 1)).setZ(middle(i, j, 2));
      this.tip[k]?.set(middle(l, m, 0), middle(l, m, 1), middle(l, m, 2));
    }
    this.middle.fromArray(joints, 3 * PALM);
  }

  /** Return whether a ray passes the skin within a distance [m]. */
  isNear(ray: Ray, distance: number): boolean {
    return this.base.some(({ x, y, z, w }, k) => {
      const tip = this.tip[k];
      return tip && ray.distanceSqToSegment(this.from.set(x, y, z), tip) < (w + distance) ** 2;
    });
  }
}

export class Hands {
  readonly group = new Group();
  /** Box around all joints [m]. */
  readonly box = new Box3();
  count = 0;
  /** Whether the painted pressure shines through from the far side of the hand. */
  through = true;
  private readonly all: Hand[] = [];
  private readonly geometry = bones();
  private readonly joint = new Vector3();
  private readonly painting: Painting = {
    paint: { value: null },
    colours: { value: pressureMap },
    top: { value: 0 },
    deep: { value: PAINTED_DEPTH },
    square: { value: new Matrix4() },
    before: { value: new Vector3(0, 0, 1) },
  };

  /** The visible hands. */
  get shown(): Turned[] {
    return this.all.slice(0, this.count);
  }

  /** Paint the achieved pressure on all hands. top: top of the colour scale [Pa]. */
  paint(plane: Plane, felt: Float32Array<ArrayBuffer>, top: number): void {
    const { painting } = this;
    const [rows, columns] = plane.shape;
    painting.paint.value?.dispose();
    const texture = new DataTexture(felt, columns, rows, RedFormat, FloatType);
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    painting.paint.value = texture;
    painting.top.value = top;
    const placed = matrix(plane, new Matrix4());
    painting.before.value.setFromMatrixColumn(placed, 2);
    painting.square.value.copy(placed).invert();
  }

  /** Remove the painting. */
  unpaint(): void {
    this.painting.top.value = 0;
  }

  get painted(): boolean {
    return this.count > 0 && this.painting.top.value > 0;
  }

  /** Return whether a ray passes a hand within a distance. margin: that distance over the hand's from the ray's origin. */
  covers(ray: Ray, margin: number): boolean {
    const near = (hand: Hand): boolean => hand.isNear(ray, margin * hand.middle.distanceTo(ray.origin));
    return this.all.slice(0, this.count).some(near);
  }

  /** Show hands. data: joints, (hands, 26, 3) float32 [m]. */
  show(data: Bytes): void {
    const joints = floats(data);
    this.count = Math.floor(joints.length / (3 * JOINTS));
    this.box.makeEmpty();
    for (let k = 0; k + 2 < joints.length; k += 3) this.box.expandByPoint(this.joint.fromArray(joints, k));
    while (this.all.length < this.count) {
      const hand = new Hand(this.geometry, this.painting);
      this.all.push(hand);
      this.group.add(hand);
    }
    for (const [k, hand] of this.all.entries()) {
      hand.visible = k < this.count;
      hand.through = this.through;
      if (hand.visible) hand.show(joints.subarray(3 * JOINTS * k, 3 * JOINTS * (k + 1)));
    }
  }
}
