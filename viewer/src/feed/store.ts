/**
 * Keeps the newest message of each type, and calls the listeners.
 *
 * Drawing code (`on`) gets each message. Code that updates text (`onBeat`) gets only the newest of each type, a few
 * times a second, all at once before a frame: people read no faster, and changing a text costs more than handling a
 * message.
 */

import type {
  Arrayed,
  Frame,
  FromViewer,
  Hello,
  Histogram,
  Past,
  Recording,
  Refused,
  Replay,
  Scenery,
  Session,
  Silence,
  Skin,
  Slice,
  State,
  Volume,
} from "./messages";

/** live: connected. lost: the array's server is gone. closed: the viewer's own server is gone. */
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
  skin: Skin;
  histogram: Histogram;
  silence: Silence;
  history: Past;
  refused: Refused;
  /** An emergency stop of the user: whether it was sent. */
  stop: boolean;
  /** Another command of the user that was not sent: its `type`. */
  unsent: string;
  record: Recording;
  replay: Replay;
}

const MIN_CALL_INTERVAL = 200; // shortest time from the first unread message until the readers are called [ms]

type Listeners = Map<keyof Events, ((value: never) => void)[]>;

export class Store {
  link: Link = "connecting";
  reason = "";
  readonly newest: { -readonly [K in keyof Events]?: Events[K] } = {};
  private readonly listeners: Listeners = new Map();
  private readonly readers: Listeners = new Map();
  private readonly unread = new Set<keyof Events>();

  /** later: calls its argument before a later frame. */
  constructor(private readonly later: (read: () => void) => void = beforeFrame) {}

  /** Call `listener` with each message of this type. */
  on<K extends keyof Events>(type: K, listener: (value: Events[K]) => void): void {
    add(this.listeners, type, listener);
  }

  /** Call `reader` with the newest message of this type, a few times a second. */
  onBeat<K extends keyof Events>(type: K, reader: (value: Events[K]) => void): void {
    add(this.readers, type, reader);
  }

  /** Set the state of the connection. */
  linked(link: Link, reason = ""): void {
    if (link === this.link && reason === this.reason) return;
    this.link = link;
    this.reason = reason;
    this.tell("link", link);
  }

  /** Report whether a command of the user was sent. */
  report<K extends "stop" | "unsent">(type: K, value: Events[K]): void {
    this.tell(type, value);
  }

  take(message: FromViewer): void {
    if (message.type === "lost") {
      this.linked("lost", message.reason);
      return;
    }
    if (message.type === "array" && this.link !== "live") {
      for (const type of ["silence", "state"] as const) {
        delete this.newest[type]; // from before the loss; no longer valid
        this.unread.delete(type);
      }
      this.linked("live");
    }
    this.tell(message.type, message as never);
  }

  private tell<K extends keyof Events>(type: K, value: Events[K]): void {
    this.newest[type] = value as never;
    call(this.listeners.get(type), value);
    if (!this.readers.has(type)) return;
    if (!this.unread.size) this.later(() => this.read());
    this.unread.add(type);
  }

  private read(): void {
    for (const type of this.unread) call(this.readers.get(type), this.newest[type]);
    this.unread.clear();
  }
}

function add(listeners: Listeners, type: keyof Events, listener: (value: never) => void): void {
  const known = listeners.get(type);
  if (known) known.push(listener);
  else listeners.set(type, [listener]);
}

/** Call all listeners, even if one of them throws, as on a malformed message. */
function call(listeners: ((value: never) => void)[] | undefined, value: unknown): void {
  for (const listener of listeners ?? []) {
    try {
      listener(value as never);
    } catch (error) {
      console.error("the feed: a message is not understood", error);
    }
  }
}

function beforeFrame(read: () => void): void {
  setTimeout(() => requestAnimationFrame(read), MIN_CALL_INTERVAL);
}
