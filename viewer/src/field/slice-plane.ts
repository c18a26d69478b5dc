/** Which slice of the field is wanted: told to the server when it changes, at most once a frame. */

import type { Over, Plane, Quantity, ToServer, Triple } from "../feed/messages";
import { across, number, type Axis } from "../space/planes";
import { nextId } from "./request-ids";

const COARSE = 2; // while it is dragged
const FARTHEST = 10; // [m]
const NEAR = 0.002; // [m] that the contact may move before the slice does

export class SlicePlane {
  axis: Axis = "y";
  of: Quantity = "pressure";
  over: Over = "mean";
  on = true;
  /** Whether it stays at the contact. */
  follows = true;
  /** Whether it turns to the axis that faces the viewer. */
  faces = true;
  private readonly centre: Triple = [0, 0, 0.2];
  private side = 0.2; // [m]
  private cells = 128;
  private moving = false;
  private due = false;
  private readonly listeners: (() => void)[] = [];

  constructor(private readonly send: (message: ToServer) => void) {}

  /** What is wanted. */
  get plane(): Plane {
    const cells = this.moving ? Math.max(Math.round(this.cells / COARSE), 2) : this.cells;
    return across(this.axis, [...this.centre], this.side, cells);
  }

  /** Where it is along its axis [m]. */
  get position(): number {
    return this.centre[number(this.axis)];
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** The contact is here [m], and this axis faces the viewer. */
  attend(centre: Triple, axis: Axis): void {
    const away = Math.hypot(...centre.map((x, n) => x - (this.centre[n] ?? 0)));
    const goes = this.follows && !this.moving && away > NEAR;
    const turns = this.faces && !this.moving && axis !== this.axis;
    if (goes) this.centre.splice(0, 3, ...centre);
    if (turns) this.axis = axis;
    if (goes || turns) this.change();
  }

  /** Whether to stay at the contact from now on. */
  follow(on: boolean, centre: Triple): void {
    this.follows = on;
    if (on) this.centre.splice(0, 3, ...centre);
    this.change();
  }

  /** Along its normal to a position [m]; moving: it goes on. It stays there. */
  move(position: number, moving = false): void {
    this.follows = false;
    this.centre[number(this.axis)] = Math.min(Math.max(position, -FARTHEST), FARTHEST);
    this.moving = moving;
    this.change();
  }

  /** Across another axis; without one, across the one that faces the viewer. */
  turn(axis?: Axis): void {
    this.faces = !axis;
    this.axis = axis ?? this.axis;
    this.change();
  }

  /** Mean, peak or instant. */
  take(over: Over): void {
    this.over = over;
    this.change();
  }

  /** Its side [m] and how many values there are along it. */
  resize(side: number, cells: number): void {
    this.side = side;
    this.cells = cells;
    this.change();
  }

  /** Pressure, or its error. */
  choose(of: Quantity): void {
    this.of = of;
    this.change();
  }

  show(on: boolean): void {
    this.on = on;
    this.change();
  }

  /** Ask for it; again after each new connection. */
  ask(): void {
    this.due = false;
    if (!this.on) {
      this.send({ type: "hide", what: "slice" });
      return;
    }
    this.send({ type: "slice", id: nextId(), of: this.of, over: this.over, ...this.plane });
  }

  private change(): void {
    for (const listener of this.listeners) listener();
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => this.ask());
  }
}
