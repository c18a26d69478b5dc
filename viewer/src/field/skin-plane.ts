/** Where the skin is looked at for what is felt on it: a square before a contact, along its normal. */

import { Vector3 } from "three";

import type { Plane, State, ToServer, Triple } from "../feed/messages";
import { floats, indices } from "../feed/numbers";
import { nextId } from "./request-ids";

const CELLS = 64;
const BESIDE = 0.009; // [m] beside the samples
const SMALLEST = 0.024; // [m] side of the square
const STAYS = 0.002; // [m] that the contact may move before the square does
const TURNS = Math.cos(0.1); // of its normal
const OFTEN = 250; // [ms]

export class SkinPlane {
  on = true;
  /** The object whose contact it is. */
  object = "";
  /** The object whose contact is wanted; empty for the one that is asked for most. */
  wanted = "";
  private plane: Plane | undefined;
  private next = 0;

  constructor(private readonly send: (message: ToServer) => void) {}

  show(on: boolean): void {
    this.on = on;
    this.plane = undefined;
    if (!on) this.send({ type: "hide", what: "skin" });
  }

  /** Follow the contact; ask for another square where it has moved. */
  follow(state: State): void {
    const now = performance.now();
    if (!this.on || now < this.next) return;
    this.next = now + OFTEN;
    const found = square(state, this.wanted);
    if (!found) return;
    this.object = found.object;
    if (this.plane && near(this.plane, found.plane)) return;
    this.plane = found.plane;
    this.send({ type: "skin", id: nextId(), ...found.plane });
  }

  /** Look at the contact with that object; empty for the one that is asked for most. */
  choose(object: string): void {
    this.wanted = object;
    this.next = 0;
  }

  /** Ask again, of a server that is back. */
  forget(): void {
    this.plane = undefined;
  }
}

/** What is asked of each object in all, or -1 where it has no region: points and paths. */
export function sumAsked(state: State): number[] {
  const [asked, felt] = [state.asked, state.felt ?? new Uint8Array()].map(floats);
  const sums = state.objects.map((_, i): number => (Number.isFinite(felt?.[4 * i]) ? 0 : -1));
  indices(state.index).forEach((which, k) => {
    if ((sums[which] ?? -1) >= 0) sums[which] = (sums[which] ?? 0) + (asked?.[k] ?? 0);
  });
  return sums;
}

/** Before the contact with that object, if it is felt, or else the one that is asked for most; null without a region. */
export function square(state: State, wanted = ""): { plane: Plane; object: string } | null {
  const [points, normals] = [state.points, state.normals].map(floats);
  const index = indices(state.index);
  if (!points || !normals) return null;
  const sums = sumAsked(state);
  const chosen = state.objects.indexOf(wanted);
  const best = (sums[chosen] ?? 0) > 0 ? chosen : sums.indexOf(Math.max(...sums));
  if (!((sums[best] ?? 0) > 0)) return null;
  const own = [...index.keys()].filter((k) => index[k] === best);
  const at = own.map((k) => new Vector3().fromArray(points, 3 * k));
  const n = own.reduce((sum, k) => sum.add(new Vector3().fromArray(normals, 3 * k)), new Vector3());
  if (n.lengthSq() < 1e-6) n.set(0, 0, 1);
  n.normalize();
  const u = new Vector3(1, 0, 0).addScaledVector(n, -n.x);
  if (u.lengthSq() < 0.05) u.set(0, 1, 0).addScaledVector(n, -n.y);
  u.normalize();
  const v = new Vector3().crossVectors(n, u);
  const [low, high] = [u, v].map((axis) => at.map((p) => p.dot(axis))).reduce<[number[], number[]]>(
    ([lows, highs], along) => [[...lows, Math.min(...along)], [...highs, Math.max(...along)]],
    [[], []],
  );
  const middle = (k: number): number => ((low[k] ?? 0) + (high[k] ?? 0)) / 2;
  const side = Math.max(...[0, 1].map((k) => (high[k] ?? 0) - (low[k] ?? 0) + 2 * BESIDE), SMALLEST);
  const height = at.reduce((sum, p) => sum + p.dot(n), 0) / at.length;
  const centre = new Vector3().addScaledVector(u, middle(0)).addScaledVector(v, middle(1)).addScaledVector(n, height);
  const plane: Plane = {
    centre: centre.toArray() as Triple,
    u: u.toArray() as Triple,
    v: v.toArray() as Triple,
    size: [side, side],
    shape: [CELLS, CELLS],
  };
  return { plane, object: state.objects[best] ?? "" };
}

function near(a: Plane, b: Plane): boolean {
  const away = new Vector3(...a.centre).distanceTo(new Vector3(...b.centre));
  const turned = new Vector3(...a.u).dot(new Vector3(...b.u)) < TURNS || new Vector3(...a.v).dot(new Vector3(...b.v)) < TURNS;
  return away < STAYS && !turned && Math.abs(a.size[0] - b.size[0]) < STAYS;
}
