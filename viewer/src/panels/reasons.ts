/** What the server leaves out: work that is saved, and problems; each with what it means. */

const SAVED: Record<string, string> = {
  "solve, nothing moved": "The last solution still holds.",
  "solve, still under way": "A solve takes longer than a tick, and runs beside the ticks: frames move evenly to its result.",
  "solve, not due": "Frames move evenly to the next solution, some 100 of which a second suffice.",
  "solve, step of a modulation known": "This step of a modulation was solved before.",
  "drive, nothing changed": "The device already plays this frame.",
  "objects away from hands": "No hand is near these objects.",
  "samples merged": "The array cannot tell these places apart.",
  "samples too faint to feel": "Below what skin can feel.",
};

const PROBLEMS: Record<string, string> = {
  "missed ticks": "The machine was too busy for a tick: close other programs.",
  "samples coarsened": "So much is touched that places lie farther apart than the finest: lower the number of objects, or raise the budget.",
  "samples over budget": "More places are touched than can be solved in time: lower the number of objects, or raise the budget.",
  "samples too far from the array": "The array cannot send sound there: bring the object nearer.",
  "samples hardly reached": "Little sound arrives there: bring the object nearer, or turn the hand to the array.",
  "samples on a transducer": "An object touches the array.",
  "forces beyond the most pressure": "More force is asked than `safety.pressure` allows.",
  "hands lost": "The tracker sees no hand.",
  halted: "The renderer was stopped by a fault.",
};

export interface Reason {
  name: string;
  count: number;
  meaning: string;
}

/** Those that count, the most frequent first. */
export function split(skipped: Record<string, number>): { saved: Reason[]; problems: Reason[] } {
  const all = Object.entries(skipped)
    .filter(([, count]) => count > 0)
    .sort((a, b) => b[1] - a[1])
    .map(([name, count]) => ({ name, count, meaning: SAVED[name] ?? PROBLEMS[name] ?? "" }));
  return { saved: all.filter(({ name }) => name in SAVED), problems: all.filter(({ name }) => !(name in SAVED)) };
}
