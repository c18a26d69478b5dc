/** Maps of a contact: target and achieved pressure side by side, on the same scale. */

import { COLOURS } from "../colours/maps";
import { sumAsked, type SkinPlane } from "../field/skin-plane";
import type { Skin, State } from "../feed/messages";
import { floats } from "../feed/numbers";
import type { Store } from "../feed/store";
import { PRESSURES } from "../space/map-textures";
import type { Space } from "../space/space";
import { choices, element, get, input, say, sayMarked, select } from "./dom";
import { digits } from "./format";

/** Recordings of `pacinian render` have no samples. */
const NO_SAMPLES = "This recording has no samples. Start `pacinian view --samples FILE` to see them.";

export class ContactMaps {
  private readonly made = { asked: get("skin-asked", HTMLCanvasElement), felt: get("skin-felt", HTMLCanvasElement) };
  private last = 0;

  constructor(
    private readonly store: Store,
    private readonly skinPlane: SkinPlane,
    private readonly space: Space,
  ) {
    input("skin-on").addEventListener("change", () => {
      skinPlane.show(input("skin-on").checked);
      if (!skinPlane.shown) this.clear("–");
    });
    select("contact").addEventListener("change", () => skinPlane.choose(select("contact").value));
    store.on("skin", (skin) => this.draw(skin));
    store.on("state", (state) => {
      if (store.newest.array?.fields) skinPlane.follow(state);
    });
    store.onBeat("state", (state) => this.say(state));
    store.on("link", () => skinPlane.forget());
  }

  private draw(skin: Skin): void {
    if (!this.skinPlane.shown) return;
    const [felt, asked] = [floats(skin.felt), floats(skin.asked)];
    const top = this.space.paint(skin, felt, asked);
    paint(this.made.asked, asked, skin.shape, top);
    paint(this.made.felt, felt, skin.shape, top);
    say(element("skin-top"), `0 to ${digits(top, 2)} Pa, ${Math.round(1000 * skin.size[0])} mm wide`);
    this.last = performance.now();
  }

  private say(state: State): void {
    this.offer(state);
    const i = state.objects.indexOf(this.skinPlane.object);
    const [force, rms, , spill] = floats(state.felt ?? new Uint8Array()).subarray(4 * i, 4 * i + 4);
    if (i < 0 || !Number.isFinite(force) || !state.asked.length) {
      const unknown = this.store.newest.hello?.recording && state.output === "sounding" && !state.asked.length;
      const none = unknown ? NO_SAMPLES : "no surface or volume is felt";
      if (!this.last || performance.now() > this.last + 1000) this.clear(none);
      return;
    }
    const shares = [force, rms, spill].map((x) => `${digits(100 * (x ?? NaN), 2)} %`);
    say(element("skin-words"), `${state.objects[i]}: force ${shares[0]}, rms ${shares[1]}, spill ${shares[2]}`);
    if (!this.last) say(element("skin-top"), "being computed …");
    element("skin-maps").hidden = !this.skinPlane.shown || !this.last;
  }

  /** Offer the contacts. The chosen one stays in the list while it is not felt. */
  private offer(state: State): void {
    const sums = sumAsked(state);
    const { wanted } = this.skinPlane;
    const felt = state.objects.filter((name, i) => (sums[i] ?? 0) > 0 && name !== wanted);
    const names = ["", ...[...felt, ...(wanted ? [wanted] : [])].sort()];
    choices(select("contact"), names);
    for (const option of select("contact").options) option.text = option.value || "the strongest";
    element("contacts").hidden = !this.skinPlane.shown || names.length < 3 && !wanted;
  }

  private clear(why: string): void {
    sayMarked(element("skin-words"), why);
    say(element("skin-top"), "");
    this.last = 0;
    element("skin-maps").hidden = true;
    this.skinPlane.forget();
    if (this.space.hands.painted) this.space.unpaint();
  }
}

function paint(canvas: HTMLCanvasElement, values: Float32Array, [rows, columns]: [number, number], top: number): void {
  canvas.width = columns;
  canvas.height = rows;
  const draw = canvas.getContext("2d");
  if (!draw) return;
  const image = draw.createImageData(columns, rows);
  values.forEach((value, k) => {
    if (Number.isNaN(value)) return;
    const row = rows - 1 - Math.floor(k / columns);
    const colour = 4 * Math.round(Math.min(Math.max(value / top, 0), 1) * (COLOURS - 1));
    image.data.set(PRESSURES.subarray(colour, colour + 4), 4 * (row * columns + (k % columns)));
  });
  draw.putImageData(image, 0, 0);
}
