// Bundles the page: node build.mjs PACKAGES OUT, where PACKAGES is the folder that npm ci filled. Writes index.html, page.js and its chunks, page.css, and licences.txt with the
// licence of every package whose code is in them.
import { createRequire } from "node:module";
import { copyFileSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [packages, out] = process.argv.slice(2).map((one) => resolve(one));
const modules = join(packages, "node_modules");
const { build } = createRequire(join(modules, "any"))("esbuild");

function packagesOf(metafile) {
  const names = new Set();
  for (const output of Object.values(metafile.outputs))
    for (const input of Object.keys(output.inputs)) {
      const found = /.*node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input);
      if (found && output.inputs[input].bytesInOutput > 0) names.add(found[1]);
    }
  return [...names].sort();
}

function licenceOf(name) {
  const folder = join(modules, name);
  const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  const file = readdirSync(folder).find((one) => /^licen[cs]e/i.test(one));
  const text = file ? readFileSync(join(folder, file), "utf8").trim() : `Licence: ${about.license}; the package brings no text of it.`;
  return `${name} ${about.version} (${about.license})\n${"=".repeat(72)}\n${text}\n`;
}

rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
const { metafile } = await build({
  entryPoints: { page: join(here, "src/main.js") },
  outdir: out,
  bundle: true,
  splitting: true,
  format: "esm",
  target: "es2022",
  minify: true,
  legalComments: "none", // licences.txt has all of them
  metafile: true,
  absWorkingDir: here,
  nodePaths: [modules],
  chunkNames: "[name]-[hash]",
});
for (const file of ["index.html", "icon.svg"]) copyFileSync(join(here, file), join(out, file));
const used = packagesOf(metafile);
writeFileSync(join(out, "licences.txt"), `The page of elrom-serve contains code of these packages.\n\n${used.map(licenceOf).join("\n\n")}`);
