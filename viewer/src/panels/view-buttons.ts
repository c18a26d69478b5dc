/** Buttons that set the direction of view, and the help on keys. */

import type { Space } from "../space/space";
import { button, element } from "./dom";

export function watchViews(space: Space): void {
  const { viewport } = space;
  viewport.canvas.setAttribute("role", "application");
  viewport.canvas.setAttribute("aria-label", "3-D view; arrow keys turn it, Page Up and Page Down move the slice");
  for (const each of document.querySelectorAll<HTMLButtonElement>("[data-from]")) {
    each.addEventListener("click", () => {
      const from = each.dataset["from"];
      if (from === "x" || from === "y" || from === "z") viewport.from(from);
      else if (from === "near") space.fit();
      else viewport.all();
    });
  }
  const follow = button("follow");
  follow.addEventListener("click", () => {
    space.follow(follow.getAttribute("aria-pressed") !== "true");
    follow.setAttribute("aria-pressed", String(space.follows));
  });
  const help = button("help");
  help.addEventListener("click", () => {
    const open = help.getAttribute("aria-expanded") !== "true";
    help.setAttribute("aria-expanded", String(open));
    element("keys").hidden = !open;
  });
}
