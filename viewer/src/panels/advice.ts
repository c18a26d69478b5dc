/** Advice: on a refusal, if the server gives none; and why nothing can be changed yet. */

import type { State } from "../feed/messages";
import type { Link } from "../feed/store";

/** Parts of messages without advice. tests/viewing/test_page_words.py finds each in the sources of server and viewer. */
const BY_MESSAGE: [string, string][] = [
  ["owns the output", "Take over first, or change it in the program that owns the output."],
  ["has taken the output", "To have it back, take over again."],
  ["is for a server", "Start `pacinian view` without a file to watch a server."],
  ["is for recordings", "Start `pacinian view FILE` to go through a recording."],
  ["too much is asked", "Wait a moment, then try again."],
  ["emergency stop", "Press Reset, then arm again."],
  ["cannot be computed", "Close other programs, or start `pacinian view` again."],
];

const BY_ACTION: Record<string, string> = {
  arm: "Look under Clients who owns the output, and under Faults what went wrong.",
  demonstrate: "Let the program that owns the output end first, or press Reset.",
  select: "Choose another one; Faults may say more.",
  record: "Start `pacinian view` in a folder in which you may write.",
  slice: "Choose a smaller slice, or fewer values.",
  volume: "Choose a smaller box.",
  message: "Reload this page. If it comes again, page and viewer are of different versions: start `pacinian view` again.",
};

export function advice(action: string, message: string): string {
  const found = BY_MESSAGE.find(([part]) => message.includes(part));
  return found?.[1] ?? BY_ACTION[action] ?? "Try again; if it is refused again, see Faults.";
}

const TITLES: Record<string, string> = {
  arm: "Not armed",
  demonstrate: "The demonstration does not play",
  select: "Not changed",
  record: "Not recorded",
};

export function title(action: string): string {
  return TITLES[action] ?? `Refused: ${action}`;
}

/** Return why nothing can be changed on the server; "" if something can. */
export function whyUnavailable(link: Link, state: State | undefined): string {
  if (link === "lost") return "There is no server.";
  if (link === "closed") return "The viewer has gone.";
  return link === "live" && state ? "" : "Connecting …";
}
