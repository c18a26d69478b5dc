/** What must be noticed: the connection is gone; something was refused. */

import type { Refused } from "../feed/messages";
import type { Link, Store } from "../feed/store";
import { element, made, say } from "./dom";

const STAYS = 15_000; // [ms]
const MOST = 4;

export function notices(store: Store): void {
  store.on("refused", refused);
  store.on("link", (link) => gone(link, store.reason, Boolean(store.newest.array)));
  gone(store.link, "", false);
}

function gone(link: Link, reason: string, before: boolean): void {
  const card = element("gone");
  const [title, text] = words(link, reason, before);
  card.hidden = link === "live";
  const [strong, span] = card.children;
  if (strong) say(strong, title);
  if (span) say(span, text);
}

/** before: whether there was a server. */
function words(link: Link, reason: string, before: boolean): [string, string] {
  switch (link) {
    case "live":
      return ["", ""];
    case "connecting":
      return ["Connecting", ""];
    case "lost":
      return [before ? "The server has gone; waiting" : "No server yet; waiting", reason];
    case "closed":
      return ["The viewer has gone; waiting", "Start `pacinian view` again: it opens a page of its own."];
  }
}

function refused({ action, message, advice }: Refused): void {
  const area = element("refused");
  const close = made("button", "Close");
  close.type = "button";
  const note = made("div", made("p", made("strong", `Refused: ${action}`)), made("p", message));
  if (advice) note.append(made("p", advice));
  note.className = "card";
  note.append(close);
  const away = (): void => note.remove();
  close.addEventListener("click", away);
  setTimeout(away, STAYS);
  area.append(note);
  while (area.children.length > MOST) area.firstElementChild?.remove();
}
