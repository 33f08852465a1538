// node run.mjs TEST.mjs BIN PACKAGES: runs a test of the page, or says why it cannot (77).
import { resolve } from "node:path";

const [test, bin, packages] = process.argv.slice(2);
process.env.ELROM_BIN = bin;
process.env.ELROM_PAGE_PACKAGES = packages;
const { lacks } = await import("./browser.mjs");
const missing = lacks();
if (missing) {
  console.log(`skipped: ${missing}`);
  process.exit(77);
}
await import(resolve(test));
