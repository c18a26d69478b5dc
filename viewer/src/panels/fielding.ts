/** What of the field is wanted: slice, surface, colour scale. */

import type { Boxer } from "../field/boxer";
import { round, type Scale } from "../field/scale";
import type { Slicer } from "../field/slicer";
import { LAWS } from "../field/law";
import type { Over, Quantity } from "../feed/messages";
import type { Store } from "../feed/store";
import { AXES, number, peak, range } from "../space/planes";
import type { Space } from "../space/space";
import { button, element, input, say, select } from "./dom";
import { scaleBar } from "./legend";
import { digits, millimetres } from "./words";

const WAIT = "being computed …";
const OVERS = ["mean", "peak", "instant"] as const;
const OVER_WORDS: Record<Over, string> = { mean: "mean", peak: "peak", instant: "this instant" };

export class FieldPanel {
  constructor(
    private readonly space: Space,
    private readonly slicer: Slicer,
    private readonly boxer: Boxer,
    private readonly scales: Record<Quantity, Scale>,
    store: Store,
  ) {
    this.listenSlice();
    this.listenSurface();
    this.listenScale();
    slicer.onChange(() => {
      this.showSlice();
      this.showScale();
      if (store.link === "live") say(element("slice-most"), slicer.on ? WAIT : "–");
    });
    store.on("array", (array) => {
      this.showSlice();
      for (const id of ["slice-on", "surface-on"]) input(id).disabled = !array.fields;
      say(element("slice-most"), array.fields ? WAIT : "This server does not tell what the field is made of.");
    });
    store.onBeat("slice", () => this.showMost());
    store.onBeat("volume", () => this.showLevel());
    this.showSlice();
    this.showLevel();
  }

  private listenSlice(): void {
    const { slicer, space } = this;
    input("slice-on").addEventListener("change", () => slicer.show(input("slice-on").checked));
    for (const radio of radios("of")) {
      radio.addEventListener("change", () => {
        if (radio.checked) slicer.choose(radio.value === "error" ? "error" : "pressure");
      });
    }
    for (const radio of radios("axis")) {
      radio.addEventListener("change", () => {
        if (radio.checked) slicer.turn(AXES.find((each) => each === radio.value));
      });
    }
    select("over").addEventListener("change", () => {
      const over = OVERS.find((each) => each === select("over").value) ?? "mean";
      this.boxer.over = over;
      slicer.take(over);
      this.boxer.ask();
    });
    const [at, exactly] = [input("slice-at"), input("slice-mm")];
    at.addEventListener("input", () => slicer.move(at.valueAsNumber / 1000, true));
    at.addEventListener("change", () => slicer.move(at.valueAsNumber / 1000));
    exactly.addEventListener("change", () => {
      if (Number.isFinite(exactly.valueAsNumber)) slicer.move(exactly.valueAsNumber / 1000);
      else this.showSlice();
    });
    button("slice-follow").addEventListener("click", () => slicer.follow(!slicer.follows, space.middle));
    for (const id of ["slice-size", "slice-cells"]) {
      select(id).addEventListener("change", () =>
        slicer.resize(Number(select("slice-size").value), Number(select("slice-cells").value)),
      );
    }
  }

  private listenSurface(): void {
    const { boxer, space } = this;
    input("surface-on").addEventListener("change", () => {
      boxer.follow(space.middle);
      boxer.show(input("surface-on").checked);
      space.recut();
    });
    input("level").addEventListener("input", () => {
      boxer.share = Number(input("level").value) / 100;
      space.recut();
      this.showLevel();
    });
    select("box-size").addEventListener("change", () => boxer.resize(Number(select("box-size").value)));
  }

  private listenScale(): void {
    const { slicer, space } = this;
    const top = input("scale");
    select("law").addEventListener("change", () => {
      space.law = LAWS.find((each) => each === select("law").value) ?? "linear";
      space.rescale();
      space.view.urge();
      scaleBar(this.scale.most, slicer.of, space.law, slicer.over);
    });
    select("scale-auto").addEventListener("change", () => {
      this.scale.auto = select("scale-auto").value === "auto";
      this.showMost();
    });
    top.addEventListener("change", () => {
      const { scale } = this;
      scale.auto = false;
      scale.most = Number(top.value) > 0 ? Number(top.value) : round(scale.most);
      space.rescale();
      this.showMost();
    });
  }

  /** Of what is wanted. */
  private get scale(): Scale {
    return this.scales[this.slicer.of];
  }

  private showScale(): void {
    select("scale-auto").value = this.scale.auto ? "auto" : "fixed";
    if (document.activeElement !== input("scale")) input("scale").value = String(this.scale.most);
  }

  private showSlice(): void {
    const { slicer, space } = this;
    const n = number(slicer.axis);
    const [low, high] = [space.extent.low[n], space.extent.high[n]];
    const at = input("slice-at");
    at.min = String(Math.floor(1000 * Math.min(low, slicer.position)));
    at.max = String(Math.ceil(1000 * Math.max(high, slicer.position)));
    at.value = String(Math.round(1000 * slicer.position));
    at.setAttribute("aria-valuetext", `${slicer.axis} = ${millimetres(slicer.position)} mm`);
    input("slice-mm").value = String(Math.round(1e4 * slicer.position) / 10);
    input("slice-on").checked = slicer.on;
    for (const radio of radios("axis")) radio.checked = radio.value === (slicer.faces ? "auto" : slicer.axis);
    button("slice-follow").setAttribute("aria-pressed", String(slicer.follows));
    say(element("slice-axis"), slicer.axis);
    select("over").value = slicer.over;
    select("over").disabled = slicer.of === "error";
    select("law").disabled = slicer.of === "error";
    for (const radio of radios("of")) radio.checked = radio.value === slicer.of;
  }

  private showMost(): void {
    const { plane, values, of } = this.space.slice;
    if (plane && of === "error") say(element("slice-most"), errorWords(values));
    else if (plane) {
      const { most, at } = peak(plane, values);
      const place = at.map((x) => millimetres(x)).join(", ");
      const { frames, over } = this.space.slice;
      const what = frames > 1 ? ` (${OVER_WORDS[over]} of ${frames} frames)` : over === "instant" ? " (this instant)" : "";
      const past = most > this.space.scale.most ? ", past the bar," : "";
      say(element("slice-most"), most ? `max ${digits(most)} Pa${what}${past} at (${place}) mm` : `max 0 Pa${what}`);
    }
    this.showScale();
    this.showLevel();
  }

  private showLevel(): void {
    say(element("level-value"), this.space.slice.plane ? `${digits(this.space.level, 2)} Pa` : "–");
    input("level").setAttribute("aria-valuetext", `${digits(this.space.level, 2)} Pa`);
  }
}

function radios(name: string): HTMLInputElement[] {
  return [...document.querySelectorAll<HTMLInputElement>(`input[name=${name}]`)];
}

function errorWords(values: Float32Array): string {
  const found = range(values);
  if (!found) return "No surface or volume that is felt is within 5 mm of this slice.";
  return `max ${digits(-found.low)} Pa too little, ${digits(found.high)} Pa too much`;
}
