/** Builds the page, `node build.mjs [FOLDER]`: one script, one style sheet, and the licences of all packages in them. */

import { copyFile, mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const folder = resolve(process.argv[2] ?? join(here, "../core/pacinian/viewing/page"));

const { metafile } = await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.ts", style: "style/page.css" },
  outdir: folder,
  bundle: true,
  minify: true,
  format: "esm",
  target: ["es2022", "chrome110", "firefox115", "safari16.4"],
  legalComments: "none", // LICENSES.txt contains them in full
  metafile: true,
  logLevel: "warning",
});

/** Returns the packages of which the page contains a part. */
function packages() {
  const found = Object.values(metafile.outputs)
    .flatMap(({ inputs }) => Object.entries(inputs))
    .filter(([, { bytesInOutput }]) => bytesInOutput > 0)
    .map(([path]) => /^node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1])
    .filter(Boolean);
  return [...new Set(found)].sort();
}

/** Returns the licence text that a package contains. Throws if there is none. */
async function licence(name) {
  const root = join(here, "node_modules", name);
  const { version, license } = JSON.parse(await readFile(join(root, "package.json"), "utf8"));
  const file = (await readdir(root)).find((each) => /^licen[cs]e/i.test(each));
  if (!file) throw new Error(`${name} has no licence file`);
  const text = await readFile(join(root, file), "utf8");
  return `${name} ${version} (${license})\n\n${text.trim()}\n`;
}

await mkdir(folder, { recursive: true });
const licences = await Promise.all(packages().map(licence));
const rule = `\n${"-".repeat(80)}\n\n`;
await writeFile(join(folder, "LICENSES.txt"), `The page contains:\n${rule}${licences.join(rule)}`);
for (const file of ["index.html", "icon.svg"]) await copyFile(join(here, file), join(folder, file));
