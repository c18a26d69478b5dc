/** The newest of all that has come; who wants to know is told. */

import type {
  Arrayed,
  Frame,
  FromServer,
  Hello,
  Histogram,
  Recording,
  Refused,
  Replay,
  Scenery,
  Session,
  Slice,
  State,
  Volume,
} from "./messages";

/** live: all is well. lost: the array's server has gone. closed: the viewer's own server has. */
export type Link = "connecting" | "live" | "lost" | "closed";

export interface Events {
  link: Link;
  hello: Hello;
  array: Arrayed;
  session: Session;
  state: State;
  frame: Frame;
  scenery: Scenery;
  slice: Slice;
  volume: Volume;
  histogram: Histogram;
  refused: Refused;
  record: Recording;
  replay: Replay;
}

export class Store {
  link: Link = "connecting";
  reason = "";
  readonly newest: { -readonly [K in keyof Events]?: Events[K] } = {};
  private readonly listeners = new Map<keyof Events, ((value: never) => void)[]>();

  on<K extends keyof Events>(type: K, listener: (value: Events[K]) => void): void {
    const known = this.listeners.get(type) ?? [];
    known.push(listener);
    this.listeners.set(type, known);
  }

  /** Another state of the connection. */
  linked(link: Link, reason = ""): void {
    if (link === this.link && reason === this.reason) return;
    this.link = link;
    this.reason = reason;
    this.tell("link", link);
  }

  take(message: FromServer): void {
    if (message.type === "lost") {
      this.linked("lost", message.reason);
      return;
    }
    if (message.type === "array") this.linked("live");
    this.tell(message.type, message as never);
  }

  private tell<K extends keyof Events>(type: K, value: Events[K]): void {
    this.newest[type] = value as never;
    for (const listener of this.listeners.get(type) ?? []) listener(value as never);
  }
}
