/** Text in space: always upright, of constant size on the page, drawn over everything else. */

import { CanvasTexture, LinearFilter, NoColorSpace, Sprite, SpriteMaterial } from "three";

const TEXTURE_SCALE = 2; // pixels of the texture per pixel of the page
const FONT = "system-ui, sans-serif";
const PADDING = 3; // [px]
const MAX_LABEL_LENGTH = 24; // characters; a longer name is shortened

export interface Style {
  colour?: string;
  size?: number; // [px]
  weight?: number;
}

/** A visible label, and the position of its middle on the page [px]. */
export interface Kept {
  label: Label;
  x: number;
  y: number;
}

/** Shorten a long name to MAX_LABEL_LENGTH characters, of which the last is an ellipsis. */
export function shorten(name: string): string {
  const characters = [...name];
  return characters.length > MAX_LABEL_LENGTH ? `${characters.slice(0, MAX_LABEL_LENGTH - 1).join("")}…` : name;
}

export class Label extends Sprite {
  private readonly across: number; // [px]
  private readonly high: number; // [px]

  constructor(text: string, { colour = "#c3ccd8", size = 11, weight = 400 }: Style = {}) {
    const canvas = document.createElement("canvas");
    const draw = context(canvas);
    draw.font = `${weight} ${size * TEXTURE_SCALE}px ${FONT}`;
    const across = draw.measureText(text).width / TEXTURE_SCALE + 2 * PADDING;
    const high = 1.4 * size + 2;
    canvas.width = Math.ceil(across * TEXTURE_SCALE);
    canvas.height = Math.ceil(high * TEXTURE_SCALE);
    draw.font = `${weight} ${size * TEXTURE_SCALE}px ${FONT}`; // again, because setting the size has reset it
    draw.textBaseline = "middle";
    draw.lineJoin = "round";
    draw.lineWidth = 3 * TEXTURE_SCALE;
    draw.strokeStyle = "rgb(12 15 20 / 0.85)";
    draw.fillStyle = colour;
    draw.strokeText(text, PADDING * TEXTURE_SCALE, canvas.height / 2);
    draw.fillText(text, PADDING * TEXTURE_SCALE, canvas.height / 2);
    const map = new CanvasTexture(canvas);
    map.colorSpace = NoColorSpace;
    map.generateMipmaps = false;
    map.minFilter = LinearFilter;
    super(new SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, toneMapped: false }));
    this.across = across;
    this.high = high;
    this.renderOrder = 9500;
  }

  /** Set the size. perPixel: size of a pixel at distance 1. */
  fit(perPixel: number): void {
    this.scale.set(this.across * perPixel, this.high * perPixel, 1);
  }

  /** Return whether this label does not overlap another whose middle lies at this distance [px]. */
  private clears(other: Label, across: number, along: number): boolean {
    const touches = across < (this.across + other.across) / 2 - PADDING && along < 0.4 * (this.high + other.high);
    return !touches;
  }

  /** Show this label if it overlaps none of `kept`, and add it to them. at: position of its middle on the page [px]. */
  showIfClear(at: { x: number; y: number }, kept: Kept[]): void {
    this.visible = kept.every(({ label, x, y }) => this.clears(label, Math.abs(at.x - x), Math.abs(at.y - y)));
    if (this.visible) kept.push({ label: this, x: at.x, y: at.y });
  }

  override dispose(): void {
    this.material.map?.dispose();
    this.material.dispose();
  }
}

function context(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
  const made = canvas.getContext("2d");
  if (!made) throw new Error("no 2-D canvas");
  return made;
}
