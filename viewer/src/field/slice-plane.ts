/** The slice that the user wants. Each change is sent to the server, at most once a frame. */

import type { Over, Plane, Quantity, ToViewer, Triple } from "../feed/messages";
import { across, number, type Axis } from "../space/planes";
import { nextId } from "./request-ids";

const INITIAL_CELLS = 128; // values along each side
const DRAG_DIVISOR = 2; // divisor of the resolution during a drag
const MAX_COORDINATE = 10; // largest coordinate of the wire [m]
const MIN_CONTACT_MOVE = 0.002; // distance by which the contact may move before the slice does [m]

export class SlicePlane {
  axis: Axis = "y";
  quantity: Quantity = "pressure";
  average: Over = "mean";
  shown = true;
  /** Whether the slice follows the contact. */
  follows = true;
  /** Whether the slice turns to the axis that faces the user. */
  faces = true;
  private readonly centre: Triple = [0, 0, 0.2];
  private side = 0.2; // [m]
  private cells = INITIAL_CELLS;
  private moving = false;
  private due = false;
  private readonly listeners: (() => void)[] = [];

  constructor(private readonly send: (message: ToViewer) => void) {}

  get plane(): Plane {
    const cells = this.moving ? Math.max(Math.round(this.cells / DRAG_DIVISOR), 2) : this.cells;
    return across(this.axis, [...this.centre], this.side, cells);
  }

  /** Position along the axis [m]. */
  get position(): number {
    return this.centre[number(this.axis)];
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Follow a contact at `centre` [m], and turn to the `axis` that faces the user, where these are switched on. */
  attend(centre: Triple, axis: Axis): void {
    const away = Math.hypot(...centre.map((x, n) => x - (this.centre[n] ?? 0)));
    const goes = this.follows && !this.moving && away > MIN_CONTACT_MOVE;
    const turns = this.faces && !this.moving && axis !== this.axis;
    if (goes) this.centre.splice(0, 3, ...centre);
    if (turns) this.axis = axis;
    if (goes || turns) this.change();
  }

  /** Start or stop following the contact, which is at `centre` [m]. */
  follow(on: boolean, centre: Triple): void {
    this.follows = on;
    if (on) this.centre.splice(0, 3, ...centre);
    this.change();
  }

  /** Move the slice to a position along its normal [m], and stop following. moving: whether the drag goes on. */
  move(position: number, moving = false): void {
    this.follows = false;
    this.centre[number(this.axis)] = Math.min(Math.max(position, -MAX_COORDINATE), MAX_COORDINATE);
    this.moving = moving;
    this.change();
  }

  /** Turn the slice across `axis`; without one, let it follow the axis that faces the user. */
  turn(axis?: Axis): void {
    this.faces = !axis;
    this.axis = axis ?? this.axis;
    this.change();
  }

  /** Choose how the values of several frames become the shown one. */
  chooseAverage(average: Over): void {
    this.average = average;
    this.change();
  }

  /** Set the side [m] and the number of values along it. */
  resize(side: number, cells: number): void {
    this.side = side;
    this.cells = cells;
    this.change();
  }

  choose(quantity: Quantity): void {
    this.quantity = quantity;
    this.change();
  }

  show(shown: boolean): void {
    this.shown = shown;
    this.change();
  }

  /** Request the slice. Call it again after each new connection. */
  ask(): void {
    this.due = false;
    if (!this.shown) {
      this.send({ type: "hide", what: "slice" });
      return;
    }
    this.send({ type: "slice", id: nextId(), of: this.quantity, over: this.average, ...this.plane });
  }

  private change(): void {
    for (const listener of this.listeners) listener();
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => this.ask());
  }
}
