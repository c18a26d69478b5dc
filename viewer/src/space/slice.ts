/** The slice: the last computed field, drawn at the plane it was computed for, and a frame at the plane requested. */

import {
  ConeGeometry,
  CylinderGeometry,
  DataTexture,
  DoubleSide,
  FloatType,
  Group,
  LinearFilter,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  NearestFilter,
  PlaneGeometry,
  Quaternion,
  RedFormat,
  ShaderMaterial,
  Vector3,
} from "three";

import { DECIBELS, SCALE_LAWS, type ScaleLaw } from "../field/scale-law";
import type { Over, Plane, Quantity, Slice } from "../feed/messages";
import { into } from "../feed/numbers";
import type { Turned } from "./translucent";
import { errorMap, pressureMap } from "./map-textures";
import { matrix } from "./planes";

const ACCENT = "#8fc7ff";
const ERROR_RENDER_ORDER = 7000; // render order of an error slice: over everything but frame, arrow and samples
const ARROW_LENGTH = 52; // length of the arrow [px]

const VERTEX = `
varying vec2 at;
void main() {
  at = uv;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const FIELD = `
uniform sampler2D values, map;
uniform float most, signed, law;
varying vec2 at;
void main() {
  float value = texture2D(values, at).r / most;
  bool known = value >= -1e9;
  if (!known) discard;
  if (signed > 0.5) value = 0.5 + 0.5 * value;
  float share = clamp(value, 0.0, 1.0);
  if (law > 1.5) share = max(1.0 + log(max(share, 1e-30)) * ${(10 / Math.LN10 / DECIBELS).toFixed(6)}, 0.0);
  else if (law > 0.5) share = sqrt(share);
  float opacity = max(0.96 * smoothstep(0.03, 0.35, share), 0.97 * signed);
  if (opacity < 0.004) discard;
  gl_FragColor = vec4(texture2D(map, vec2(share, 0.5)).rgb, opacity);
}`;

const FRAME = `
uniform vec3 colour;
uniform float strong;
varying vec2 at;
void main() {
  vec2 away = min(at, 1.0 - at) / fwidth(at);
  float width = mix(1.2, 2.4, strong);
  float line = 1.0 - smoothstep(width, width + 1.0, min(away.x, away.y));
  if (line < 0.01) discard;
  gl_FragColor = vec4(colour, line * mix(0.55, 1.0, strong));
}`;

export class FieldSlice implements Turned {
  readonly group = new Group();
  readonly middle = new Vector3();
  /** The plane that is shown, and its values [Pa]. */
  plane: Plane | undefined;
  values = new Float32Array(0);
  quantity: Quantity = "pressure";
  average: Over = "mean";
  /** Number of frames combined, and the time at which the newest was emitted [s]. */
  frames = 1;
  time = -Infinity;
  /** Number of slices shown so far. */
  count = 0;
  private readonly field: Mesh<PlaneGeometry, ShaderMaterial>;
  private readonly frame: Mesh<PlaneGeometry, ShaderMaterial>;
  private readonly grip = new Group();
  private readonly placing = new Matrix4();
  private last = 0;

  /** smooth: whether the graphics card can interpolate float textures. */
  constructor(private readonly smooth: boolean) {
    const square = new PlaneGeometry(1, 1);
    this.field = new Mesh(
      square,
      material(FIELD, { values: null, map: pressureMap, most: 1, signed: 0, law: 0 }),
    );
    this.frame = new Mesh(
      square,
      material(FRAME, { colour: new Vector3(0.56, 0.78, 1), strong: 0 }),
    );
    this.frame.renderOrder = 8000;
    const arrow = new MeshBasicMaterial({ color: ACCENT, depthTest: false, transparent: true });
    const shaft = new Mesh(new CylinderGeometry(0.035, 0.035, 0.8), arrow);
    const tips = [0.5, -0.5].map((y) => {
      const tip = new Mesh(new ConeGeometry(0.13, 0.34, 20), arrow);
      tip.position.y = y;
      if (y < 0) tip.rotation.z = Math.PI;
      return tip;
    });
    this.grip.add(shaft, ...tips);
    for (const mesh of [shaft, ...tips]) mesh.renderOrder = 8500;
    this.field.visible = false;
    for (const each of [this.field, this.frame]) each.matrixAutoUpdate = false;
    this.group.add(this.field, this.frame, this.grip);
  }

  set turn(turn: number) {
    this.last = turn;
    this.field.renderOrder = this.quantity === "error" ? ERROR_RENDER_ORDER : 2 * turn;
  }

  /** Pressure, or magnitude of the error, at the end of the colour bar [Pa]. */
  set most(most: number) {
    this.set(this.field, "most", most || 1);
  }

  /** Set how pressure becomes colour. An error is always linear. */
  set law(law: ScaleLaw) {
    this.set(this.field, "law", this.quantity === "error" ? 0 : SCALE_LAWS.indexOf(law));
  }

  get hovered(): boolean {
    return this.frame.material.uniforms["strong"]?.value === 1;
  }

  set hovered(hovered: boolean) {
    this.set(this.frame, "strong", hovered ? 1 : 0);
    for (const each of this.grip.children as Mesh<never, MeshBasicMaterial>[]) {
      each.material.opacity = hovered ? 1 : 0.75;
    }
  }

  /** Position of the arrow by which the slice is dragged. */
  get gripped(): Vector3 {
    return this.grip.position;
  }

  /** Move frame and arrow to the plane requested. */
  want(plane: Plane): void {
    matrix(plane, this.frame.matrix);
    this.frame.matrixWorldNeedsUpdate = true;
    this.grip.position.set(0.5, 0, 0).applyMatrix4(this.frame.matrix);
    const n = new Vector3().setFromMatrixColumn(this.frame.matrix, 2).normalize();
    this.grip.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), n));
  }

  /** Show a computed slice. */
  show(slice: Slice): void {
    const [rows, columns] = slice.shape;
    if (slice.pressure.length !== 4 * rows * columns) return;
    if (this.plane?.shape[0] !== rows || this.plane.shape[1] !== columns || this.quantity !== slice.of) {
      this.quantity = slice.of;
      this.set(this.field, "map", this.quantity === "error" ? errorMap : pressureMap);
      this.set(this.field, "signed", this.quantity === "error" ? 1 : 0);
      this.field.material.depthTest = this.quantity === "pressure"; // hands and objects would hide an error
      this.turn = this.last;
      this.values = new Float32Array(rows * columns);
      this.texture?.dispose();
      this.set(this.field, "values", this.made(rows, columns));
    }
    into(this.values, slice.pressure);
    this.plane = slice;
    this.average = slice.over;
    this.frames = slice.frames;
    this.time = slice.time;
    this.count += 1;
    if (this.texture) this.texture.needsUpdate = true;
    matrix(slice, this.placing);
    this.field.matrix.copy(this.placing);
    this.field.matrixWorldNeedsUpdate = true;
    this.middle.set(...slice.centre);
    this.field.visible = true;
  }

  /** Hide the field, because no computed slice is valid. */
  clear(): void {
    this.field.visible = false;
    this.plane = undefined;
  }

  /** Set the size of the arrow. perPixel: length of one pixel at the arrow [m]. */
  fit(perPixel: number): void {
    this.grip.scale.setScalar(ARROW_LENGTH * perPixel);
  }

  private get texture(): DataTexture | null {
    return this.field.material.uniforms["values"]?.value as DataTexture | null;
  }

  private made(rows: number, columns: number): DataTexture {
    const texture = new DataTexture(this.values, columns, rows, RedFormat, FloatType);
    const smooth = this.smooth && this.quantity === "pressure"; // interpolation would spread the NaN beside an error
    texture.minFilter = texture.magFilter = smooth ? LinearFilter : NearestFilter;
    return texture;
  }

  private set(mesh: Mesh<PlaneGeometry, ShaderMaterial>, name: string, value: unknown): void {
    const uniform = mesh.material.uniforms[name];
    if (uniform) uniform.value = value;
  }
}

function material(fragmentShader: string, values: Record<string, unknown>): ShaderMaterial {
  const uniforms = Object.fromEntries(Object.entries(values).map(([k, value]) => [k, { value }]));
  const given = { vertexShader: VERTEX, fragmentShader, uniforms };
  return new ShaderMaterial({ ...given, side: DoubleSide, transparent: true, depthWrite: false });
}
