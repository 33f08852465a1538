// How the page looks, against pictures kept in looks/: each drawn small, so that another font does not count and a panel that is gone
// does. `KEEP=1 ctest -R page/looks` keeps what is seen now, to be looked at and committed;
// TELL=1 says how much differs.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { drawn, look, serve } from "./browser.mjs";

const kept = join(dirname(fileURLToPath(import.meta.url)), "looks");
const small = 8; // times smaller than the screen
const seen = 20; // of 255, in a small pixel's mean of three colours
let server;
before(async () => (server = await serve()));
after(() => server.close());

/// Small picture of a screenshot, by a browser's own drawing. @return { png, pixels }, width x height x (red, green, blue, 255)
const shrunk = (page, png, times) => page.evaluate(async (data, times) => {
  const image = new Image();
  image.src = `data:image/png;base64,${data}`;
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: image.width / times, height: image.height / times });
  const drawing = canvas.getContext("2d");
  drawing.imageSmoothingQuality = "high";
  drawing.drawImage(image, 0, 0, canvas.width, canvas.height);
  return { png: canvas.toDataURL().split(",")[1], pixels: [...drawing.getImageData(0, 0, canvas.width, canvas.height).data] };
}, Buffer.from(png).toString("base64"), times);

for (const [name, options] of Object.entries({
  live: {}, models: { hash: "#models" },
}))
  test(`${name} looks as it did`, async () => {
    const view = await look({ url: server.url, token: server.tokens.admin, ...options });
    try {
      if (options.hash) await view.page.waitForSelector("tr .link");
      else await drawn(view.page);
      const screen = await view.page.screenshot();
      const other = await view.browser.newPage(); // the page's own policy loads no such picture
      const now = await shrunk(other, screen, small);
      const file = join(kept, `${name}.png`);
      if (process.env.KEEP) {
        mkdirSync(kept, { recursive: true });
        writeFileSync(file, Buffer.from(now.png, "base64"));
      }
      assert.ok(existsSync(file), `${file} is missing: KEEP=1 makes it`);
      const before = await shrunk(other, readFileSync(file), 1);
      assert.equal(now.pixels.length, before.pixels.length, "size of the screen");
      let differing = 0;
      for (let i = 0; i < now.pixels.length; i += 4) {
        const miss = [0, 1, 2].reduce((sum, c) => sum + Math.abs(now.pixels[i + c] - before.pixels[i + c]), 0) / 3;
        differing += miss > seen;
      }
      const share = differing / (now.pixels.length / 4);
      if (process.env.TELL) console.log(`${name}: ${(100 * share).toFixed(2)} % differ`);
      assert.ok(share < 0.07, `${(100 * share).toFixed(1)} % of the picture differs from ${file}`);
    } finally {
      await view.close();
    }
  });
