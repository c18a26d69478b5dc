/** The connection to the viewer's server. It reconnects by itself, and reports when it opens and closes. */

import { decode, encode } from "@msgpack/msgpack";

import type { Batch, FromViewer, ToViewer } from "./messages";

const FIRST_DELAY = 250; // delay before the first retry [ms]; it doubles with each
const MAX_DELAY = 2000; // longest delay [ms]

export interface Listener {
  opened(): void;
  message(message: FromViewer): void;
  closed(): void;
}

export class Feed {
  private socket: WebSocket | undefined;
  private wait = FIRST_DELAY;

  constructor(
    private readonly address: string,
    private readonly listener: Listener,
  ) {}

  /** Connect, and reconnect after every loss. */
  open(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    socket.addEventListener("open", () => {
      this.wait = FIRST_DELAY;
      this.listener.opened();
    });
    socket.addEventListener("message", (event: MessageEvent<unknown>) => {
      const message = event.data instanceof ArrayBuffer ? read(event.data) : null;
      if (message?.type === "batch") this.send({ type: "ready" });
      else if (message) this.listener.message(message);
    });
    socket.addEventListener("close", () => {
      if (this.socket !== socket) return;
      this.listener.closed();
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2 * this.wait, MAX_DELAY);
    });
    this.socket = socket;
  }

  /** Send a message. Return false if there is no connection. */
  send(message: ToViewer): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(encode(message));
    return true;
  }
}

/** Decode a message of the server. Return null, and log an error, if it is not valid. */
export function read(data: ArrayBuffer): FromViewer | Batch | null {
  try {
    const message = decode(data) as FromViewer | Batch | null;
    if (typeof message?.type === "string") return message;
    throw new TypeError("it has no type");
  } catch (error) {
    console.error("the feed: not a message", error);
    return null;
  }
}

/** Return the address of the feed: the host and the token of the page. */
export function address(page: Location): string {
  const token = new URLSearchParams(page.search).get("token") ?? "";
  const scheme = page.protocol === "https:" ? "wss:" : "ws:";
  return `${scheme}//${page.host}/feed?token=${encodeURIComponent(token)}`;
}
