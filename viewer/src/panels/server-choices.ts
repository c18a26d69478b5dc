/** Controls for the running server: each choice is requested, and shown once the server uses it. */

import type { Arrayed, Plugin, Selection, State, Technique, ToViewer } from "../feed/messages";
import type { Store } from "../feed/store";
import { whyUnavailable } from "./advice";
import { choices, element, input, say, select } from "./dom";

const CHOICE_TIMEOUT = 15_000; // time until a choice that the server does not follow is replaced by its own [ms]
const LATERAL_AMPLITUDE = 0.002; // amplitude of lateral modulation [m]
const FREQUENCIES: Record<string, number> = { am: 200, stm: 100, lm: 100 };
const NAMES: Record<string, string> = {
  "": "of each object",
  simultaneous: "all at once",
  am: "amplitude modulation",
  stm: "spatio-temporal modulation",
  lm: "lateral modulation",
};

export class ServerChoices {
  /** Choices that the server does not use yet, and the time until which the page waits for each [ms]. */
  private readonly waiting = new Map<string, { value: string; until: number }>();
  private intensity: number | undefined;
  /** Whether the viewer has armed. */
  private mine = false;

  constructor(
    private readonly store: Store,
    private readonly send: (message: ToViewer) => void,
  ) {
    for (const kind of ["solver", "backend"] as const) {
      const list = select(kind);
      list.addEventListener("change", () => this.ask(kind, list.value, { [kind]: { name: list.value } }));
    }
    select("technique").addEventListener("change", () => {
      const type = select("technique").value;
      input("frequency").value = String(FREQUENCIES[type] ?? 100);
      this.technique();
    });
    input("frequency").addEventListener("change", () => this.technique());
    input("intensity").addEventListener("input", () => this.strength());
    store.on("array", (array) => this.offer(array));
    store.onBeat("state", (state) => this.show(state));
    store.on("refused", ({ action }) => {
      if (action === "select") this.waiting.clear();
    });
    store.on("link", (link) => {
      this.waiting.clear();
      if (link !== "live") this.allow(undefined);
    });
    store.on("session", (session) => {
      this.mine = session.armed;
    });
    this.allow(undefined);
    this.rates("");
  }

  /** Enable the controls, or disable them and show the reason. */
  private allow(state: State | undefined): void {
    const why = this.store.newest.hello?.recording
      ? "This is a recording: nothing can be changed."
      : whyUnavailable(this.store.link, state) || (state?.owner && !this.mine
        ? `“${state.owner}” owns the output: take over to change these.`
        : "");
    for (const id of ["solver", "backend", "technique"]) select(id).disabled = Boolean(why);
    for (const id of ["frequency", "intensity"]) input(id).disabled = Boolean(why);
    say(element("drive-why"), why);
    element("drive-why").hidden = !why;
  }

  private ask(kind: string, value: string, selection: Selection): void {
    this.waiting.set(kind, { value, until: performance.now() + CHOICE_TIMEOUT });
    select(kind).setAttribute("aria-busy", "true");
    this.send({ type: "select", ...selection });
  }

  private technique(): void {
    const type = select("technique").value;
    this.ask("technique", type, { technique: technique(type, Number(input("frequency").value)) });
    this.rates(type);
  }

  /** Send the intensity, at most once a frame. */
  private strength(): void {
    const asked = this.intensity !== undefined;
    this.intensity = Number(input("intensity").value) / 100;
    say(element("intensity-value"), `${input("intensity").value} %`);
    if (asked) return;
    requestAnimationFrame(() => {
      const intensity = this.intensity;
      this.intensity = undefined;
      if (intensity === undefined) return;
      this.waiting.set("intensity", { value: String(intensity), until: performance.now() + 1000 });
      this.send({ type: "select", intensity });
    });
  }

  private offer({ solvers, backends, techniques }: Arrayed): void {
    choices(select("solver"), named(solvers));
    choices(select("backend"), named(backends));
    choices(select("technique"), ["", ...techniques]);
    for (const option of select("technique").options) {
      option.text = NAMES[option.value] ?? option.value;
      option.disabled = !option.value; // it ends with the first choice
    }
    const state = this.store.newest.state;
    if (state) this.show(state);
    else for (const kind of ["solver", "backend", "technique"]) select(kind).selectedIndex = -1; // not known yet
  }

  private show(state: State): void {
    for (const kind of ["solver", "backend", "technique"] as const) {
      const list = select(kind);
      if (this.pending(kind, state[kind])) continue;
      list.removeAttribute("aria-busy");
      const told = state[kind] || kind !== "solver"; // without a device, none is selected
      if (document.activeElement !== list && told) list.value = state[kind];
    }
    if (!this.pending("intensity", String(state.intensity)) && this.intensity === undefined) {
      const value = String(Math.round(100 * state.intensity));
      if (input("intensity").value !== value) input("intensity").value = value;
      say(element("intensity-value"), `${value} %`);
    }
    const rate = state.presentation?.frequency;
    if (rate && !this.waiting.has("technique") && document.activeElement !== input("frequency")) {
      if (Number(input("frequency").value) !== rate) input("frequency").value = String(rate);
    }
    this.rates(select("technique").value);
    this.allow(state);
    const chosen = this.store.newest.array?.solvers.find(({ name }) => name === select("solver").value);
    say(element("solver-summary"), (chosen?.summary ?? "").replaceAll("`", ""));
  }

  /** Return whether the server does not use the chosen value yet. */
  private pending(kind: string, now: string): boolean {
    const asked = this.waiting.get(kind);
    if (asked && (asked.value === now || performance.now() > asked.until)) this.waiting.delete(kind);
    return this.waiting.has(kind);
  }

  private rates(type: string): void {
    element("technique-rate").hidden = !(type in FREQUENCIES);
  }
}

function named(plugins: Plugin[]): string[] {
  return plugins.map((plugin) => plugin.name);
}

function technique(type: string, frequency: number): Technique {
  switch (type) {
    case "am":
    case "stm":
      return { type, frequency };
    case "lm":
      return { type, frequency, amplitude: LATERAL_AMPLITUDE };
    default:
      return { type: "simultaneous" };
  }
}
