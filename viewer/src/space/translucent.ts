/**
 * Things that can be seen through: hands, objects, surfaces of equal pressure.
 *
 * Of each only the surface next to the eye is drawn: first its depth, then its colour. What is farther away is drawn
 * first, so that it shines through.
 */

import {
  BackSide,
  Color,
  DoubleSide,
  FrontSide,
  Group,
  Mesh,
  ShaderMaterial,
  Vector3,
  type BufferGeometry,
  type Camera,
  type IUniform,
  type Texture,
} from "three";

export const SHADED = `
invariant gl_Position; // the same for depth and for colour
varying vec3 facing, seen;
`;

const VERTEX = `
${SHADED}
varying vec3 at;
void main() {
  vec4 p = modelViewMatrix * vec4(position, 1.0);
  at = position;
  facing = normalMatrix * normal;
  seen = -p.xyz;
  gl_Position = projectionMatrix * p;
}`;

const FRAGMENT = `
varying vec3 facing, seen;
uniform vec3 colour;
uniform float body;
#ifdef TEXTURED
varying vec3 at;
uniform sampler2D map;
uniform vec2 extent;
#endif
#ifdef PAINTED
varying vec4 spot; // across the painted square, before it, and how far the skin faces it
uniform sampler2D paint, colours;
uniform float top, deep;
#endif
void main() {
  vec3 n = normalize(facing);
  float towards = abs(dot(n, normalize(seen)));
  float light = 0.62 + 0.38 * abs(dot(n, normalize(vec3(0.35, 0.8, 0.6))));
  float rim = pow(1.0 - towards, 2.5);
  vec3 c = colour * (light + 0.45 * rim) + 0.06 * rim;
  float a = mix(body, min(body + 0.55, 1.0), rim);
#ifdef TEXTURED
  float felt = texture2D(map, at.xy / extent + 0.5).r;
  c *= mix(0.45, 1.15, felt);
  a *= mix(0.6, 1.2, felt);
#endif
#ifdef PAINTED
  if (top > 0.0 && abs(spot.x) < 0.5 && abs(spot.y) < 0.5 && abs(spot.z) < deep && spot.w > 0.2) {
    float felt = texture2D(paint, spot.xy + 0.5).r;
    if (felt >= 0.0) {
      c = mix(c, texture2D(colours, vec2(clamp(felt / top, 0.0, 1.0), 0.5)).rgb, 0.9);
      a = max(a, 0.95);
    }
  }
#endif
  gl_FragColor = vec4(c, a);
}`;

// A painting on the side that is turned away shines through, or a palm over the array would hide it.
const BEHIND = `
varying vec4 spot;
uniform sampler2D paint, colours;
uniform float top, deep;
void main() {
  if (top <= 0.0 || abs(spot.x) >= 0.5 || abs(spot.y) >= 0.5 || abs(spot.z) >= deep || spot.w <= 0.2) discard;
  float share = texture2D(paint, spot.xy + 0.5).r / top;
  if (!(share >= 0.02)) discard;
  gl_FragColor = vec4(texture2D(colours, vec2(min(share, 1.0), 0.5)).rgb, 0.8 * smoothstep(0.02, 0.3, share));
}`;

export interface Look {
  colour: string;
  /** Opacity where it is looked at straight. */
  body: number;
  /** Seen from both sides: not closed. */
  open?: boolean;
  /** A factor on pressure over x and y, and how wide and high it is [m]. */
  texture?: { map: Texture; size: [number, number] };
  /** Whether it takes a painting: `paint`, `colours`, `top` and `deep` of its uniforms, at `spot` of its vertices. */
  painted?: boolean;
  /** Instead of a plain one. */
  vertex?: string;
  /** Of that. */
  uniforms?: Record<string, IUniform>;
}

/** One thing: the mesh of its depth, the mesh of its colour, and that of a painting behind it. */
export class Translucent extends Group {
  constructor(geometry: BufferGeometry, look: Look) {
    super();
    const { colour, body, texture } = look;
    const side = look.open ? DoubleSide : FrontSide;
    const vertexShader = look.vertex ?? VERTEX;
    const depth = new ShaderMaterial({
      vertexShader,
      fragmentShader: "void main() {}",
      uniforms: { ...look.uniforms },
      side,
      colorWrite: false,
      transparent: true, // so that it is drawn in its turn
    });
    const shown = new ShaderMaterial({
      vertexShader,
      fragmentShader: FRAGMENT,
      side,
      transparent: true,
      depthWrite: false,
      defines: { ...(texture && { TEXTURED: "" }), ...(look.painted && { PAINTED: "" }) },
      uniforms: {
        ...look.uniforms,
        colour: { value: plain(colour) },
        body: { value: body },
        map: { value: texture?.map ?? null },
        extent: { value: texture?.size ?? [1, 1] },
      },
    });
    this.add(new Mesh(geometry, depth), new Mesh(geometry, shown));
    if (look.painted) {
      const behind = new ShaderMaterial({
        vertexShader,
        fragmentShader: BEHIND,
        side: BackSide,
        transparent: true,
        depthTest: false,
        depthWrite: false,
        uniforms: { ...look.uniforms },
      });
      this.add(new Mesh(geometry, behind));
    }
    for (const mesh of this.meshes) mesh.frustumCulled = false;
  }

  get meshes(): Mesh<BufferGeometry, ShaderMaterial>[] {
    return this.children as Mesh<BufferGeometry, ShaderMaterial>[];
  }

  /** Whether a painting behind it shines through. */
  set through(on: boolean) {
    const behind = this.meshes[2];
    if (behind) behind.visible = on;
  }

  /** Another geometry. */
  set geometry(geometry: BufferGeometry) {
    for (const mesh of this.meshes) mesh.geometry = geometry;
  }

  set colour(colour: string) {
    const uniform = this.meshes[1]?.material.uniforms["colour"];
    if (uniform) (uniform.value as Color).copy(plain(colour));
  }

  /** Its turn among others. */
  set turn(turn: number) {
    for (const [k, mesh] of this.meshes.entries()) mesh.renderOrder = 2 * turn + Math.min(k, 1);
  }
}

/** What is drawn in turns, the farthest first. */
export interface Turned {
  /** Where it is, for its turn. */
  readonly middle: Vector3;
  turn: number;
}

/** Gives all things their turns, as they are seen by a camera. */
export function takeTurns(things: Turned[], camera: Camera): void {
  things.sort((a, b) => apart(b, camera) - apart(a, camera));
  for (let turn = 0; turn < things.length; turn++) {
    const thing = things[turn];
    if (thing) thing.turn = turn;
  }
}

function apart(thing: Turned, camera: Camera): number {
  return thing.middle.distanceToSquared(camera.position);
}

/** A colour as it is written: our shaders convert nothing. */
function plain(colour: string): Color {
  return new Color().setStyle(colour, "srgb-linear");
}
