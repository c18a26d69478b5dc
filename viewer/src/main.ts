/** The page: passes messages from the feed through the store to space and panels, and the user's actions back. */

import { SurfaceBox } from "./field/surface-box";
import { AutoScale } from "./field/auto-scale";
import { SkinPlane } from "./field/skin-plane";
import { SlicePlane } from "./field/slice-plane";
import { Commands } from "./feed/commands";
import { address, Feed } from "./feed/feed";
import type { ToViewer } from "./feed/messages";
import { Store } from "./feed/store";
import { Charts } from "./panels/charts";
import { DemonstrationPanel } from "./panels/demonstration";
import { ServerChoices } from "./panels/server-choices";
import { element, say } from "./panels/dom";
import { FieldPanel } from "./panels/field";
import { drawLegend, scaleBar, scaleSamples } from "./panels/legend";
import { Lists } from "./panels/lists";
import { notices } from "./panels/notices";
import { OutputPanel } from "./panels/output";
import { RecordingPanel } from "./panels/recording";
import { showStopAlarm } from "./panels/stop-alarm";
import { ContactMaps } from "./panels/contact-maps";
import { showHoverValue } from "./panels/hover-value";
import { watchViews } from "./panels/view-buttons";
import { shown } from "./page-state";
import { listen } from "./space/keys";
import { Pointer } from "./space/pointer";
import { Space } from "./space/space";
import type { Viewport } from "./space/viewport";

const store = new Store();
const feed = new Feed(address(location), {
  opened: () => {
    commands.sendWaiting();
    store.linked("connecting");
  },
  message: (message) => store.take(message),
  closed: () => store.linked("closed"),
});
const commands = new Commands((message) => feed.send(message), store);
const send = (message: ToViewer): void => commands.send(message);
const slicePlane = new SlicePlane(send);
const surfaceBox = new SurfaceBox(send);
const scales = { pressure: new AutoScale(), error: new AutoScale() };

/**
 * Acknowledge slices, volumes and skin maps that are shown, so that the viewer sends the next ones. A hidden page
 * acknowledges nothing. With software rendering, the page acknowledges only with a frame, because it shows no more.
 */
function acknowledge(viewport: Viewport | undefined): void {
  const unseen = new Map<string, number>();
  const seen = (): void => {
    if (document.hidden) return;
    for (const id of unseen.values()) send({ type: "seen", id });
    unseen.clear();
  };
  for (const kind of ["slice", "volume", "skin"] as const) {
    store.on(kind, ({ id }) => {
      unseen.set(kind, id);
      if (!viewport?.seldom) seen();
    });
  }
  if (viewport?.seldom) viewport.onFrame(seen);
  document.addEventListener("visibilitychange", seen);
}

/** Make the 3-D view. Return null without WebGL; the panels work without it. */
function makeSpace(): Space | null {
  try {
    return new Space(element("space"), store, slicePlane, surfaceBox, scales);
  } catch (error) {
    const note = element("no-space");
    note.hidden = false;
    say(note, `This browser draws nothing in 3-D (${String(error)}). The panels work.`);
    return null;
  }
}

drawLegend();
showStopAlarm(store);
notices(store);
new OutputPanel(store, send);
new ServerChoices(store, send);
new Lists(store);
new DemonstrationPanel(store, send);
new RecordingPanel(store, send);
const space = makeSpace();
new Charts(store, () => space?.transducers.drive ?? { mean: 0, most: 0 });
if (space) {
  listen(space, slicePlane);
  watchViews(space);
  const pointing = new Pointer(space, slicePlane, showHoverValue);
  new ContactMaps(store, new SkinPlane(send), space);
  new FieldPanel(space, slicePlane, surfaceBox, scales, store);
  const showScale = (): void => scaleBar(space.scale.most, space.slice.quantity, space.law, space.slice.average);
  space.onScale(showScale); // also while no slices come, because the field does not change
  store.onBeat("slice", () => {
    element("bar").hidden = false;
    showScale();
    pointing.tellAgain();
  });
  store.onBeat("state", () => scaleSamples(space.samples.most));
  store.on("array", (array) => {
    if (array.fields && slicePlane.shown) slicePlane.ask();
    if (array.fields && surfaceBox.shown) surfaceBox.ask();
  });
  window.pacinian = shown(store, space, slicePlane, surfaceBox);
}
acknowledge(space?.viewport);
feed.open();
