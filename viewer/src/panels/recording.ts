/** Controls to record the feed, and to play a recording. */

import type { Replay, ToViewer } from "../feed/messages";
import type { Store } from "../feed/store";
import { button, element, input, say, select } from "./dom";

export class RecordingPanel {
  private replay: Replay | undefined;
  private held = false;
  private due = false;
  private wanted = 0; // position of the slider [s]

  constructor(
    store: Store,
    private readonly send: (message: ToViewer) => void,
  ) {
    const scrub = input("scrub");
    store.on("hello", ({ recording }) => {
      button("record").hidden = Boolean(recording);
      element("replay").hidden = !recording;
      document.title = recording ? `${recording}: Pacinian` : "Pacinian";
    });
    store.on("link", (link) => {
      button("record").disabled = link !== "live" && button("record").getAttribute("aria-pressed") !== "true";
    });
    store.on("record", ({ on, file }) => {
      button("record").setAttribute("aria-pressed", String(on));
      button("record").title = file;
      say(button("record"), on ? "Recording" : "Record");
    });
    store.on("replay", (replay) => {
      if (replay.playing !== this.replay?.playing) this.show(replay);
    });
    store.onBeat("replay", (replay) => this.show(replay));
    button("record").addEventListener("click", () => {
      send({ type: "record", on: button("record").getAttribute("aria-pressed") !== "true" });
    });
    button("play").addEventListener("click", () => this.play());
    scrub.addEventListener("input", () => this.scrub());
    scrub.addEventListener("change", () => {
      this.held = false;
    });
    select("speed").addEventListener("change", () => {
      send({ type: "replay", speed: Number(select("speed").value) });
    });
    element("replay").addEventListener("submit", (event) => event.preventDefault());
  }

  private play(): void {
    this.send({ type: "replay", playing: !this.replay?.playing });
  }

  /** Send the position of the slider, at most once a frame. */
  private scrub(): void {
    this.held = true;
    this.wanted = Number(input("scrub").value); // read now, because `show` may move the slider before it is sent
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.send({ type: "replay", time: this.wanted, playing: false });
    });
  }

  private show(replay: Replay): void {
    this.replay = replay;
    const { time, duration, playing, speed } = replay;
    say(button("play"), playing ? "Pause" : "Play");
    say(element("replay-time"), `${time.toFixed(2)} s`);
    say(element("replay-end"), `${duration.toFixed(2)} s`);
    const scrub = input("scrub");
    scrub.max = String(duration);
    if (!this.held) scrub.value = String(time);
    scrub.setAttribute("aria-valuetext", `${time.toFixed(2)} of ${duration.toFixed(2)} s`);
    if (document.activeElement !== select("speed")) select("speed").value = String(speed);
  }
}
