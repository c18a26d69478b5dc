/** Why the output is silent, in the words of this page. The server finds the reason: serving/control/explain_silence.py. */

import type { Output } from "../feed/messages";

/** Explanations for recordings, which do not contain those of the server. */
const WHY: Record<Output, string> = {
  silent: "not armed, or nothing can be felt",
  sounding: "something can be felt",
  stale: "the renderer is late: sound returns when it catches up",
  stopped: "stopped by an emergency stop, until reset",
  faulted: "a plug-in or device failed, until reset",
};

/** Explain an output. told: what the server says, if it has said something. */
export function explainSilence(output: Output, told?: string): string {
  return told && output !== "sounding" ? forPage(told) : WHY[output];
}

/** Parts of the server's texts, in the words of this page. tests/viewing/test_page_words.py finds each in its sources. */
const PAGE_WORDS: [string, string][] = [
  ["reset the server", "press Reset"],
  ["reset first", "press Reset first"],
  ["reset, and arm again", "press Reset, then arm again"],
  ["the game must arm the output", "press Arm, or start a program that arms"],
  ["select one above 0", "raise it under Rendering"],
  ["arm with `take`", "press Take over"],
  [
    "renew from the game's own tick, and arm again",
    "keep this page in view, then arm again. If it comes again, the machine is too busy",
  ],
];

/** Replace what a client can do in an advice by the controls of this page. */
export function forPage(text: string): string {
  return PAGE_WORDS.reduce((now, [words, own]) => now.replace(words, own), text).replaceAll("`", "");
}
