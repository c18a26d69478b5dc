import assert from "node:assert/strict";
import { test } from "node:test";

import { encode } from "@msgpack/msgpack";

import { address, read } from "../src/feed/feed";
import type { Arrayed, Bytes, Frame, State } from "../src/feed/messages";
import { floats, indices, into, same } from "../src/feed/numbers";
import { Store, type Link } from "../src/feed/store";

function packed(...values: number[]): Bytes {
  return new Uint8Array(new Float32Array(values).buffer);
}

test("numbers are read at any alignment in a message", () => {
  for (let shift = 0; shift < 8; shift++) {
    const message = encode({ type: "state", pad: "x".repeat(shift), points: packed(1.5, -2, 3e8) });
    const { points } = read(message.slice().buffer) as unknown as { points: Bytes };
    assert.deepEqual([...floats(points)], [1.5, -2, 3e8]);
    const target = new Float32Array(4).fill(9);
    into(target, points);
    assert.deepEqual([...target], [1.5, -2, 3e8, 9]);
  }
});

test("too many numbers, too few, and an incomplete number are accepted", () => {
  const target = new Uint16Array(2);
  into(target, new Uint8Array([1, 0, 2, 0, 3, 0]));
  assert.deepEqual([...target], [1, 2]);
  into(target, new Uint8Array([7, 0, 9]));
  assert.deepEqual([...target], [7, 2]);
  into(target, new Uint8Array(0));
  assert.deepEqual([...target], [7, 2]);
  assert.deepEqual([...indices(new Uint8Array([1, 0, 0, 0, 255]))], [1]);
});

test("fields are the same if all their bytes are", () => {
  const one = { a: packed(1, 2), b: packed(3) };
  const other = { a: packed(1, 2), b: packed(4) };
  const longer = { a: packed(1, 2, 0), b: packed(3) };
  assert.ok(same(one, other, "a"));
  assert.ok(!same(one, other, "a", "b"));
  assert.ok(!same(one, longer, "a"));
  assert.ok(!same(longer, one, "a"));
});

test("an invalid message is logged and ignored", (t) => {
  const told = t.mock.method(console, "error", () => undefined);
  for (const value of [null, 7, "state", [], {}, { type: 3 }]) {
    assert.equal(read(encode(value).slice().buffer), null);
  }
  assert.equal(read(new Uint8Array([0xc1]).buffer), null);
  assert.equal(read(encode({ type: "state" }).slice(0, 4).buffer), null);
  assert.equal(told.mock.callCount(), 8);
});

test("a listener that throws does not keep others from getting the message", (t) => {
  const told = t.mock.method(console, "error", () => undefined);
  const store = new Store();
  let heard = 0;
  store.on("frame", ({ phase }) => phase.length);
  store.on("frame", () => (heard += 1));
  store.take({ type: "frame" } as Frame);
  assert.deepEqual([heard, told.mock.callCount()], [1, 1]);
  store.take({ type: "of a later version" } as unknown as Frame);
});

test("readers get the newest message, once a beat", () => {
  const beats: (() => void)[] = [];
  const store = new Store((read) => beats.push(read));
  const seen: number[] = [];
  store.onBeat("state", ({ sequence }) => seen.push(sequence));
  store.take({ type: "frame" } as Frame);
  assert.equal(beats.length, 0);
  for (const sequence of [1, 2, 3]) store.take({ type: "state", sequence } as State);
  assert.deepEqual([beats.length, seen], [1, []]);
  beats[0]?.();
  assert.deepEqual(seen, [3]);
  store.take({ type: "state", sequence: 4 } as State);
  beats[1]?.();
  assert.deepEqual(seen, [3, 4]);
});

test("listeners get each message, and the newest is kept", () => {
  const store = new Store();
  const told: number[] = [];
  store.on("state", (state) => told.push(state.sequence));
  store.take({ type: "state", sequence: 1 } as State);
  store.take({ type: "state", sequence: 2 } as State);
  assert.deepEqual(told, [1, 2]);
  assert.equal(store.newest.state?.sequence, 2);
});

test("a lost server is back with its next `array`; the last messages are kept until then", () => {
  const store = new Store();
  const links: Link[] = [];
  store.on("link", (link) => links.push(link));
  store.take({ type: "array" } as Arrayed);
  store.take({ type: "state", sequence: 5 } as State);
  store.take({ type: "lost", reason: "it has gone" });
  assert.equal(store.reason, "it has gone");
  assert.equal(store.newest.state?.sequence, 5);
  store.take({ type: "array" } as Arrayed);
  store.linked("closed");
  store.linked("closed");
  assert.deepEqual(links, ["live", "lost", "live", "closed"]);
});

test("if the server is back before a beat, readers get nothing from before the loss", (t) => {
  const failed = t.mock.method(console, "error", () => undefined);
  const beats: (() => void)[] = [];
  const store = new Store((read) => beats.push(read));
  const seen: number[] = [];
  store.onBeat("state", ({ sequence }) => seen.push(sequence));
  store.take({ type: "array" } as Arrayed);
  store.take({ type: "state", sequence: 5 } as State);
  store.take({ type: "lost", reason: "it has gone" });
  store.take({ type: "array" } as Arrayed);
  for (const read of beats) read();
  assert.deepEqual([seen, failed.mock.callCount()], [[], 0]);
  store.take({ type: "state", sequence: 6 } as State);
  beats.at(-1)?.();
  assert.deepEqual(seen, [6]);
});

test("the address of the feed has the host and the token of the page", () => {
  const page = { protocol: "http:", host: "127.0.0.1:8000", search: "?token=a%2Bb" } as Location;
  assert.equal(address(page), "ws://127.0.0.1:8000/feed?token=a%2Bb");
  assert.equal(address({ ...page, protocol: "https:", search: "" }), "wss://127.0.0.1:8000/feed?token=");
});
