/** The viewport: its camera, renderer and canvas. It draws a frame only when something has changed. */

import {
  Box3,
  PerspectiveCamera,
  Scene,
  Spherical,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { allPower, drawnBySoftware } from "./software-rendering";

const FOV = 32; // [deg]
const MAX_PIXEL_RATIO = 2; // largest number of device pixels per pixel of the page
const SOFTWARE_FRAME_INTERVAL = 120; // shortest time between frames with software rendering, unless the user acts [ms]
const KEY_ANGLE = Math.PI / 36; // angle of one key press [rad]
const DAMPING = 0.12;
const INITIAL_POLAR_ANGLE = 1.12; // initial angle from above [rad]
const INITIAL_AZIMUTH = -0.62; // initial angle from the front [rad]
const FILLED_SHARE = 0.88; // share of the view that a fitted box fills
const FIT_ITERATIONS = 5; // number of iterations to fit a box
const MAX_OVERHANG = 0.12; // distance by which a box may leave the fitted one before the view follows, over its diagonal
const MIN_AXIS_RATIO = 1.15; // factor by which the view must lie more along another axis before that one faces the user

export class Viewport {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(FOV, 1, 0.02, 30);
  readonly size = new Vector2(1, 1);
  readonly controls: OrbitControls;
  /** Number of frames drawn. */
  frames = 0;
  private readonly renderer: WebGLRenderer;
  private readonly before: (() => void)[] = [];
  private readonly spherical = new Spherical();
  private readonly offset = new Vector3();
  private readonly home = new Box3();
  private readonly flat = new Box3();
  private readonly fitted = new Box3();
  private untouched = true;
  /** Whether frames are drawn seldom, unless the user acts. */
  readonly seldom: boolean;
  private readonly finest: number;
  private readonly always = allPower();
  private last = 0;
  private timer = 0;
  private asked = false;

  /** Throws if there is no WebGL. */
  constructor(readonly element: HTMLElement) {
    const software = drawnBySoftware();
    this.seldom = software && !this.always;
    this.finest = software ? 1 : MAX_PIXEL_RATIO;
    this.renderer = new WebGLRenderer({ alpha: true, antialias: !software });
    this.renderer.setClearColor(0x000000, 0);
    this.canvas.tabIndex = 0;
    element.prepend(this.canvas);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.controls.dampingFactor = DAMPING;
    this.controls.maxDistance = 10;
    this.controls.minDistance = 0.05;
    this.controls.addEventListener("change", () => this.urge());
    this.controls.addEventListener("start", () => {
      this.untouched = false;
    });
    new ResizeObserver(() => this.resize()).observe(element);
    this.resize();
    this.canvas.addEventListener("webglcontextrestored", () => this.urge());
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Whether the graphics card can interpolate float textures. */
  get smooth(): boolean {
    return this.renderer.extensions.has("OES_texture_float_linear");
  }

  /** Size of a pixel of the page at distance 1. */
  get pixel(): number {
    return (2 * Math.tan((FOV * Math.PI) / 360)) / this.size.y;
  }

  /** Request a frame; with software rendering, no sooner than SOFTWARE_FRAME_INTERVAL after the last. */
  change(): void {
    if (this.timer || this.asked) return;
    const wait = this.seldom ? this.last + SOFTWARE_FRAME_INTERVAL - performance.now() : 0;
    if (wait > 0) this.timer = window.setTimeout(() => this.urge(), wait);
    else this.urge();
  }

  /** Request a frame at once, because the user caused the change. */
  urge(): void {
    clearTimeout(this.timer);
    this.timer = 0;
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.frame());
  }

  /** Call `listener` before each frame. */
  onFrame(listener: () => void): void {
    this.before.push(listener);
  }

  /** Set the box around everything [m]. */
  set whole(box: Box3) {
    this.home.copy(box);
  }

  /** Fit everything, seen from the initial direction. */
  all(): void {
    this.look(this.home);
  }

  /** Fit a box [m], seen from the initial direction. */
  look(box: Box3): void {
    this.fitted.copy(box);
    this.fit(box, INITIAL_POLAR_ANGLE, INITIAL_AZIMUTH);
    this.untouched = true;
  }

  /** Keep the box [m] in view. If the user has changed the view, only move it with the box. */
  track(box: Box3): void {
    const room = this.fitted.getSize(this.offset).length() * MAX_OVERHANG;
    if (!this.fitted.isEmpty() && this.fitted.clone().expandByScalar(room).containsBox(box)) return;
    if (this.untouched) {
      this.look(box);
      return;
    }
    const way = box.getCenter(new Vector3()).sub(this.fitted.getCenter(new Vector3()));
    this.fitted.copy(box);
    this.camera.position.add(way);
    this.controls.target.add(way);
    this.urge();
  }

  /** Return the axis along which the camera looks most; `last` unless another is clearly ahead (MIN_AXIS_RATIO). */
  facing(last: "x" | "y" | "z"): "x" | "y" | "z" {
    const way = this.camera.position.clone().sub(this.controls.target);
    const size = { x: Math.abs(way.x), y: Math.abs(way.y), z: Math.abs(way.z) };
    const best = (["x", "y", "z"] as const).reduce((a, b) => (size[b] > size[a] ? b : a));
    return size[best] > MIN_AXIS_RATIO * size[last] ? best : last;
  }

  /** Fit a box into the view, seen from the given direction [rad], or from the present one. */
  fit(box: Box3, polar?: number, azimuth?: number): void {
    this.current();
    const { phi, theta } = this.spherical;
    box.getCenter(this.controls.target);
    let radius = 2 * box.min.distanceTo(box.max);
    for (let round = 0; round < FIT_ITERATIONS; round++) {
      this.turn(polar ?? phi, azimuth ?? theta, radius);
      this.camera.updateMatrixWorld();
      this.flat.makeEmpty();
      for (let corner = 0; corner < 8; corner++) {
        const x = corner & 1 ? box.max.x : box.min.x;
        const y = corner & 2 ? box.max.y : box.min.y;
        const z = corner & 4 ? box.max.z : box.min.z;
        this.flat.expandByPoint(this.offset.set(x, y, z).project(this.camera));
      }
      const { min, max } = this.flat;
      const tall = Math.tan((FOV * Math.PI) / 360) * radius;
      const right = ((min.x + max.x) / 2) * tall * this.camera.aspect;
      const up = ((min.y + max.y) / 2) * tall;
      const { matrixWorld } = this.camera;
      const { target } = this.controls;
      target.addScaledVector(this.offset.setFromMatrixColumn(matrixWorld, 0), right);
      target.addScaledVector(this.offset.setFromMatrixColumn(matrixWorld, 1), up);
      radius *= Math.max(max.x - min.x, max.y - min.y) / 2 / FILLED_SHARE;
    }
    this.turn(polar ?? phi, azimuth ?? theta, radius);
    this.untouched = false;
  }

  /** Look from the front (y), the side (x) or above (z). */
  from(side: "x" | "y" | "z"): void {
    this.fit(this.fitted.isEmpty() ? this.home : this.fitted, side === "z" ? 1e-3 : Math.PI / 2, side === "x" ? Math.PI / 2 : 0);
  }

  /** Turn around the target by steps of KEY_ANGLE, and come nearer by a factor. */
  orbit(right: number, up: number, nearer = 1): void {
    this.current();
    const { phi, theta, radius } = this.spherical;
    this.turn(phi - up * KEY_ANGLE, theta + right * KEY_ANGLE, radius / nearer);
    this.untouched = false;
  }

  /** Return where a point is on the page [px]; z is its depth. */
  project(point: Vector3): Vector3 {
    const { left, top } = this.canvas.getBoundingClientRect();
    const p = point.clone().project(this.camera);
    p.x = left + ((p.x + 1) / 2) * this.size.x;
    p.y = top + ((1 - p.y) / 2) * this.size.y;
    return p;
  }

  private current(): void {
    const { x, y, z } = this.offset.copy(this.camera.position).sub(this.controls.target);
    this.spherical.setFromCartesianCoords(x, z, -y); // because three's spherical coordinates have y up
  }

  private turn(polar: number, azimuth: number, radius: number): void {
    const near = Math.min(Math.max(polar, 1e-3), Math.PI - 1e-3);
    const far = Math.min(
      Math.max(radius, this.controls.minDistance),
      this.controls.maxDistance,
    );
    this.spherical.set(far, near, azimuth);
    const { x, y, z } = this.offset.setFromSpherical(this.spherical);
    this.camera.position.set(x, -z, y).add(this.controls.target);
    this.controls.update();
    this.urge();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.element;
    this.size.set(Math.max(clientWidth, 1), Math.max(clientHeight, 1));
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, this.finest));
    this.renderer.setSize(this.size.x, this.size.y);
    this.camera.aspect = this.size.x / this.size.y;
    this.camera.updateProjectionMatrix();
    if (this.untouched && !this.fitted.isEmpty()) this.look(this.fitted.clone());
    this.draw();
  }

  private frame(): void {
    this.asked = this.always;
    this.controls.update(); // requests the next frame while the view still turns
    this.draw();
    if (this.always) requestAnimationFrame(() => this.frame());
  }

  private draw(): void {
    this.frames += 1;
    this.last = performance.now();
    for (const listener of this.before) listener();
    this.renderer.render(this.scene, this.camera);
  }
}
