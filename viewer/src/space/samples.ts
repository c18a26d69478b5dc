/**
 * Samples: rings whose area is the target pressure, with a fill whose area is the achieved pressure. All rings of an
 * object have the same scale.
 */

import {
  Box3,
  DoubleSide,
  GreaterDepth,
  Group,
  LessEqualDepth,
  Mesh,
  ShaderMaterial,
  Vector3,
  type DepthModes,
} from "three";

import type { State } from "../feed/messages";
import { floats, indices } from "../feed/numbers";
import { radii } from "./ring-sizes";
import { FACED, Quads } from "./quads";

const MAX_RADIUS = 0.0045; // largest radius [m]
const SKIN_DISTANCE = 0.0012; // distance above the skin [m]
const HIDDEN_OPACITY = 0.3; // opacity behind something else

const VERTEX = `
attribute vec2 corner;
attribute vec3 centre, facing;
attribute float asked, achieved, size;
uniform float most;
varying vec2 at;
varying float ring, fill;
${FACED}
void main() {
  ring = max(sqrt(asked / most), 0.22);
  fill = sqrt(achieved / most);
  at = corner * (max(ring, fill) + 0.25);
  vec3 n = dot(facing, facing) > 0.5 ? facing : normalize(cameraPosition - centre);
  vec3 p = centre + ${SKIN_DISTANCE} * n + size * faced(n, at);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(p, 1.0);
}`;

const FRAGMENT = `
uniform float opacity;
varying vec2 at;
varying float ring, fill;
void main() {
  float r = length(at), soft = fwidth(r);
  float inside = 1.0 - smoothstep(fill - soft, fill + soft, r);
  float width = max(0.07, 1.1 * soft);
  float line = 1.0 - smoothstep(width - soft, width + soft, abs(r - ring));
  float halo = 1.0 - smoothstep(width + 0.08, width + 0.08 + soft, abs(r - ring));
  vec3 c = mix(vec3(1.0, 0.69, 0.28), vec3(1.0), line);
  float a = max(max(inside * 0.95, line), halo * 0.45);
  c = mix(vec3(0.04, 0.05, 0.07), c, max(inside, line));
  if (a < 0.01) discard;
  gl_FragColor = vec4(c, a * opacity);
}`;

export class Samples {
  readonly group = new Group();
  /** Pressure of the largest ring [Pa]. */
  most = 0;
  /** Mean position of the samples [m]. */
  readonly middle = new Vector3();
  /** Box around the samples [m]. */
  readonly box = new Box3();
  private readonly discs = new Quads({ centre: 3, facing: 3, asked: 1, achieved: 1, size: 1 });
  private readonly scale = { value: 1 };
  private readonly point = new Vector3();

  constructor() {
    this.group.add(this.mesh(LessEqualDepth, 1, 9000), this.mesh(GreaterDepth, HIDDEN_OPACITY, 9001));
  }

  get count(): number {
    return this.discs.count;
  }

  show(state: State): void {
    const points = floats(state.points);
    const asked = floats(state.asked);
    const count = Math.min(asked.length, Math.floor(points.length / 3));
    this.discs.resize(count);
    this.discs.write("centre", points);
    this.discs.write("facing", floats(state.normals));
    this.discs.write("asked", asked);
    this.discs.write("achieved", floats(state.achieved));
    this.discs.write("size", radii(points, indices(state.index), MAX_RADIUS));
    this.most = asked.reduce((a, b) => Math.max(a, b), 0);
    this.scale.value = this.most || 1;
    this.middle.set(0, 0, 0);
    this.box.makeEmpty();
    for (let k = 0; k < count; k++) {
      this.middle.add(this.point.fromArray(points, 3 * k));
      this.box.expandByPoint(this.point);
    }
    this.middle.divideScalar(Math.max(count, 1));
  }

  private mesh(depth: DepthModes, opacity: number, turn: number): Mesh {
    const material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      side: DoubleSide,
      transparent: true,
      depthWrite: false,
      depthFunc: depth,
      uniforms: { most: this.scale, opacity: { value: opacity } },
    });
    const mesh = new Mesh(this.discs.geometry, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = turn;
    return mesh;
  }
}
