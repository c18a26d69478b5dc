/** Sends what the page asks of the viewer. No command of the user gets lost without a word, and a stop is sent late. */

import type { ToViewer } from "./messages";
import type { Store } from "./store";

/** Messages that only the user causes. The page repeats all others by itself once it is connected. */
const COMMANDS: readonly string[] = ["arm", "disarm", "reset", "select", "record", "demonstrate", "replay"];

export class Commands {
  /** Whether a stop was not sent, or was sent and has had no effect yet. */
  private stopWaits = false;

  /** transmit: sends a message; returns false if there is no connection. store: reports what was not sent. */
  constructor(
    private readonly transmit: (message: ToViewer) => boolean,
    private readonly store: Store,
  ) {
    store.on("state", ({ output }) => {
      if (output === "stopped" || output === "faulted") this.stopWaits = false;
    });
    store.on("refused", ({ action }) => {
      if (action === "stop") this.stopWaits = false;
    });
  }

  /** Send a message. A stop waits for `sendWaiting` until it has an effect: a late stop is safer than none. */
  send(message: ToViewer): void {
    const sent = this.transmit(message);
    if (message.type === "stop") {
      this.stopWaits = true;
      this.store.report("stop", sent);
    } else if (!sent && COMMANDS.includes(message.type)) this.store.report("unsent", message.type);
  }

  /** Send the stop that waits, if there is one. Call this first on a new connection. */
  sendWaiting(): void {
    if (this.stopWaits) this.send({ type: "stop" });
  }
}
