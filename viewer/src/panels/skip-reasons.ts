/**
 * The reasons why the server leaves work out: saved work and problems, each with its meaning. Keep them equal to
 * docs/skipped.md and to pacinian/skip_reasons.py.
 */

const SAVED: Record<string, string> = {
  "solve, nothing moved": "The last solution still holds.",
  "solve, still under way": "A solve takes longer than a tick, and runs in the background: frames move evenly to its result.",
  "solve, not due": "About 100 solutions a second are enough, and 20 for a scene at rest.",
  "solve, step of a modulation known": "This step of a modulation was solved before.",
  "drive, nothing changed": "The device already plays this frame.",
  "objects away from hands": "No hand is near these objects.",
  "samples merged": "The array cannot tell these places apart.",
  "samples too faint to feel": "Below what skin can feel.",
};

const PROBLEMS: Record<string, string> = {
  "missed ticks": "The machine was too busy for a tick: close other programs.",
  "samples coarsened": "So much skin is touched that samples lie farther apart than at the finest spacing: use fewer objects, or raise the budget.",
  "samples over budget": "More places are touched than can be solved in time: use fewer objects, or raise the budget.",
  "objects outside the workspace": "They are not rendered: move what should be felt, or widen the workspace.",
  "samples too far from the array": "The array cannot send sound there: bring the object nearer.",
  "samples hardly reached": "Little sound arrives there: bring the object nearer, or turn the hand to the array.",
  "samples on a transducer": "An object touches the array.",
  "forces above the pressure limit": "More force is asked than `safety.pressure` allows.",
  "hands lost": "The tracker sees no hand.",
  halted: "The renderer was stopped by a fault.",
  "measurements failed": "A measurement of the output has failed, for example in a user's function. The output goes on.",
};

export interface Reason {
  name: string;
  count: number;
  meaning: string;
}

/** Split the reasons with a count above 0 into saved work and problems, most frequent first. */
export function split(skipped: Record<string, number>): { saved: Reason[]; problems: Reason[] } {
  const all = Object.entries(skipped)
    .filter(([, count]) => count > 0)
    .sort((a, b) => b[1] - a[1])
    .map(([name, count]) => ({ name, count, meaning: SAVED[name] ?? PROBLEMS[name] ?? "" }));
  return { saved: all.filter(({ name }) => name in SAVED), problems: all.filter(({ name }) => !(name in SAVED)) };
}
