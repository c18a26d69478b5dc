/** The state and the owner of the output, and the buttons that start and end sound. */

import type { Session, Sound, State, ToViewer } from "../feed/messages";
import type { Store } from "../feed/store";
import { whyUnavailable } from "./advice";
import { DEMONSTRATION } from "./demonstration";
import { button, choices, element, say, select } from "./dom";
import { digits, percent, seconds, whole } from "./format";
import { explainSilence } from "./silence";

const DISABLED_REASON = {
  held: "The output is stopped: press Reset first.",
  mine: "This page has armed already.",
  other: "This page has not armed.",
  free: "Nothing is stopped or faulted.",
} as const;
const MIN_TICKS = 1000; // number of ticks from which the share of late ones is shown
const ALIVES_PER_LEASE = 4; // `alive` messages per lease
const CONTROLS = "button, input, select, textarea, summary, a, [role=switch]";

/** Describe the air for which the field is computed. */
function air({ speed_of_sound: speed, temperature }: Sound): string {
  return `${typeof temperature === "number" ? `${digits(temperature)} °C, ` : ""}${digits(speed)} m/s`;
}

export class OutputPanel {
  private session: Session | undefined;
  /** The client from which this page has taken the output. */
  private taken = "";
  private timer = 0;

  constructor(
    private readonly store: Store,
    private readonly send: (message: ToViewer) => void,
  ) {
    button("arm").addEventListener("click", () => this.arm());
    button("take-yes").addEventListener("click", () => this.take());
    button("take-no").addEventListener("click", () => this.ask(false));
    button("disarm").addEventListener("click", () => send({ type: "disarm" }));
    button("reset").addEventListener("click", () => send({ type: "reset" }));
    button("stop").addEventListener("click", () => send({ type: "stop" }));
    document.addEventListener("keydown", (event) => this.key(event), { capture: true });
    store.on("hello", ({ recording }) => {
      for (const id of ["arm", "disarm", "reset", "stop"]) button(id).hidden = Boolean(recording);
    });
    store.on("array", ({ sound }) => say(element("air"), sound ? air(sound) : "–"));
    store.on("session", (session) => this.setSession(session));
    store.on("state", (state) => {
      if (state.output !== element("output").dataset["output"]) this.show(state);
    });
    store.onBeat("state", (state) => this.show(state));
    store.onBeat("silence", () => this.show(store.newest.state));
    store.on("link", (link) => {
      if (link === "live") this.show(store.newest.state);
      else this.setSession(undefined);
    });
  }

  private key(event: KeyboardEvent): void {
    if (button("stop").hidden || event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    const free = !(event.target instanceof Element && event.target.closest(CONTROLS));
    if (event.key !== "Escape" && !(event.key === " " && free)) return;
    event.preventDefault();
    this.ask(false);
    this.send({ type: "stop" });
  }

  private arm(): void {
    if (this.otherOwner) this.ask(true);
    else this.send({ type: "arm", scene: select("scene").value, take: false });
  }

  /** The other client that owns the output; empty if there is none. */
  private get otherOwner(): string {
    const owner = this.store.newest.state?.owner ?? "";
    return this.session?.mine || owner === this.session?.name ? "" : owner;
  }

  /** Ask whether to take the output from another client. */
  private ask(on: boolean): void {
    element("take").hidden = !on;
    if (!on) return;
    const scene = select("scene").value;
    const { otherOwner } = this;
    const then = scene
      ? `Then the scene “${scene}” is felt, for as long as this page is open and in view.`
      : "Then nothing is felt: this viewer's own scene is empty.";
    say(element("take-title"), `Take the output from “${otherOwner}”?`);
    const text =
      otherOwner === DEMONSTRATION
        ? `The demonstration ends. ${then} “Disarm” ends that.`
        : `Its sound ends, and it receives a message. ${then} “Give back” ends that, and “${otherOwner}” can arm again.`;
    say(element("take-text"), text);
    button("take-no").focus();
  }

  private take(): void {
    this.taken = this.otherOwner;
    this.send({ type: "arm", scene: select("scene").value, take: Boolean(this.taken) });
    this.ask(false);
  }

  /** Store the session. While this page owns the output and is visible, renew the lease with `alive`. */
  private setSession(session: Session | undefined): void {
    if (!session?.mine && this.session?.mine) this.taken = "";
    this.session = session;
    clearInterval(this.timer);
    if (session?.mine) {
      const alive = (): void => {
        if (!document.hidden) this.send({ type: "alive" });
      };
      alive();
      this.timer = window.setInterval(alive, (1000 * session.lease) / ALIVES_PER_LEASE);
    }
    this.show(this.store.newest.state);
  }

  private show(state: State | undefined): void {
    const live = this.store.link === "live";
    const output = state?.output;
    const shown = live ? (output ?? "connecting") : this.store.link;
    element("output").dataset["output"] = shown;
    document.body.dataset["link"] = this.store.link;
    say(element("output-name"), name(shown));
    const why = live && output ? explainSilence(output, this.store.newest.silence?.text) : "";
    say(element("output-why"), why);
    element("output-why").title = why; // for a line that is cut off
    const held = output === "stopped" || output === "faulted";
    const mine = Boolean(this.session?.mine);
    const { otherOwner } = this;
    const no = whyUnavailable(this.store.link, state);
    const own = "Let the scene be felt, for as long as this page is open and in view.";
    const take = `Let another scene be felt in place of ${otherOwner}'s. You are asked first.`;
    enable("arm", no || (held && DISABLED_REASON.held) || (mine && DISABLED_REASON.mine), otherOwner ? take : own);
    say(button("arm"), otherOwner ? "Take over …" : "Arm");
    if (!otherOwner || no || held) this.ask(false);
    // a demonstration ends when another client takes its output
    const back = this.taken !== DEMONSTRATION && state?.clients.some(({ name }) => name === this.taken);
    const does = back ? `End this, so that ${this.taken} can arm again.` : "Silence, softly.";
    enable("disarm", no || (!mine && DISABLED_REASON.other), does);
    say(button("disarm"), back ? "Give back" : "Disarm");
    enable("reset", no || (!held && DISABLED_REASON.free), "End the emergency stop or the fault. Nothing is armed by it.");
    if (!state) return;
    const names = [...new Set(state.clients.map(({ scene }) => scene))].filter(named);
    choices(select("scene"), names);
    select("scene").disabled = button("arm").disabled;
    element("scenes").hidden = names.length < 2;
    say(element("owner"), state.owner || "nobody");
    say(element("rate"), `${digits(state.rate)} Hz`);
    say(element("late"), state.ticks >= MIN_TICKS ? percent(state.late / state.ticks) : "–");
    element("late").title = `${whole(state.late)} of ${whole(state.ticks)} ticks`;
    say(element("gap"), seconds(state.longest_gap));
  }
}

/** Enable a button, or disable it and show the reason. */
function enable(id: string, cannot: string | false, does: string): void {
  button(id).disabled = Boolean(cannot);
  button(id).title = cannot || does;
  button(id).setAttribute("aria-description", cannot || does);
}

/** Return whether a game named the scene, so that it is not a client's own. */
function named(scene: string): boolean {
  return scene !== "" && !scene.startsWith("own ");
}

function name(shown: string): string {
  if (shown === "lost") return "No server";
  if (shown === "closed") return "No viewer";
  return shown.charAt(0).toUpperCase() + shown.slice(1);
}
