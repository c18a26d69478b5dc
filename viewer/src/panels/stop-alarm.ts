/** The alarm about an emergency stop that was not sent, was refused or is not confirmed: the array may still sound. */

import type { Store } from "../feed/store";
import { button, element, say, sayMarked } from "./dom";
import { sentence } from "./format";

const CONFIRMATION_TIME = 3000; // time for the server to confirm a stop [ms]; the viewer refuses it after 2 s
const REMEDY = "Run `pacinian stop` in a terminal, or switch the array off.";

export interface Alarm {
  title: string;
  text: string;
}

const UNSENT: Alarm = {
  title: "Stop was NOT sent: the array may still sound",
  text: `${REMEDY} This page has no connection to \`pacinian view\`. If that comes back, the page sends the stop at once.`,
};
const UNCONFIRMED: Alarm = {
  title: "Stop is NOT confirmed: the array may still sound",
  text: `${REMEDY} The stop was sent, but the server has not answered yet.`,
};

/** Call `show` with each alarm, and with null when the output has stopped. */
export function watchStops(store: Store, show: (alarm: Alarm | null) => void): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let alarmed = false;
  const change = (alarm: Alarm | null): void => {
    clearTimeout(timer);
    if (alarm || alarmed) show(alarm);
    alarmed = alarm !== null;
  };
  const check = (): void => {
    // a faulted output stays faulted after a stop; the viewer has not refused the stop, so it is confirmed
    const faulted = store.link === "live" && store.newest.state?.output === "faulted";
    change(faulted ? null : UNCONFIRMED);
  };
  store.on("stop", (sent) => {
    clearTimeout(timer);
    if (!sent) change(UNSENT);
    else if (alarmed) change(UNCONFIRMED);
    if (sent) timer = setTimeout(check, CONFIRMATION_TIME);
  });
  store.on("refused", ({ action, message }) => {
    if (action === "stop") change({ title: "NOT stopped: the array may still sound", text: `${REMEDY} ${sentence(message)}` });
  });
  store.on("state", ({ output }) => {
    if (output === "stopped") change(null);
  });
}

/** Show the alarm in the page's head until the output has stopped, or the user closes it. */
export function showStopAlarm(store: Store): void {
  const area = element("stop-alarm");
  button("stop-alarm-close").addEventListener("click", () => {
    area.hidden = true;
  });
  watchStops(store, (alarm) => {
    area.hidden = !alarm;
    say(element("stop-alarm-title"), alarm?.title ?? "");
    sayMarked(element("stop-alarm-text"), alarm?.text ?? "");
  });
}
