import assert from "node:assert/strict";
import { test } from "node:test";

import { Commands } from "../src/feed/commands";
import type { Arrayed, Output, Refused, State, ToViewer } from "../src/feed/messages";
import { Store } from "../src/feed/store";
import { watchStops, type Alarm } from "../src/panels/stop-alarm";

/** A page whose connection can be open or closed: what it sent, and the alarms that it showed. */
class FakePage {
  open = true;
  readonly sent: ToViewer[] = [];
  readonly unsent: string[] = [];
  readonly alarms: (Alarm | null)[] = [];
  readonly store = new Store(() => undefined);
  readonly commands = new Commands((message) => {
    if (this.open) this.sent.push(message);
    return this.open;
  }, this.store);

  constructor() {
    watchStops(this.store, (alarm) => this.alarms.push(alarm));
    this.store.on("unsent", (action) => this.unsent.push(action));
    this.store.take({ type: "array" } as Arrayed);
  }

  stop(): void {
    this.commands.send({ type: "stop" });
  }

  state(output: Output): void {
    this.store.take({ type: "state", output } as State);
  }

  reconnect(): void {
    this.open = true;
    this.commands.sendWaiting();
  }
}

test("a stop without a connection raises an alarm at once, which says what to do", () => {
  const page = new FakePage();
  page.open = false;
  page.stop();
  assert.deepEqual([page.sent, page.alarms.length], [[], 1]);
  assert.match(page.alarms[0]?.title ?? "", /NOT sent/);
  for (const remedy of ["`pacinian stop`", "switch the array off"]) assert.ok(page.alarms[0]?.text.includes(remedy));
});

test("a stop without a connection is sent once, on the next connection", () => {
  const page = new FakePage();
  page.open = false;
  page.stop();
  page.stop();
  page.commands.sendWaiting();
  page.reconnect();
  assert.deepEqual(page.sent, [{ type: "stop" }]);
  assert.match(page.alarms.at(-1)?.title ?? "", /NOT confirmed/);
  page.state("sounding");
  assert.notEqual(page.alarms.at(-1), null);
  page.state("stopped");
  assert.equal(page.alarms.at(-1), null);
  page.reconnect();
  assert.equal(page.sent.length, 1);
});

test("a stop that got lost in a broken connection is sent again on the next one", () => {
  const page = new FakePage();
  page.stop();
  page.state("sounding");
  page.reconnect();
  assert.equal(page.sent.length, 2);
  page.store.take({ type: "refused", action: "stop", message: "the server has gone", advice: "" } as Refused);
  page.reconnect();
  assert.equal(page.sent.length, 2);
});

test("a stop that takes effect raises no alarm", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const page = new FakePage();
  page.stop();
  page.state("stopped");
  t.mock.timers.tick(60_000);
  assert.deepEqual([page.sent, page.alarms], [[{ type: "stop" }], []]);
});

test("a stop that is not confirmed raises an alarm, until it is", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const page = new FakePage();
  page.stop();
  page.state("sounding");
  t.mock.timers.tick(2900);
  assert.equal(page.alarms.length, 0);
  t.mock.timers.tick(200);
  assert.match(page.alarms[0]?.title ?? "", /NOT confirmed/);
  page.state("stopped");
  assert.equal(page.alarms.at(-1), null);
});

test("a refused stop raises an alarm that stays, even while the output is faulted", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const page = new FakePage();
  page.stop();
  page.store.take({ type: "refused", action: "stop", message: "the server has gone", advice: "" } as Refused);
  page.state("faulted");
  t.mock.timers.tick(60_000);
  assert.equal(page.alarms.length, 1);
  assert.match(page.alarms[0]?.text ?? "", /switch the array off\. the server has gone\.$/i);
});

test("a faulted output stays faulted after a stop, and raises no alarm", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const page = new FakePage();
  page.state("faulted");
  page.stop();
  t.mock.timers.tick(60_000);
  assert.equal(page.alarms.length, 0);
  page.store.linked("lost");
  page.stop();
  t.mock.timers.tick(60_000);
  assert.match(page.alarms[0]?.title ?? "", /NOT confirmed/);
});

test("other commands that are not sent are reported, and are not sent later", () => {
  const page = new FakePage();
  page.open = false;
  page.commands.send({ type: "disarm" });
  page.commands.send({ type: "record", on: false });
  page.commands.send({ type: "alive" });
  page.commands.send({ type: "seen", id: 3 });
  page.reconnect();
  assert.deepEqual([page.unsent, page.sent, page.alarms], [["disarm", "record"], [], []]);
});
