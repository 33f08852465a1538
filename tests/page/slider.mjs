// node slider.mjs BIN PACKAGES MODEL [PRESSES]: how long from a key that moves a slider to the frame that shows the new picture
// (three cuts and the profile), for every field. Prints JSON; ends with 77 where there is no browser or no page.
const [bin, packages, model, presses = "12"] = process.argv.slice(2);
process.env.ELROM_BIN = bin;
process.env.ELROM_PAGE_PACKAGES = packages;
const { afterDrawing, drawn, lacks, look, serve } = await import("./browser.mjs");
const missing = lacks();
if (missing) {
  console.log(JSON.stringify({ skipped: missing }));
  process.exit(77);
}
const server = await serve({ model });
const view = await look({ url: server.url, token: server.tokens.reader });
await drawn(view.page);

// The key's own time stamp, and the task after the frame that came after the drawing.
await view.page.evaluate(() => {
  let pressed = 0;
  addEventListener("keydown", (event) => (pressed = event.timeStamp), { capture: true });
  new PerformanceObserver(() => requestAnimationFrame(() => setTimeout(() => {
    const taken = performance.now() - pressed;
    if (pressed) window.took?.(taken);
    pressed = 0;
  }))).observe({ type: "mark" });
});
const times = [];
const slider = await view.page.$eval(".group .slider", (one) => `#${one.id}`);
for (const field of await view.page.$$eval("#field option", (all) => all.map((one) => one.value))) {
  if (field !== (await view.page.$eval("#field", (one) => one.value))) await afterDrawing(view.page, () => view.page.select("#field", field));
  await view.page.focus(slider);
  for (let i = 0; i < Number(presses); ++i) {
    const taken = view.page.evaluate(() => new Promise((resolve) => (window.took = resolve)));
    await view.page.keyboard.press(i % 2 ? "ArrowLeft" : "ArrowRight");
    if (i > 1) times.push(await taken);
    else await taken;
  }
}
await view.close();
server.close();
times.sort((a, b) => a - b);
console.log(JSON.stringify({ n: times.length, median_ms: times[Math.floor(times.length / 2)], p95_ms: times[Math.floor(0.95 * times.length)], faults: view.faults }));
