import assert from "node:assert/strict";
import { test } from "node:test";

import { encode } from "@msgpack/msgpack";

import { address, read } from "../src/feed/feed";
import type { Arrayed, Bytes, State } from "../src/feed/messages";
import { floats, indices, into } from "../src/feed/numbers";
import { Store, type Link } from "../src/feed/store";

function packed(...values: number[]): Bytes {
  return new Uint8Array(new Float32Array(values).buffer);
}

test("numbers are read wherever they begin in a message", () => {
  for (let shift = 0; shift < 8; shift++) {
    const message = encode({ pad: "x".repeat(shift), points: packed(1.5, -2, 3e8) });
    const { points } = read(message.slice().buffer) as unknown as { points: Bytes };
    assert.deepEqual([...floats(points)], [1.5, -2, 3e8]);
    const target = new Float32Array(4).fill(9);
    assert.equal(into(target, points), 3);
    assert.deepEqual([...target], [1.5, -2, 3e8, 9]);
  }
});

test("too many numbers, too few, and bytes that are no whole number", () => {
  const target = new Uint16Array(2);
  assert.equal(into(target, new Uint8Array([1, 0, 2, 0, 3, 0])), 2);
  assert.deepEqual([...target], [1, 2]);
  assert.equal(into(target, new Uint8Array([7, 0, 9])), 1);
  assert.deepEqual([...target], [7, 2]);
  assert.equal(into(target, new Uint8Array(0)), 0);
  assert.deepEqual([...indices(new Uint8Array([1, 0, 0, 0, 255]))], [1]);
});

test("the newest is kept, and who wants to know is told", () => {
  const store = new Store();
  const told: number[] = [];
  store.on("state", (state) => told.push(state.sequence));
  store.take({ type: "state", sequence: 1 } as State);
  store.take({ type: "state", sequence: 2 } as State);
  assert.deepEqual(told, [1, 2]);
  assert.equal(store.newest.state?.sequence, 2);
});

test("a lost server comes back with an array; what was shown stays", () => {
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

test("the feed is where the page is, with its token", () => {
  const page = { protocol: "http:", host: "127.0.0.1:8000", search: "?token=a%2Bb" } as Location;
  assert.equal(address(page), "ws://127.0.0.1:8000/feed?token=a%2Bb");
  assert.equal(address({ ...page, protocol: "https:", search: "" }), "wss://127.0.0.1:8000/feed?token=");
});
