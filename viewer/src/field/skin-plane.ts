/** Chooses the square for the maps of a contact: perpendicular to the contact's mean normal, around its samples. */

import { Vector3 } from "three";

import type { Plane, State, ToViewer, Triple } from "../feed/messages";
import { floats, indices } from "../feed/numbers";
import { nextId } from "./request-ids";

const CELLS = 64;
const MARGIN = 0.009; // margin around the samples [m]
const MIN_SIDE = 0.024; // shortest side of the square [m]
const MIN_CONTACT_MOVE = 0.002; // distance by which the contact may move before the square does [m]
const MIN_TURN_COSINE = Math.cos(0.1); // cosine of the angle by which a side may turn before the square is requested again
const CHECK_INTERVAL = 250; // shortest time between two checks [ms]

export class SkinPlane {
  shown = true;
  /** The object whose contact the square shows. */
  object = "";
  /** The object that the user chose; empty for the one with the largest sum of targets. */
  wanted = "";
  private plane: Plane | undefined;
  private next = 0;

  constructor(private readonly send: (message: ToViewer) => void) {}

  show(shown: boolean): void {
    this.shown = shown;
    this.plane = undefined;
    if (!shown) this.send({ type: "hide", what: "skin" });
  }

  /** Follow the contact: request another square if it has moved. */
  follow(state: State): void {
    const now = performance.now();
    if (!this.shown || now < this.next) return;
    this.next = now + CHECK_INTERVAL;
    const found = square(state, this.wanted);
    if (!found) return;
    this.object = found.object;
    if (this.plane && near(this.plane, found.plane)) return;
    this.plane = found.plane;
    this.send({ type: "skin", id: nextId(), ...found.plane });
  }

  /** Show the contact with `object`; if it is empty, with the object whose targets have the largest sum. */
  choose(object: string): void {
    this.wanted = object;
    this.next = 0;
  }

  /** Forget the square, so that it is requested again, for example from a server that is back. */
  forget(): void {
    this.plane = undefined;
  }
}

/** Return the sum of the targets of each object; -1 for objects without a region, such as points and paths. */
export function sumAsked(state: State): number[] {
  const [asked, felt] = [state.asked, state.felt ?? new Uint8Array()].map(floats);
  const sums = state.objects.map((_, i): number => (Number.isFinite(felt?.[4 * i]) ? 0 : -1));
  indices(state.index).forEach((which, k) => {
    if ((sums[which] ?? -1) >= 0) sums[which] = (sums[which] ?? 0) + (asked?.[k] ?? 0);
  });
  return sums;
}

/**
 * Return the square at the contact with `wanted` if that object is felt, otherwise with the object whose targets have
 * the largest sum; null if no surface or volume is felt.
 */
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
  const side = Math.max(...[0, 1].map((k) => (high[k] ?? 0) - (low[k] ?? 0) + 2 * MARGIN), MIN_SIDE);
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
  const cosine = Math.min(new Vector3(...a.u).dot(new Vector3(...b.u)), new Vector3(...a.v).dot(new Vector3(...b.v)));
  const turned = cosine < MIN_TURN_COSINE;
  return away < MIN_CONTACT_MOVE && !turned && Math.abs(a.size[0] - b.size[0]) < MIN_CONTACT_MOVE;
}
