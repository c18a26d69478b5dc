/** Messages between the viewer's server and the page: MessagePack maps with a `type`. Lengths are in metres. */

import type { Thing } from "./objects";

/** Packed little-endian numbers. */
export type Bytes = Uint8Array<ArrayBuffer>;
export type Triple = [number, number, number];

/** recording: name of the file that is replayed; empty if the viewer watches a server. */
export interface Hello {
  type: "hello";
  version: number;
  viewer: string;
  recording: string;
}

/** A plug-in that can be selected. */
export interface Plugin {
  name: string;
  summary: string;
}

/**
 * The transducers' sound. sizes: amplitude of each level, 0..1, float32; empty if levels are evenly spaced.
 * speed_of_sound: [m/s]. temperature: of the air [degC], as given to the server or assumed by it.
 */
export interface Sound {
  sizes: Bytes;
  speed_of_sound: number;
  temperature?: number | null;
}

/** The array, and the plug-ins that can be selected. */
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

/** The viewer's session. mine: whether this page armed; it must then send `alive` more often than every `lease` [s]. */
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
  /** The technique with its parameters, if the server sends them. */
  presentation?: { frequency?: number } | null;
  intensity: number;
  points: Bytes;
  normals: Bytes;
  asked: Bytes;
  achieved: Bytes;
  index: Bytes;
  objects: string[];
  hands: Bytes;
  /** Relative error of the sound pressures at the samples. */
  error: number;
  /** For each object: force, rms error, holes and spill, 4 float32; NaN without a region. */
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

/** The wire's `FrameState`: levels of all transducers, uint16; empty if silent. */
export interface Frame {
  type: "frame";
  sequence: number;
  time: number;
  phases: number;
  amplitudes: number;
  phase: Bytes;
  amplitude: Bytes;
}

/** The rendered scene. objects: only the new ones. poses: of all objects, 7 float32 each. */
export interface Scenery {
  type: "scenery";
  version: number;
  scene: string;
  objects: Record<string, Thing>;
  poses: Record<string, Bytes>;
}

/** A rectangle of `shape` cells: rows along v, columns along u, beginning at the corner -u -v. */
export interface Plane {
  centre: Triple;
  u: Triple;
  v: Triple;
  size: [number, number];
  shape: [number, number];
}

/** The quantity of a slice: radiation pressure, or its error on regions (achieved minus target). */
export type Quantity = "pressure" | "error";

/** How a pressure combines the last frames. */
export type Over = "mean" | "peak" | "instant";

/** Radiation pressure on a plane, or its error [Pa]; NaN where it is undefined. frames: number of frames combined. */
export interface Slice extends Plane {
  type: "slice";
  id: number;
  of: Quantity;
  over: Over;
  frames: number;
  pressure: Bytes;
  time: number;
}

/** Achieved and target pressure on the skin behind a plane [Pa]; NaN where there is no skin. */
export interface Skin extends Plane {
  type: "skin";
  id: number;
  felt: Bytes;
  asked: Bytes;
  time: number;
}

/** A grid of points that begins at `origin`, with `spacing` along x, y and z; z varies fastest. */
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

/** Why the output is silent, and what to do; both are empty while it sounds. */
export interface Silence {
  type: "silence";
  cause: string;
  text: string;
}

/** Drive and error of a recording, up to the time shown. times: float64 [s]; others: 0..1, float32, NaN if unknown. */
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

export type FromViewer =
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

/** The end of a batch of messages. The page answers with `ready`. */
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

export type ToViewer =
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
