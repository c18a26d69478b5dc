/** The mouse over the slice: shows values, and drags the slice along its normal. */

import { Raycaster, Vector2, Vector3 } from "three";

import type { Quantity } from "../feed/messages";
import type { SlicePlane } from "../field/slice-plane";
import { hit, number, value } from "./planes";
import type { Space } from "./space";

const GRIP_DISTANCE = 22; // distance from the arrow within which the mouse grips it [px]
const HEAD_ON_COSINE = 0.97; // cosine of the angle to the normal, above which moving the mouse up and down drags the slice

/** A value of the slice under the mouse. */
export interface HoverValue {
  x: number;
  y: number;
  /** Value of the quantity shown [Pa]; NaN where it is undefined. */
  value: number;
  quantity: Quantity;
  at: Vector3;
}

export class Pointer {
  private readonly caster = new Raycaster();
  private readonly mouse = new Vector2();
  private readonly normal = new Vector3();
  private over: PointerEvent | undefined;
  private drag: { to: (event: PointerEvent) => number; from: number; start: number } | undefined;

  /** tell: receives the value under the mouse; null if there is none. */
  constructor(
    private readonly space: Space,
    private readonly slicePlane: SlicePlane,
    private readonly tell: (told: HoverValue | null) => void,
  ) {
    const { canvas, element } = space.viewport;
    element.addEventListener("pointerdown", (event) => this.down(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", () => this.up());
    canvas.addEventListener("pointercancel", () => this.up());
    canvas.addEventListener("pointerleave", () => this.leave());
  }

  private down(event: PointerEvent): void {
    const { canvas, controls } = this.space.viewport;
    if (event.target !== canvas || event.button !== 0 || event.shiftKey || event.ctrlKey) return;
    canvas.focus({ preventScroll: true });
    this.aim(event);
    if (!this.slicePlane.shown || !this.grips(event)) return;
    controls.enabled = false;
    canvas.setPointerCapture(event.pointerId);
    const headlong = Math.abs(this.slope()) > HEAD_ON_COSINE;
    const to = headlong ? this.upwards.bind(this) : this.along.bind(this);
    this.drag = { to, from: to(event), start: this.slicePlane.position };
    this.over = undefined;
    this.tell(null);
  }

  private move(event: PointerEvent): void {
    this.aim(event);
    const { drag } = this;
    if (drag) {
      this.slicePlane.move(drag.start + drag.to(event) - drag.from, true);
      return;
    }
    if (event.buttons) return;
    const over = this.slicePlane.shown && this.grips(event);
    this.hover(over);
    this.over = event;
    this.look(event);
  }

  /** Report the value again, because the slice has changed under the mouse. */
  tellAgain(): void {
    if (!this.over) return;
    this.aim(this.over);
    this.look(this.over);
  }

  private up(): void {
    if (!this.drag) return;
    this.drag = undefined;
    this.space.viewport.controls.enabled = true;
    this.slicePlane.move(this.slicePlane.position);
  }

  private leave(): void {
    if (this.drag) return;
    this.over = undefined;
    this.tell(null);
    this.hover(false);
  }

  private hover(over: boolean): void {
    const { slice, viewport } = this.space;
    if (over === slice.hovered) return;
    slice.hovered = over;
    viewport.canvas.style.cursor = over ? "grab" : "";
    viewport.urge();
  }

  /** Report the value under the mouse. */
  private look(event: PointerEvent): void {
    const { plane, values } = this.space.slice;
    const found = plane && this.slicePlane.shown ? hit(plane, this.caster.ray) : null;
    if (!plane || !found) {
      this.tell(null);
      return;
    }
    const { quantity } = this.space.slice;
    this.tell({ x: event.clientX, y: event.clientY, value: value(plane, values, found.s, found.t), quantity, at: found.at });
  }

  private grips(event: PointerEvent): boolean {
    const grip = this.space.viewport.project(this.space.slice.gripped);
    if (Math.hypot(grip.x - event.clientX, grip.y - event.clientY) < GRIP_DISTANCE) return true;
    return hit(this.slicePlane.plane, this.caster.ray) !== null;
  }

  private aim(event: PointerEvent): void {
    const { viewport } = this.space;
    const { left, top } = viewport.canvas.getBoundingClientRect();
    this.mouse.set(
      (2 * (event.clientX - left)) / viewport.size.x - 1,
      1 - (2 * (event.clientY - top)) / viewport.size.y,
    );
    this.caster.setFromCamera(this.mouse, viewport.camera);
  }

  /** Return the position along the slice's normal that is nearest to the mouse's ray [m]. */
  private along(): number {
    const { ray } = this.caster;
    const away = this.base().sub(ray.origin);
    const slope = this.slope();
    const further = slope * ray.direction.dot(away) - this.normal.dot(away);
    return this.slicePlane.position + further / Math.max(1 - slope * slope, 1 - HEAD_ON_COSINE ** 2);
  }

  /** Like `along`, for a camera that looks along the normal: moving the mouse up increases the position. */
  private upwards(event: PointerEvent): number {
    const { viewport } = this.space;
    return -event.clientY * viewport.pixel * this.base().distanceTo(viewport.camera.position);
  }

  private base(): Vector3 {
    return new Vector3(...this.slicePlane.plane.centre);
  }

  /** Return the cosine of the angle between the mouse's ray and the normal. */
  private slope(): number {
    this.normal.set(0, 0, 0).setComponent(number(this.slicePlane.axis), 1);
    return this.caster.ray.direction.dot(this.normal);
  }
}
