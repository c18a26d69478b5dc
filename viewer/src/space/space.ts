/** Everything in the 3-D view, kept up to date with the newest messages. */

import { Box3, Vector3 } from "three";

import { css } from "../colours/maps";
import type { SurfaceBox } from "../field/surface-box";
import type { ScaleLaw } from "../field/scale-law";
import { round, type AutoScale } from "../field/auto-scale";
import type { SlicePlane } from "../field/slice-plane";
import type { Arrayed, Frame, Plane, Quantity, Slice, State, Triple, Volume } from "../feed/messages";
import { floats, same } from "../feed/numbers";
import type { Store } from "../feed/store";
import { Axes, type Extent } from "./axes";
import { takeTurns, type Turned } from "./translucent";
import { Hands } from "./hands";
import { Isosurface } from "./isosurface";
import type { Kept } from "./labels";
import { PRESSURES } from "./map-textures";
import { Objects } from "./objects";
import { peak } from "./planes";
import { Samples } from "./samples";
import { FieldSlice } from "./slice";
import { Transducers } from "./transducers";
import { Viewport } from "./viewport";

const VISIBLE_DEPTH = 0.3; // depth of the visible space before the array [m]
const INITIAL_FOCUS_HEIGHT = 0.2; // distance of the middle from the array while there are no samples [m]
const ARRAY_MARGIN = 0.02; // margin around the array [m]
const MAX_SCALE_RATIO = 2; // largest top of a colour scale over the largest target; waves are stronger beyond a region
const OBJECT_MARGIN = 0.03; // margin around hands and objects [m]
const MIN_BOX_SIDE = 0.16; // smallest side of the box in view [m]
const MAX_OBJECT_DISTANCE = 0.15; // distance from hand or contact within which an object is kept in view, too [m]
const LOOK_INTERVAL = 250; // shortest time between two moves of camera and slice [ms]
const MAX_SLICE_AGE = 3000; // time after which a slice that is out of date is hidden [ms]

export class Space {
  readonly viewport: Viewport;
  readonly transducers = new Transducers();
  readonly hands = new Hands();
  readonly objects = new Objects();
  readonly samples = new Samples();
  readonly axes = new Axes();
  readonly surface = new Isosurface();
  readonly slice: FieldSlice;
  /** Whether the camera follows hands and objects. */
  follows = true;
  law: ScaleLaw = "linear";
  extent: Extent = { low: [-0.1, -0.1, 0], high: [0.1, 0.1, VISIBLE_DEPTH] };
  private readonly focus = new Vector3(0, 0, INITIAL_FOCUS_HEIGHT);
  private met = false;
  private nextLook = 0;
  /** The largest target of the last state that had samples [Pa]. */
  private asked = 0;
  /** Time from which the slice has been out of date [ms]. */
  private old: number | undefined;
  /** Whether the objects shown are those of a server that is gone. */
  private left = false;
  private readonly things: Turned[] = [];
  private readonly scaled: (() => void)[] = [];
  /** The frame and state that are drawn, so that equal ones are not drawn again. */
  private frame: Frame | undefined;
  private state: State | undefined;
  /** The largest magnitude in the slice shown [Pa]. */
  private most = 0;

  constructor(
    element: HTMLElement,
    store: Store,
    private readonly slicePlane: SlicePlane,
    private readonly surfaceBox: SurfaceBox,
    private readonly scales: Record<Quantity, AutoScale>,
  ) {
    this.viewport = new Viewport(element);
    this.slice = new FieldSlice(this.viewport.smooth);
    this.viewport.scene.add(
      this.axes,
      this.transducers.mesh,
      this.objects.group,
      this.hands.group,
      this.slice.group,
      this.surface.glass,
      this.samples.group,
    );
    this.viewport.onFrame(() => this.beforeFrame());
    this.slicePlane.onChange(() => this.wanted());
    this.wanted();
    this.surface.glass.visible = false;
    store.on("array", (array) => this.changed(() => this.place(array)));
    store.on("frame", (frame) => this.emit(frame));
    store.on("state", (state) => this.show(state));
    store.on("scenery", (scenery) => {
      if (store.link === "live") this.changed(() => this.objects.show(scenery));
      else this.left = true;
    });
    store.on("slice", (slice) => this.changed(() => this.cut(slice)));
    store.on("volume", (volume) => this.changed(() => this.fill(volume)));
  }

  /** The mean position of the samples; without samples, a point before the array [m]. */
  get middle(): Triple {
    const { x, y, z } = this.samples.count ? this.samples.middle : this.focus;
    return [x, y, z];
  }

  /** Fit hands, contacts and nearby objects into the view; if there are none, fit everything. */
  fit(): void {
    const box = this.content();
    if (box) this.viewport.look(box);
    else this.viewport.all();
  }

  /** Set whether the camera follows hands and objects. */
  follow(on: boolean): void {
    this.follows = on;
    if (on) this.fit();
  }

  /** Return the box around hands, contacts and nearby objects; null if there are none. */
  private content(): Box3 | null {
    const box = new Box3().union(this.hands.box).union(this.samples.box);
    const known = !box.isEmpty();
    const near = known ? box.clone().expandByScalar(MAX_OBJECT_DISTANCE) : this.axes.box;
    for (const { middle, reach } of this.objects.all.values()) {
      const size = Math.min(reach, MAX_OBJECT_DISTANCE);
      if (near.containsPoint(middle)) box.union(new Box3(middle.clone(), middle.clone()).expandByScalar(size));
    }
    if (box.isEmpty()) return null;
    box.expandByScalar(OBJECT_MARGIN);
    const small = new Vector3().setScalar(MIN_BOX_SIDE).sub(box.getSize(new Vector3())).max(new Vector3());
    return box.expandByVector(small.multiplyScalar(0.5));
  }

  /** Let camera and slice follow hand and object, a few times a second. */
  private attend(): void {
    const now = performance.now();
    if (now < this.nextLook) return;
    this.nextLook = now + LOOK_INTERVAL;
    const box = this.content();
    if (box && !this.met) this.viewport.look(box);
    else if (box && this.follows) this.viewport.track(box);
    this.met ||= Boolean(box);
    if (this.samples.count) this.slicePlane.attend(this.middle, this.viewport.facing(this.slicePlane.axis));
    else this.slicePlane.attend(this.slicePlane.plane.centre, this.viewport.facing(this.slicePlane.axis));
    this.age(now);
  }

  /**
   * Hide a slice that has been out of date for a while: because another plane is requested, or because the sound has
   * ended.
   */
  private age(now: number): void {
    const { plane } = this.slice;
    const { centre, u, v } = this.slicePlane.plane;
    const other = plane && ![...centre, ...u, ...v].every((x, k) => near(x, [...plane.centre, ...plane.u, ...plane.v][k]));
    const ended = plane && this.state?.output !== "sounding";
    this.old = other || ended ? (this.old ?? now) : undefined;
    if (this.old === undefined || now < this.old + MAX_SLICE_AGE) return;
    this.slice.clear();
    this.viewport.urge();
  }

  /** The colour scale of the slice shown. */
  get scale(): AutoScale {
    return this.scales[this.slice.quantity];
  }

  /** Level of the isosurface [Pa]. */
  get level(): number {
    return this.surfaceBox.share * this.scales.pressure.most;
  }

  /** Compute the isosurface for the present level, or remove it if it is switched off. */
  recut(): void {
    if (this.surfaceBox.shown) this.surface.cut(this.level, css(PRESSURES, 0.4 + 0.6 * this.surfaceBox.share));
    else this.surface.clear();
    this.viewport.urge();
  }

  /** Call `listener` when a colour scale has changed. */
  onScale(listener: () => void): void {
    this.scaled.push(listener);
  }

  /** Apply a changed colour scale. */
  rescale(): void {
    this.slice.most = this.scale.most;
    this.slice.law = this.law;
    this.recut();
    for (const listener of this.scaled) listener();
  }

  /** Paint the achieved pressure on the hands. Return the top of its scale [Pa], at least the largest target. */
  paint(plane: Plane, felt: Float32Array<ArrayBuffer>, asked: Float32Array): number {
    const most = (values: Float32Array): number => values.reduce((a, b) => (b > a ? b : a), 0);
    const wanted = most(asked);
    const bright = Math.min(most(felt), MAX_SCALE_RATIO * wanted);
    const top = round(bright > wanted ? bright : wanted);
    this.hands.paint(plane, felt, top);
    this.layer();
    this.viewport.change();
    return top;
  }

  /** Remove the painting from the hands. */
  unpaint(): void {
    this.hands.unpaint();
    this.layer();
    this.viewport.change();
  }

  /** Show the samples, unless an error slice or the painted hands show the same. */
  private layer(): void {
    const error = this.slicePlane.shown && this.slice.plane && this.slice.quantity === "error";
    this.samples.group.visible = !error && !this.hands.painted;
    this.hands.through = !error;
  }

  private changed(change: () => void): void {
    change();
    this.viewport.change();
  }

  private place(array: Arrayed): void {
    if (this.left) this.objects.clear();
    this.left = false;
    const centres = floats(array.positions);
    const low: Triple = [Infinity, Infinity, Infinity];
    const high: Triple = [-Infinity, -Infinity, -Infinity];
    for (let k = 0; k < centres.length; k++) {
      const x = centres[k] ?? 0;
      low[k % 3] = Math.min(low[k % 3] ?? x, x);
      high[k % 3] = Math.max(high[k % 3] ?? x, x);
    }
    if (!centres.length) return;
    const before = this.extent;
    this.transducers.place(array);
    this.frame = undefined;
    this.extent = {
      low: [low[0] - ARRAY_MARGIN, low[1] - ARRAY_MARGIN, low[2]],
      high: [high[0] + ARRAY_MARGIN, high[1] + ARRAY_MARGIN, high[2] + VISIBLE_DEPTH],
    };
    this.axes.place(this.extent);
    const centre = low.map((x, n) => (x + (high[n] ?? x)) / 2);
    this.focus.set(centre[0] ?? 0, centre[1] ?? 0, high[2] + INITIAL_FOCUS_HEIGHT);
    if (alike(before, this.extent)) return; // the same array: the server is back
    this.viewport.whole = this.axes.box;
    if (!this.met) this.viewport.all();
    if (this.slicePlane.follows) this.slicePlane.follow(true, this.middle);
  }

  private emit(frame: Frame): void {
    const before = this.frame;
    this.frame = frame;
    if (before && same(before, frame, "phase", "amplitude")) return;
    this.changed(() => this.transducers.show(frame));
  }

  private show(state: State): void {
    const before = this.state;
    this.state = state;
    this.look(); // here too, because no slices come while the field does not change
    this.attend();
    if (before && same(before, state, "points", "normals", "asked", "achieved", "hands")) return;
    this.viewport.change();
    this.samples.show(state);
    this.hands.show(state.hands);
    this.layer();
    if (!this.samples.count) return;
    this.surfaceBox.follow(this.middle);
  }

  private cut(slice: Slice): void {
    if (!this.slicePlane.shown) return;
    this.slice.show(slice);
    this.most = peak(slice, this.slice.values).most;
    this.slice.most = this.scale.most;
    this.slice.law = this.law;
    this.old = undefined;
    this.layer(); // an error slice replaces the samples
    this.look();
  }

  /** Let the scale follow the slice shown. */
  private look(): void {
    this.asked = this.samples.most || this.asked;
    const asked = this.slice.quantity === "pressure" ? this.asked : 0;
    const most = asked > 0 ? Math.min(this.most, MAX_SCALE_RATIO * asked) : this.most;
    if (this.slicePlane.shown && this.scale.see(most)) this.rescale();
  }

  private fill(volume: Volume): void {
    if (!this.surfaceBox.shown) return;
    this.surface.show(volume);
    this.recut();
  }

  private wanted(): void {
    this.slice.group.visible = this.slicePlane.shown;
    if (!this.slicePlane.shown) {
      this.slice.clear();
      this.layer();
    }
    this.slice.want(this.slicePlane.plane);
    this.viewport.urge();
  }

  private beforeFrame(): void {
    this.things.length = 0;
    this.things.push(...this.hands.shown, this.slice, this.surface, ...this.objects.all.values());
    takeTurns(this.things, this.viewport.camera);
    const pixel = this.viewport.pixel;
    for (const label of this.axes.labels) label.fit(pixel);
    for (const { label } of this.objects.all.values()) label.fit(pixel);
    const project = (point: Vector3): Vector3 => this.viewport.project(point);
    const kept: Kept[] = [];
    this.objects.separate(project, kept);
    this.axes.separate(project, this.viewport.camera.position, this.hands, kept);
    this.slice.fit(pixel * this.viewport.camera.position.distanceTo(this.slice.gripped));
  }
}

function near(a: number, b: number | undefined): boolean {
  return b !== undefined && Math.abs(a - b) < 0.005;
}

function alike(a: Extent, b: Extent): boolean {
  return [0, 1, 2].every((n) => a.low[n] === b.low[n] && a.high[n] === b.high[n]);
}
