/** Lists of samples by object, of work left out, of faults with their times, and of clients. */

import type { State } from "../feed/messages";
import { floats, indices } from "../feed/numbers";
import type { Store } from "../feed/store";
import { element, made, rows, say } from "./dom";
import { split } from "./skip-reasons";
import { digits, plural, seconds, whole } from "./format";

const MAX_OBJECTS = 8; // number of objects listed
const MAX_FAULTS = 50; // number of faults listed

export class Lists {
  /** Number of faults known so far; undefined before the first state of a server. */
  private known: number | undefined;

  constructor(store: Store) {
    store.on("state", (state) => this.watch(state));
    store.onBeat("state", (state) => this.show(state));
    store.on("link", () => {
      this.known = undefined;
    });
  }

  private show(state: State): void {
    say(element("fault-count"), whole(state.fault_count));
    element("fault-count").dataset["some"] = String(state.fault_count > 0);
    say(element("sample-count"), whole(state.asked.length / 4));
    rows(body("samples"), sampled(state));
    const { saved, problems } = split(state.skipped);
    for (const [id, reasons] of [["saved", saved], ["problems", problems]] as const) {
      rows(body(id), reasons.map(({ name, count }) => [name, whole(count)]));
      reasons.forEach(({ meaning }, k) => {
        const row = body(id).children[k];
        if (row instanceof HTMLElement) row.title = meaning;
      });
    }
    element("problem-none").hidden = problems.length > 0;
    say(element("problem-why"), problems[0]?.meaning ?? "");
    say(element("saved-count"), whole(saved.reduce((sum, { count }) => sum + count, 0)));
    const clients = state.clients.map((client) => [
      `${client.name}${client.owner ? " ◆ owner" : ""}`,
      whole(client.objects),
      `${whole(client.commands)}${client.errors ? `, ${plural(client.errors, "error")}` : ""}${client.dropped ? `, ${whole(client.dropped)} dropped` : ""}`,
      seconds(client.renewed),
    ]);
    rows(body("clients"), clients);
  }

  /** List new faults, with the time at which the page first saw them. */
  private watch(state: State): void {
    const { known } = this;
    const { faults, fault_count: count } = state;
    this.known = count;
    const fresh = known !== undefined ? Math.min(Math.max(count - known, 0), faults.length) : faults.length;
    if (!fresh) return;
    const at = new Date();
    for (const text of faults.slice(-fresh)) {
      element("faults").prepend(item(text, at, known === undefined));
    }
    while (element("faults").children.length > MAX_FAULTS) element("faults").lastElementChild?.remove();
    if (known !== undefined) say(element("spoken"), `Fault: ${faults.at(-1) ?? ""}`);
  }
}

function item(text: string, at: Date, before: boolean): HTMLLIElement {
  const time = made("time", before ? "before" : at.toLocaleTimeString("en-GB"));
  time.dateTime = at.toISOString();
  return made("li", time, made("span", text));
}

function body(table: string): HTMLElement {
  return element(table).querySelector("tbody") ?? element(table);
}

/** Return a row for each object: samples, mean target, mean achieved; between the samples: force, rms error, spill. */
function sampled(state: State): string[][] {
  const asked = floats(state.asked);
  const achieved = floats(state.achieved);
  const index = indices(state.index);
  const felt = floats(state.felt ?? new Uint8Array());
  const sums = state.objects.map((name, i) => ({
    name,
    count: 0,
    asked: 0,
    achieved: 0,
    force: felt[4 * i] ?? NaN,
    rms: felt[4 * i + 1] ?? NaN,
    spill: felt[4 * i + 3] ?? NaN,
  }));
  index.forEach((which, k) => {
    const sum = sums[which];
    if (!sum) return;
    sum.count += 1;
    sum.asked += asked[k] ?? 0;
    sum.achieved += achieved[k] ?? 0;
  });
  return sums
    .slice(0, MAX_OBJECTS)
    .map(({ name, count, ...sum }) => [
      name || "unnamed",
      whole(count),
      digits(sum.asked / count),
      digits(sum.achieved / count),
      ...[sum.force, sum.rms, sum.spill].map((x) => (Number.isFinite(x) ? `${digits(100 * x, 2)} %` : "–")),
    ]);
}
