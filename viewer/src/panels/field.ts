/** Controls of the field: slice, isosurface, colour scale. */

import type { SurfaceBox } from "../field/surface-box";
import type { AutoScale } from "../field/auto-scale";
import type { SlicePlane } from "../field/slice-plane";
import { SCALE_LAWS } from "../field/scale-law";
import type { Over, Quantity } from "../feed/messages";
import type { Store } from "../feed/store";
import { AXES, number, peak, range } from "../space/planes";
import type { Space } from "../space/space";
import { button, element, input, say, select } from "./dom";
import { digits, millimetres } from "./format";

const WAIT = "being computed …";
const OVERS = ["mean", "peak", "instant"] as const;
const OVER_WORDS: Record<Over, string> = { mean: "mean", peak: "peak", instant: "this instant" };

export class FieldPanel {
  constructor(
    private readonly space: Space,
    private readonly slicePlane: SlicePlane,
    private readonly surfaceBox: SurfaceBox,
    private readonly scales: Record<Quantity, AutoScale>,
    store: Store,
  ) {
    this.listenSlice();
    this.listenSurface();
    this.listenScale();
    slicePlane.onChange(() => {
      this.showSlice();
      this.showScale();
      if (store.link === "live") say(element("slice-most"), slicePlane.shown ? WAIT : "–");
    });
    store.on("array", (array) => {
      this.showSlice();
      for (const id of ["slice-on", "surface-on"]) input(id).disabled = !array.fields;
      say(element("slice-most"), array.fields ? WAIT : "This server does not tell what the field is made of.");
    });
    store.onBeat("slice", () => this.showMost());
    store.onBeat("volume", () => this.showLevel());
    space.onScale(() => {
      this.showScale();
      this.showLevel();
    });
    this.showSlice();
    this.showLevel();
  }

  private listenSlice(): void {
    const { slicePlane, space } = this;
    input("slice-on").addEventListener("change", () => slicePlane.show(input("slice-on").checked));
    for (const radio of radios("of")) {
      radio.addEventListener("change", () => {
        if (radio.checked) slicePlane.choose(radio.value === "error" ? "error" : "pressure");
      });
    }
    for (const radio of radios("axis")) {
      radio.addEventListener("change", () => {
        if (radio.checked) slicePlane.turn(AXES.find((each) => each === radio.value));
      });
    }
    select("over").addEventListener("change", () => {
      const average = OVERS.find((each) => each === select("over").value) ?? "mean";
      this.surfaceBox.average = average;
      slicePlane.chooseAverage(average);
      this.surfaceBox.ask();
    });
    const [at, exactly] = [input("slice-at"), input("slice-mm")];
    at.addEventListener("input", () => slicePlane.move(at.valueAsNumber / 1000, true));
    at.addEventListener("change", () => slicePlane.move(at.valueAsNumber / 1000));
    exactly.addEventListener("change", () => {
      if (Number.isFinite(exactly.valueAsNumber)) slicePlane.move(exactly.valueAsNumber / 1000);
      else this.showSlice();
    });
    button("slice-follow").addEventListener("click", () => slicePlane.follow(!slicePlane.follows, space.middle));
    for (const id of ["slice-size", "slice-cells"]) {
      select(id).addEventListener("change", () =>
        slicePlane.resize(Number(select("slice-size").value), Number(select("slice-cells").value)),
      );
    }
  }

  private listenSurface(): void {
    const { surfaceBox, space } = this;
    input("surface-on").addEventListener("change", () => {
      surfaceBox.follow(space.middle);
      surfaceBox.show(input("surface-on").checked);
      space.recut();
    });
    input("level").addEventListener("input", () => {
      surfaceBox.share = Number(input("level").value) / 100;
      space.recut();
      this.showLevel();
    });
    select("box-size").addEventListener("change", () => surfaceBox.resize(Number(select("box-size").value)));
  }

  private listenScale(): void {
    const { space } = this;
    const top = input("scale");
    select("law").addEventListener("change", () => {
      space.law = SCALE_LAWS.find((each) => each === select("law").value) ?? "linear";
      space.rescale();
    });
    select("scale-auto").addEventListener("change", () => {
      this.scale.auto = select("scale-auto").value === "auto";
      this.showMost();
    });
    top.addEventListener("change", () => {
      if (!(top.valueAsNumber > 0)) return;
      this.scale.auto = false;
      this.scale.most = top.valueAsNumber;
      space.rescale();
      this.showMost();
    });
    for (const event of ["input", "blur"]) top.addEventListener(event, () => this.showScale());
  }

  /** The colour scale of the chosen quantity. */
  private get scale(): AutoScale {
    return this.scales[this.slicePlane.quantity];
  }

  private showScale(): void {
    select("scale-auto").value = this.scale.auto ? "auto" : "fixed";
    const top = input("scale");
    if (document.activeElement !== top) top.value = String(this.scale.most);
    const valid = top.valueAsNumber > 0;
    top.setAttribute("aria-invalid", String(!valid));
    element("scale-why").hidden = valid;
    say(element("scale-why"), valid ? "" : `The top must be above 0. Until then it is ${digits(this.scale.most)} Pa.`);
  }

  private showSlice(): void {
    const { slicePlane, space } = this;
    const n = number(slicePlane.axis);
    const [low, high] = [space.extent.low[n], space.extent.high[n]];
    const at = input("slice-at");
    at.min = String(Math.floor(1000 * Math.min(low, slicePlane.position)));
    at.max = String(Math.ceil(1000 * Math.max(high, slicePlane.position)));
    at.value = String(Math.round(1000 * slicePlane.position));
    at.setAttribute("aria-valuetext", `${slicePlane.axis} = ${millimetres(slicePlane.position)} mm`);
    input("slice-mm").value = String(Math.round(1e4 * slicePlane.position) / 10);
    input("slice-on").checked = slicePlane.shown;
    for (const radio of radios("axis")) radio.checked = radio.value === (slicePlane.faces ? "auto" : slicePlane.axis);
    button("slice-follow").setAttribute("aria-pressed", String(slicePlane.follows));
    say(element("slice-axis"), slicePlane.axis);
    select("over").value = slicePlane.average;
    select("over").disabled = slicePlane.quantity === "error";
    select("law").disabled = slicePlane.quantity === "error";
    for (const radio of radios("of")) radio.checked = radio.value === slicePlane.quantity;
  }

  private showMost(): void {
    const { plane, values, quantity } = this.space.slice;
    if (plane && quantity === "error") say(element("slice-most"), errorWords(values));
    else if (plane) {
      const { most, at } = peak(plane, values);
      const place = at.map((x) => millimetres(x)).join(", ");
      const { frames, average } = this.space.slice;
      const what = frames > 1 ? ` (${OVER_WORDS[average]} of ${frames} frames)` : average === "instant" ? " (this instant)" : "";
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
