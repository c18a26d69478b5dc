/**
 * Translucent things: hands, objects, isosurfaces.
 *
 * Only the surface nearest to the eye is drawn of each thing: first its depth, then its colour. Things farther away are
 * drawn first, so that they shine through.
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
varying vec4 spot; // position in the painted square, and cosine between its normal and the skin's
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

// Painted pressure on the far side shines through, because a palm over the array would hide it.
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
  /** Opacity where the surface faces the eye. */
  body: number;
  /** Whether the surface is open, and so visible from both sides. */
  open?: boolean;
  /** A factor on pressure over x and y, with its width and height [m]. */
  texture?: { map: Texture; size: [number, number] };
  /** Whether pressure is painted on it, by uniforms `paint`, `colours`, `top`, `deep`, and `spot` of its vertices. */
  painted?: boolean;
  /** Vertex shader; a plain one by default. */
  vertex?: string;
  /** Uniforms of the vertex shader. */
  uniforms?: Record<string, IUniform>;
}

/** One thing: a mesh for its depth, one for its colour, and one for pressure painted on its far side. */
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
      transparent: true, // so that three sorts it with the other translucent meshes
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

  /** Whether pressure painted on the far side shines through. */
  set through(on: boolean) {
    const behind = this.meshes[2];
    if (behind) behind.visible = on;
  }

  set geometry(geometry: BufferGeometry) {
    for (const mesh of this.meshes) mesh.geometry = geometry;
  }

  set colour(colour: string) {
    const uniform = this.meshes[1]?.material.uniforms["colour"];
    if (uniform) (uniform.value as Color).copy(plain(colour));
  }

  /** Position in the drawing order. */
  set turn(turn: number) {
    for (const [k, mesh] of this.meshes.entries()) mesh.renderOrder = 2 * turn + Math.min(k, 1);
  }
}

/** A thing in the drawing order, in which the farthest is first. */
export interface Turned {
  /** The position whose distance from the camera decides. */
  readonly middle: Vector3;
  turn: number;
}

/** Set the drawing order of all things, by their distance from a camera. */
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

/** Return a colour without conversion, because our shaders convert nothing. */
function plain(colour: string): Color {
  return new Color().setStyle(colour, "srgb-linear");
}
