/** Keys of the 3-D view: turn, zoom, move the slice. */

import type { SlicePlane } from "../field/slice-plane";
import type { Space } from "./space";

const ZOOM_FACTOR = 1.1; // factor of one key press
const SLICE_STEP = 0.001; // step of the slice [m]
const SHIFT_SLICE_STEP = 0.01; // step with Shift [m]

export function listen(space: Space, slicePlane: SlicePlane): void {
  const { viewport } = space;
  const move = (by: number, event: KeyboardEvent): void =>
    slicePlane.move(slicePlane.position + by * (event.shiftKey ? SHIFT_SLICE_STEP : SLICE_STEP));
  const actions: Record<string, (event: KeyboardEvent) => void> = {
    ArrowLeft: () => viewport.orbit(-1, 0),
    ArrowRight: () => viewport.orbit(1, 0),
    ArrowUp: () => viewport.orbit(0, 1),
    ArrowDown: () => viewport.orbit(0, -1),
    "+": () => viewport.orbit(0, 0, ZOOM_FACTOR),
    "=": () => viewport.orbit(0, 0, ZOOM_FACTOR),
    "-": () => viewport.orbit(0, 0, 1 / ZOOM_FACTOR),
    Home: () => viewport.all(),
    f: () => space.fit(),
    "1": () => viewport.from("y"),
    "2": () => viewport.from("x"),
    "3": () => viewport.from("z"),
    "4": () => space.fit(),
    PageUp: (event) => move(1, event),
    PageDown: (event) => move(-1, event),
    x: () => slicePlane.turn("x"),
    y: () => slicePlane.turn("y"),
    z: () => slicePlane.turn("z"),
    e: () => slicePlane.choose(slicePlane.quantity === "error" ? "pressure" : "error"),
    a: () => slicePlane.turn(),
    c: () => slicePlane.follow(true, space.middle),
  };
  viewport.canvas.addEventListener("keydown", (event) => {
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    action(event);
    event.preventDefault();
  });
}
