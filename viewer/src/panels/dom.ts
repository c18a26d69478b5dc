/** The page's elements, as what they are. */

/** The element of an id. Throws where the page has none of that kind. */
export function get<T extends HTMLElement>(id: string, kind: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`no ${kind.name} #${id}`);
  return found;
}

export const element = (id: string): HTMLElement => get(id, HTMLElement);
export const button = (id: string): HTMLButtonElement => get(id, HTMLButtonElement);
export const input = (id: string): HTMLInputElement => get(id, HTMLInputElement);
export const select = (id: string): HTMLSelectElement => get(id, HTMLSelectElement);

/** Text, only where it is another. */
export function say(target: Element, text: string): void {
  if (target.textContent !== text) target.textContent = text;
}

/** Text in which what stands between backticks is code, only where it is another. */
export function sayMarked(target: Element, text: string): void {
  if (target.textContent === text.replaceAll("`", "")) return;
  target.replaceChildren(...marked(text));
}

/** Texts and elements of code, which stands between backticks. */
export function marked(text: string): (string | Node)[] {
  return text.split("`").map((part, k) => (k % 2 ? made("code", part) : part));
}

/** A new element with text, or with others. */
export function made<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  ...content: (string | Node)[]
): HTMLElementTagNameMap[K] {
  const created = document.createElement(tag);
  created.append(...content);
  return created;
}

/** The choices of a select, only where they are others; the value stays where it can. */
export function choices(target: HTMLSelectElement, names: readonly string[]): void {
  const known = [...target.options].map((option) => option.value);
  if (known.length === names.length && known.every((name, k) => name === names[k])) return;
  const value = target.value;
  target.replaceChildren(...names.map((name) => new Option(name, name)));
  if (names.includes(value)) target.value = value;
}

/** Rows of a table as texts, only those that are others. The first cell is a heading. */
export function rows(target: HTMLElement, texts: readonly (readonly string[])[]): void {
  while (target.children.length > texts.length) target.lastElementChild?.remove();
  texts.forEach((cells, r) => {
    const row = target.children[r] ?? target.appendChild(made("tr"));
    cells.forEach((text, c) => {
      const cell = row.children[c] ?? row.appendChild(made(c ? "td" : "th"));
      if (!c) (cell as HTMLTableCellElement).scope = "row";
      say(cell, text);
    });
  });
}
