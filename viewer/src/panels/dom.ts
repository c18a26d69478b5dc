/** Access to the page's elements, with their types. */

/** Return the element with an id. Throws if the page has none of this type. */
export function get<T extends HTMLElement>(id: string, kind: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`no ${kind.name} #${id}`);
  return found;
}

export const element = (id: string): HTMLElement => get(id, HTMLElement);
export const button = (id: string): HTMLButtonElement => get(id, HTMLButtonElement);
export const input = (id: string): HTMLInputElement => get(id, HTMLInputElement);
export const select = (id: string): HTMLSelectElement => get(id, HTMLSelectElement);

/** Set a text if it differs. */
export function say(target: Element, text: string): void {
  if (target.textContent !== text) target.textContent = text;
}

/** Set a text if it differs; parts between backticks become code. */
export function sayMarked(target: Element, text: string): void {
  if (target.textContent === text.replaceAll("`", "")) return;
  target.replaceChildren(...marked(text));
}

/** Split a text at backticks into texts and code elements. */
export function marked(text: string): (string | Node)[] {
  return text.split("`").map((part, k) => (k % 2 ? made("code", part) : part));
}

/** Make an element with texts or other elements in it. */
export function made<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  ...content: (string | Node)[]
): HTMLElementTagNameMap[K] {
  const created = document.createElement(tag);
  created.append(...content);
  return created;
}

/** Set the choices of a select if they differ. Keeps the value if it is still a choice. */
export function choices(target: HTMLSelectElement, names: readonly string[]): void {
  const known = [...target.options].map((option) => option.value);
  if (known.length === names.length && known.every((name, k) => name === names[k])) return;
  const value = target.value;
  target.replaceChildren(...names.map((name) => new Option(name, name)));
  if (names.includes(value)) target.value = value;
}

/** Set the texts of a table's rows where they differ. The first cell of each row is a heading. */
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
