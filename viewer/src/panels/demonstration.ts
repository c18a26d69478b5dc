/** The demonstration, offered while there is nothing to feel. The viewer plays it as a client of the server. */

import type { State, ToViewer } from "../feed/messages";
import type { Store } from "../feed/store";
import { button, element, say } from "./dom";

export const DEMONSTRATION = "demonstration"; // name of the client
const ALIVE_INTERVAL = 250; // time between two `alive` messages [ms]

export class DemonstrationPanel {
  private timer = 0;

  constructor(
    private readonly store: Store,
    private readonly send: (message: ToViewer) => void,
  ) {
    button("demonstrate").addEventListener("click", () => this.play(true));
    button("demonstrated").addEventListener("click", () => this.play(false));
    document.addEventListener("visibilitychange", () => {
      if (document.hidden && this.timer) this.play(false);
    });
    store.onBeat("state", (state) => this.show(state));
    store.on("refused", ({ action }) => {
      if (action === "demonstrate") this.rest();
    });
    store.on("link", () => {
      this.rest();
      this.show(undefined);
    });
  }

  private play(on: boolean): void {
    this.rest();
    this.send({ type: "demonstrate", on });
    if (!on) return;
    this.timer = window.setInterval(() => {
      if (!document.hidden) this.send({ type: "alive" });
    }, ALIVE_INTERVAL);
  }

  private rest(): void {
    clearInterval(this.timer);
    this.timer = 0;
  }

  private show(state: State | undefined): void {
    const live = this.store.link === "live" && !this.store.newest.hello?.recording;
    const plays = Boolean(live && state?.clients.some(({ name }) => name === DEMONSTRATION));
    const nothing = Boolean(state && !state.owner && !state.clients.some(({ objects }) => objects > 0));
    const free = state?.output === "silent";
    element("empty").hidden = !live || !nothing || plays || !free;
    element("plays").hidden = !plays;
    if (state) say(element("demonstrate-on"), state.backend);
  }
}
