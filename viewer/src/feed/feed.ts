/** The connection to the viewer's server: it opens again by itself, and says how it is. */

import { decode, encode } from "@msgpack/msgpack";

import type { Batch, FromServer, ToServer } from "./messages";

const FIRST = 250; // [ms] until the next try
const LONGEST = 2000; // [ms]

export interface Listener {
  opened(): void;
  message(message: FromServer): void;
  closed(): void;
}

export class Feed {
  private socket: WebSocket | undefined;
  private wait = FIRST;

  constructor(
    private readonly address: string,
    private readonly listener: Listener,
  ) {}

  /** Connect; from then on it keeps trying. */
  open(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    socket.addEventListener("open", () => {
      this.wait = FIRST;
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
      this.wait = Math.min(2 * this.wait, LONGEST);
    });
    this.socket = socket;
  }

  /** Whether it was sent: not while there is no connection. */
  send(message: ToServer): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(encode(message));
    return true;
  }
}

/** A message of the server; null where it is none, which is told on the console. */
export function read(data: ArrayBuffer): FromServer | Batch | null {
  try {
    const message = decode(data) as FromServer | Batch | null;
    if (typeof message?.type === "string") return message;
    throw new TypeError("it has no type");
  } catch (error) {
    console.error("the feed: not a message", error);
    return null;
  }
}

/** Where the feed of this page is: same host, same token. */
export function address(page: Location): string {
  const token = new URLSearchParams(page.search).get("token") ?? "";
  const scheme = page.protocol === "https:" ? "wss:" : "ws:";
  return `${scheme}//${page.host}/feed?token=${encodeURIComponent(token)}`;
}
