/** The array: a disc for each transducer, coloured by phase and filled by amplitude. */

import { Mesh, ShaderMaterial } from "three";

import type { Arrayed, Frame } from "../feed/messages";
import { floats, into } from "../feed/numbers";
import { FACED, Quads } from "./quads";
import { phaseMap } from "./map-textures";

const RADIUS_SHARE = 0.46; // radius of a disc over the distance to its neighbour
const LONE_RADIUS = 0.005; // radius of a single disc [m]
const MAX_COMPARED = 64; // number of transducers that are compared with all others to find the smallest distance

// The colour is looked up per corner, not per pixel, which is noticeably faster in software rendering.
const VERTEX = `
attribute vec2 corner;
attribute vec3 centre, facing;
attribute float phase, amplitude;
uniform float radius;
uniform sampler2D map;
varying vec2 at;
varying vec4 fill;
${FACED}
void main() {
  at = corner * 1.12;
  fill.rgb = texture2D(map, vec2(phase, 0.5)).rgb * mix(0.72, 1.0, amplitude);
  fill.a = amplitude > 0.0 ? mix(0.3, 0.92, sqrt(amplitude)) : -1.0;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(centre + radius * faced(facing, at), 1.0);
}`;

const FRAGMENT = `
varying vec2 at;
varying vec4 fill;
void main() {
  float r = length(at);
  if (r > 1.12) discard;
  float soft = fwidth(r);
  float ring = clamp((r - 0.86) / soft + 0.5, 0.0, 1.0);
  float inside = clamp((fill.a - r) / soft + 0.5, 0.0, 1.0);
  vec3 body = mix(vec3(0.125, 0.15, 0.185), vec3(0.25, 0.29, 0.345), ring);
  gl_FragColor = vec4(mix(body, fill.rgb, inside), clamp((1.0 - r) / soft + 0.5, 0.0, 1.0));
}`;

export class Transducers {
  readonly mesh: Mesh;
  /** Mean and maximum of the amplitudes, 0..1. */
  drive = { mean: 0, most: 0 };
  private readonly discs = new Quads({ centre: 3, facing: 3, phase: 1, amplitude: 1 });
  private readonly radius = { value: LONE_RADIUS };
  /** Amplitude of each level, 0..1; empty if they are evenly spaced. */
  private sizes: ArrayLike<number> = [];
  private levels = new Uint16Array(0);

  constructor() {
    const material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      uniforms: { map: { value: phaseMap }, radius: this.radius },
    });
    this.mesh = new Mesh(this.discs.geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = -10;
  }

  get count(): number {
    return this.discs.count;
  }

  /** Show an array, silent. */
  place({ positions, normals, sound }: Arrayed): void {
    const centres = floats(positions);
    this.sizes = sound ? floats(sound.sizes) : [];
    this.discs.resize(Math.floor(centres.length / 3));
    this.discs.write("centre", centres);
    this.discs.write("facing", floats(normals));
    this.levels = new Uint16Array(this.count);
    this.radius.value = radius(centres);
    this.emit(new Float32Array(this.count));
  }

  /** Show the levels of a frame; silence if the frame has none, or not one for each transducer. */
  show({ phase, amplitude, phases, amplitudes }: Frame): void {
    if (amplitude.length !== this.levels.byteLength || phase.length !== amplitude.length) {
      this.emit(new Float32Array(this.count));
      return;
    }
    into(this.levels, phase);
    this.discs.write("phase", Float32Array.from(this.levels, (level) => level / Math.max(phases, 1)));
    into(this.levels, amplitude);
    const known = this.sizes.length === amplitudes;
    const most = Math.max(amplitudes - 1, 1);
    const size = (level: number): number => (known ? (this.sizes[level] ?? 0) : level / most);
    this.emit(Float32Array.from(this.levels, size));
  }

  private emit(amplitudes: Float32Array): void {
    this.discs.write("amplitude", amplitudes);
    const most = amplitudes.reduce((a, b) => Math.max(a, b), 0);
    const mean = amplitudes.reduce((a, b) => a + b, 0) / Math.max(this.count, 1);
    this.drive = { mean, most };
  }
}

/** Return a radius with which neighbouring discs do not touch [m]. */
function radius(centres: Float32Array): number {
  const count = centres.length / 3;
  const apart = (i: number, j: number, axis: number): number =>
    (centres[3 * i + axis] ?? 0) - (centres[3 * j + axis] ?? 0);
  let least = Infinity;
  for (let i = 0; i < Math.min(count, MAX_COMPARED); i++) {
    for (let j = 0; j < count; j++) {
      const away = Math.hypot(apart(i, j, 0), apart(i, j, 1), apart(i, j, 2));
      if (away > 1e-6 && away < least) least = away;
    }
  }
  return Number.isFinite(least) ? RADIUS_SHARE * least : LONE_RADIUS;
}
