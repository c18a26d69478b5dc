/** The box in which the isosurface is computed. */

import type { Over, ToViewer, Triple } from "../feed/messages";
import { nextId } from "./request-ids";

const MIN_CONTACT_MOVE = 0.02; // distance by which the contact may move before the box does [m]

export class SurfaceBox {
  shown = false;
  /** Level of the surface, as a share of the top of the colour scale. */
  share = 0.3;
  average: Over = "mean";
  private side = 0.1; // [m]
  private points = 40;
  private centre: Triple = [0, 0, 0.2];

  constructor(private readonly send: (message: ToViewer) => void) {}

  show(shown: boolean): void {
    this.shown = shown;
    this.ask();
  }

  resize(side: number): void {
    this.side = side;
    this.ask();
  }

  /** Move the box to `centre` [m], if that is far enough away. */
  follow(centre: Triple): void {
    const away = Math.hypot(...centre.map((x, n) => x - (this.centre[n] ?? 0)));
    if (away < MIN_CONTACT_MOVE) return;
    this.centre = [...centre];
    if (this.shown) this.ask();
  }

  /** Request the volume. Call it again after each new connection. */
  ask(): void {
    if (!this.shown) {
      this.send({ type: "hide", what: "volume" });
      return;
    }
    const { centre, side, points } = this;
    this.send({
      type: "volume",
      id: nextId(),
      over: this.average,
      origin: [centre[0] - side / 2, centre[1] - side / 2, centre[2] - side / 2],
      spacing: side / (points - 1),
      shape: [points, points, points],
    });
  }
}
