/** Messages between the viewer's server and the page: MessagePack maps with a `type`. Lengths in metres. */

import type { Thing } from "./objects";

/** Bulk numbers, little-endian. */
export type Bytes = Uint8Array<ArrayBuffer>;
export type Triple = [number, number, number];

/** recording: name of the file that is replayed; empty where a server is watched. */
export interface Hello {
  type: "hello";
  version: number;
  viewer: string;
  recording: string;
}

/** What can be selected. */
export interface Plugin {
  name: string;
  summary: string;
}

/**
 * How transducers sound. sizes: amplitude of each level, 0..1, float32; empty: evenly spaced. speed_of_sound: [m/s].
 * temperature: of the air [degC], as the server was told or else assumes.
 */
export interface Sound {
  sizes: Bytes;
  speed_of_sound: number;
  temperature?: number | null;
}

/** The array and what there is to select. */
export interface Arrayed {
  type: "array";
  server: string;
  positions: Bytes;
  normals: Bytes;
  frequency: number;
  wavelength: number;
  phases: number;
  amplitudes: number;
  rate: number;
  limits: Record<string, number>;
  solvers: Plugin[];
  backends: Plugin[];
  techniques: string[];
  presets: string[];
  fields: boolean;
  sound?: Sound | null;
}

/** The viewer as the server's client. mine: armed by this page, which must say `alive` oftener than `lease` [s]. */
export interface Session {
  type: "session";
  name: string;
  scene: string;
  lease: number;
  armed: boolean;
  mine: boolean;
}

export type Output = "silent" | "sounding" | "stale" | "stopped" | "faulted";

export interface ClientState {
  name: string;
  scene: string;
  owner: boolean;
  objects: number;
  commands: number;
  errors: number;
  dropped: number;
  age: number;
  renewed: number;
}

/** The wire's `State`. */
export interface State {
  type: "state";
  sequence: number;
  time: number;
  output: Output;
  armed: boolean;
  owner: string;
  scene: string;
  solver: string;
  backend: string;
  technique: string;
  /** The technique with its parameters, of servers that tell them. */
  presentation?: { frequency?: number } | null;
  intensity: number;
  points: Bytes;
  normals: Bytes;
  asked: Bytes;
  achieved: Bytes;
  index: Bytes;
  objects: string[];
  hands: Bytes;
  /** Of the sound pressures at the samples. */
  error: number;
  /** Force, rms, holes, spill of each object between its samples, 4 float32; NaN without a region. */
  felt: Bytes;
  status: string;
  ticks: number;
  late: number;
  rate: number;
  tick_ms: Triple;
  frames: number;
  longest_gap: number;
  skipped: Record<string, number>;
  faults: string[];
  fault_count: number;
  restarts: Record<string, number>;
  clients: ClientState[];
}

/** The wire's `FrameState`: levels of all transducers, uint16; empty in silence. */
export interface Frame {
  type: "frame";
  sequence: number;
  time: number;
  phases: number;
  amplitudes: number;
  phase: Bytes;
  amplitude: Bytes;
}

/** The scene that is felt. objects: those that are new. poses: of all that are there, 7 float32. */
export interface Scenery {
  type: "scenery";
  version: number;
  scene: string;
  objects: Record<string, Thing>;
  poses: Record<string, Bytes>;
}

/** A rectangle in space, and the middles of `shape` cells of it: rows along v, columns along u, from -u -v. */
export interface Plane {
  centre: Triple;
  u: Triple;
  v: Triple;
  size: [number, number];
  shape: [number, number];
}

/** What a slice is of: radiation pressure, or its error on regions, made minus asked. */
export type Quantity = "pressure" | "error";

/** Which pressure, of the frames of the last moments. */
export type Over = "mean" | "peak" | "instant";

/** Radiation pressure on a plane, or its error [Pa]; NaN where there is none. frames: how many count. */
export interface Slice extends Plane {
  type: "slice";
  id: number;
  of: Quantity;
  over: Over;
  frames: number;
  pressure: Bytes;
  time: number;
}

/** What is felt on the skin behind a plane, and what is asked there [Pa]; NaN where there is none. */
export interface Skin extends Plane {
  type: "skin";
  id: number;
  felt: Bytes;
  asked: Bytes;
  time: number;
}

/** Points from `origin` on, `spacing` apart along x, y and z; z is the fastest. */
export interface Box {
  origin: Triple;
  spacing: number;
  shape: Triple;
}

/** Radiation pressure in a box [Pa]. */
export interface Volume extends Box {
  type: "volume";
  id: number;
  pressure: Bytes;
  time: number;
}

export interface Histogram {
  type: "histogram";
  edges_ms: number[];
  counts: number[];
  deadline_ms: number;
}

/** Why the output is silent, and what to do; both empty while it sounds. */
export interface Silence {
  type: "silence";
  cause: string;
  text: string;
}

/** Of a recording: drive and error before the time that is shown. times: float64 [s]; others 0..1, float32; NaN: none. */
export interface Past {
  type: "history";
  times: Bytes;
  drive_mean: Bytes;
  drive_max: Bytes;
  error: Bytes;
}

export interface Lost {
  type: "lost";
  reason: string;
}

export interface Refused {
  type: "refused";
  action: string;
  message: string;
  advice: string;
}

/** Whether the feed is being recorded, and to which file. */
export interface Recording {
  type: "record";
  on: boolean;
  file: string;
}

export interface Replay {
  type: "replay";
  time: number;
  duration: number;
  playing: boolean;
  speed: number;
}

export type FromServer =
  | Hello
  | Arrayed
  | Session
  | State
  | Frame
  | Scenery
  | Slice
  | Volume
  | Skin
  | Histogram
  | Silence
  | Past
  | Lost
  | Refused
  | Recording
  | Replay;

/** The end of what was new: it is answered with `ready`. */
export interface Batch {
  type: "batch";
}

/** How samples are presented in time. */
export type Technique =
  | { type: "simultaneous" }
  | { type: "am"; frequency: number }
  | { type: "stm"; frequency: number }
  | { type: "lm"; frequency: number; amplitude: number };

export interface Selection {
  solver?: { name: string };
  backend?: { name: string };
  technique?: Technique;
  intensity?: number;
}

export type ToServer =
  | ({ type: "slice"; id: number; of: Quantity; over: Over } & Plane)
  | ({ type: "volume"; id: number; over: Over } & Box)
  | ({ type: "skin"; id: number } & Plane)
  | { type: "hide"; what: "slice" | "volume" | "skin" }
  | { type: "seen"; id: number }
  | { type: "ready" }
  | ({ type: "select" } & Selection)
  | { type: "arm"; scene: string; take: boolean }
  | { type: "alive" | "disarm" | "stop" | "reset" }
  | { type: "record" | "demonstrate"; on: boolean }
  | { type: "replay"; time?: number; playing?: boolean; speed?: number };
