/** The page: the feed goes to the store, the store to space and panels, and what the user does goes back. */

import { Boxer } from "./field/boxer";
import { Scale } from "./field/scale";
import { Skinner } from "./field/skinner";
import { Slicer } from "./field/slicer";
import { address, Feed } from "./feed/feed";
import type { ToServer } from "./feed/messages";
import { Store } from "./feed/store";
import { Charts } from "./panels/charts";
import { Demonstrating } from "./panels/demonstrating";
import { Choosing } from "./panels/choosing";
import { element, say } from "./panels/dom";
import { FieldPanel } from "./panels/fielding";
import { drawLegend, scaleBar, scaleSamples } from "./panels/legend";
import { Lists } from "./panels/lists";
import { notices } from "./panels/notices";
import { OutputPanel } from "./panels/output";
import { Replaying } from "./panels/replaying";
import { Skinning } from "./panels/skinning";
import { tell } from "./panels/telling";
import { watchViews } from "./panels/views";
import { shown } from "./shown";
import { listen } from "./space/keys";
import { Pointing } from "./space/pointing";
import { Space } from "./space/space";
import type { View } from "./space/view";

const store = new Store();
const feed = new Feed(address(location), {
  opened: () => store.linked("connecting"),
  message: (message) => store.take(message),
  closed: () => store.linked("closed"),
});
const send = (message: ToServer): void => void feed.send(message);
const slicer = new Slicer(send);
const boxer = new Boxer(send);
const scales = { pressure: new Scale(), error: new Scale() };

/**
 * What is seen is acknowledged, so that the next may come: not while nobody looks, and where the processor draws, only
 * with a frame: there is nothing to be won by more.
 */
function acknowledge(view: View | undefined): void {
  const unseen = new Map<string, number>();
  const seen = (): void => {
    if (document.hidden) return;
    for (const id of unseen.values()) send({ type: "seen", id });
    unseen.clear();
  };
  for (const kind of ["slice", "volume", "skin"] as const) {
    store.on(kind, ({ id }) => {
      unseen.set(kind, id);
      if (!view?.seldom) seen();
    });
  }
  if (view?.seldom) view.onFrame(seen);
  document.addEventListener("visibilitychange", seen);
}

/** All that is seen in space; null where there is no WebGL: the panels do without. */
function makeSpace(): Space | null {
  try {
    return new Space(element("space"), store, slicer, boxer, scales);
  } catch (error) {
    const note = element("no-space");
    note.hidden = false;
    say(note, `This browser draws nothing in 3-D (${String(error)}). The panels work.`);
    return null;
  }
}

drawLegend();
notices(store);
new OutputPanel(store, send);
new Choosing(store, send);
new Lists(store);
new Demonstrating(store, send);
new Replaying(store, send);
const space = makeSpace();
new Charts(store, () => space?.transducers.drive ?? { mean: 0, most: 0 });
if (space) {
  listen(space, slicer);
  watchViews(space);
  const pointing = new Pointing(space, slicer, tell);
  new Skinning(store, new Skinner(send), space);
  new FieldPanel(space, slicer, boxer, scales, store);
  store.onBeat("slice", () => {
    element("bar").hidden = false;
    scaleBar(space.scale.most, space.slice.of, space.law, space.slice.over);
    pointing.tellAgain();
  });
  store.onBeat("state", () => scaleSamples(space.samples.most));
  store.on("array", (array) => {
    if (array.fields && slicer.on) slicer.ask();
    if (array.fields && boxer.on) boxer.ask();
  });
  window.pacinian = shown(store, space, slicer, boxer);
}
acknowledge(space?.view);
feed.open();
