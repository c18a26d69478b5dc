/** How the output is, who owns it, and what ends or begins sound. */

import type { Output, Session, Sound, State, ToServer } from "../feed/messages";
import type { Store } from "../feed/store";
import { button, choices, element, say, select } from "./dom";
import { digits, percent, seconds, whole } from "./words";

const WHY: Record<Output, string> = {
  silent: "nobody has armed it, or there is nothing to feel",
  sounding: "something can be felt",
  stale: "the renderer is late: silent until it goes on",
  stopped: "emergency stop, until reset",
  faulted: "a plug-in or device failed, until reset",
};
const OFTEN = 4; // times a lease that the page says it is alive
const CONTROLS = "button, input, select, textarea, summary, a, [role=switch]";

/** The air that the field is computed for. */
function air({ speed_of_sound: speed, temperature }: Sound): string {
  return `${typeof temperature === "number" ? `${digits(temperature)} °C, ` : ""}${digits(speed)} m/s`;
}

export class OutputPanel {
  private session: Session | undefined;
  private timer = 0;

  constructor(
    private readonly store: Store,
    private readonly send: (message: ToServer) => void,
  ) {
    button("arm").addEventListener("click", () => this.arm());
    button("disarm").addEventListener("click", () => send({ type: "disarm" }));
    button("reset").addEventListener("click", () => send({ type: "reset" }));
    button("stop").addEventListener("click", () => send({ type: "stop" }));
    document.addEventListener("keydown", (event) => this.key(event), { capture: true });
    store.on("hello", ({ recording }) => {
      for (const id of ["arm", "disarm", "reset", "stop"]) button(id).hidden = Boolean(recording);
    });
    store.on("array", ({ sound }) => say(element("air"), sound ? air(sound) : "–"));
    store.on("session", (session) => this.agree(session));
    store.on("state", (state) => {
      if (state.output !== element("output").dataset["output"]) this.show(state);
    });
    store.onBeat("state", (state) => this.show(state));
    store.on("link", (link) => {
      if (link === "live") this.show(store.newest.state);
      else this.agree(undefined);
    });
  }

  private key(event: KeyboardEvent): void {
    if (button("stop").hidden || event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    const free = !(event.target instanceof Element && event.target.closest(CONTROLS));
    if (event.key !== "Escape" && !(event.key === " " && free)) return;
    event.preventDefault();
    this.send({ type: "stop" });
  }

  private arm(): void {
    const state = this.store.newest.state;
    const take = Boolean(state?.owner && state.owner !== this.session?.name);
    this.send({ type: "arm", scene: select("scene").value, take });
  }

  /** The lease goes on for as long as this page is alive and looked at. */
  private agree(session: Session | undefined): void {
    this.session = session;
    clearInterval(this.timer);
    if (session?.mine) {
      const alive = (): void => {
        if (!document.hidden) this.send({ type: "alive" });
      };
      alive();
      this.timer = window.setInterval(alive, (1000 * session.lease) / OFTEN);
    }
    this.show(this.store.newest.state);
  }

  private show(state: State | undefined): void {
    const live = this.store.link === "live";
    const output = state?.output ?? "silent";
    const shown = live ? output : this.store.link;
    element("output").dataset["output"] = shown;
    document.body.dataset["link"] = this.store.link;
    say(element("output-name"), name(shown));
    say(element("output-why"), live && state ? WHY[output] : "");
    const held = output === "stopped" || output === "faulted";
    const mine = Boolean(this.session?.mine);
    const others = state?.owner && !mine ? state.owner : "";
    button("arm").disabled = !live || held || mine;
    say(button("arm"), others ? "Take over" : "Arm");
    button("disarm").disabled = !live || !mine;
    button("reset").disabled = !live || !held;
    if (!state) return;
    const names = [...new Set(state.clients.map(({ scene }) => scene))].filter(named);
    choices(select("scene"), names);
    select("scene").disabled = button("arm").disabled;
    element("scenes").hidden = names.length < 2;
    say(element("owner"), state.owner || "nobody");
    say(element("rate"), `${digits(state.rate)} Hz`);
    say(element("late"), state.ticks ? percent(state.late / state.ticks) : "–");
    element("late").title = `${whole(state.late)} of ${whole(state.ticks)} ticks`;
    say(element("gap"), seconds(state.longest_gap));
  }
}

/** Not one of a client's own. */
function named(scene: string): boolean {
  return scene !== "" && !scene.startsWith("own ");
}

function name(shown: string): string {
  if (shown === "lost") return "No server";
  if (shown === "closed") return "No viewer";
  return shown.charAt(0).toUpperCase() + shown.slice(1);
}
