/** Notices: the connection is lost, the output is faulted, or a request was refused. */

import type { Refused } from "../feed/messages";
import type { Link, Store } from "../feed/store";
import { advice as advise, title } from "./advice";
import { element, made, marked, say, sayMarked } from "./dom";
import { forPage } from "./silence";

const STAYS = 15_000; // time that a notice stays [ms]
const MAX_NOTES = 2;

export function notices(store: Store): void {
  store.on("refused", refused);
  store.on("link", () => warn(store));
  store.onBeat("state", () => warn(store));
  warn(store);
}

function warn(store: Store): void {
  const card = element("gone");
  const { state, silence, array } = store.newest;
  const faulted = store.link === "live" && state?.output === "faulted";
  const why = silence?.text.startsWith("fault") ? silence.text : (state?.faults.at(-1) ?? "");
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

/** Begin a text with a capital letter, and end it with a full stop. */
function sentence(text: string): string {
  return ended(text.charAt(0).toUpperCase() + text.slice(1));
}

/** End a text with a full stop, if it has none. */
function ended(text: string): string {
  return /[.?!]$/.test(text) || !text ? text : `${text}.`;
}

function refused({ action, message, advice }: Refused): void {
  const area = element("refused");
  const close = made("button", "Close");
  close.type = "button";
  const why = made("p", made("strong", title(action)), " ", ...marked(ended(message)), " ", made("span", ...marked(sentence(forPage(advice)) || advise(action, message))));
  const note = made("div", why);
  note.append(close);
  const away = (): void => note.remove();
  close.addEventListener("click", away);
  setTimeout(away, STAYS);
  area.append(note);
  while (area.children.length > MAX_NOTES) area.firstElementChild?.remove();
}
