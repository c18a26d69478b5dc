/** Which slice of the field is wanted: told to the server when it changes, at most once a frame. */

import type { Plane, Quantity, ToServer, Triple } from "../feed/messages";
import { across, number, type Axis } from "../space/planes";
import { nextId } from "./ids";

const COARSE = 2; // while it is dragged
const FARTHEST = 10; // [m]

export class Slicer {
  axis: Axis = "y";
  of: Quantity = "pressure";
  on = true;
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

  /** Along its normal to a position [m]; moving: it goes on. */
  move(position: number, moving = false): void {
    this.centre[number(this.axis)] = Math.min(Math.max(position, -FARTHEST), FARTHEST);
    this.moving = moving;
    this.change();
  }

  /** To another middle [m]. */
  centreOn(centre: Triple): void {
    this.centre.splice(0, 3, ...centre);
    this.change();
  }

  /** Across another axis. */
  turn(axis: Axis): void {
    this.axis = axis;
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
    this.send({ type: "slice", id: nextId(), of: this.of, ...this.plane });
  }

  private change(): void {
    for (const listener of this.listeners) listener();
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => this.ask());
  }
}
