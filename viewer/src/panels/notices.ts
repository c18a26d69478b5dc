/** Notices: the connection is lost, the output is faulted, or a request was refused or not sent. */

import type { Refused } from "../feed/messages";
import type { Link, Store } from "../feed/store";
import { advice as advise, title } from "./advice";
import { element, made, marked, say, sayMarked } from "./dom";
import { ended, sentence } from "./format";
import { forPage } from "./silence";

const NOTICE_TIME = 15_000; // time that a notice stays [ms]
const MAX_NOTES = 2;

export function notices(store: Store): void {
  store.on("refused", refused); // a refused stop: stop-alarm.ts
  store.on("unsent", unsent);
  store.on("link", () => warn(store));
  store.onBeat("state", () => warn(store));
  warn(store);
}

function warn(store: Store): void {
  const card = element("gone");
  const { state, silence, array } = store.newest;
  const faulted = store.link === "live" && state?.output === "faulted";
  const why = silence?.cause === "fault" ? silence.text : (state?.faults.at(-1) ?? "");
  const fault: [string, string] = ["The output is faulted", ended(forPage(why).replace(/^fault: /, ""))];
  const [title, text] = faulted ? fault : words(store.link, store.reason, Boolean(array));
  card.hidden = store.link === "live" && !faulted;
  const [strong, span] = card.children;
  if (strong) say(strong, title);
  if (span) sayMarked(span, text);
}

/** before: whether there was a server. */
function words(link: Link, reason: string, before: boolean): [string, string] {
  switch (link) {
    case "live":
      return ["", ""];
    case "connecting":
      return ["Connecting …", "to the viewer, and through it to the server"];
    case "lost":
      return before
        ? ["The server has gone; waiting", `${ended(reason)} The last data stay visible in grey until the server is back.`]
        : ["No server yet; waiting", `${ended(reason)} Once \`pacinian serve\` runs, this page goes on by itself.`];
    case "closed":
      return ["The viewer has gone; waiting", "Start `pacinian view` again: it opens a page of its own. The server goes on."];
  }
}

function refused({ action, message, advice }: Refused): void {
  if (action !== "stop") note(title(action), message, sentence(forPage(advice)) || advise(action, message));
}

function unsent(action: string): void {
  note(`Not sent: ${action}`, "This page has no connection to `pacinian view`.", "Try again when it is back.");
}

/** Show a note for a while, in place of an equal one. */
function note(heading: string, message: string, advice: string): void {
  const area = element("refused");
  const close = made("button", "Close");
  close.type = "button";
  const why = made("p", made("strong", heading), " ", ...marked(ended(message)), " ", made("span", ...marked(advice)));
  const added = made("div", why, close);
  for (const shown of [...area.children]) if (shown.textContent === added.textContent) shown.remove();
  const away = (): void => added.remove();
  close.addEventListener("click", away);
  setTimeout(away, NOTICE_TIME);
  area.append(added);
  while (area.children.length > MAX_NOTES) area.firstElementChild?.remove();
}
