// The live view: sliders, cuts, verdict, comparison, files; by mouse.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { afterDrawing, drawn, look, picture, serve, text } from "./browser.mjs";

let server, view;
before(async () => {
  server = await serve({ arguments: ["--openfoam-case", fileURLToPath(new URL("../../data/formats/instants/case", import.meta.url))] });
  view = await look({ url: server.url, token: server.tokens.reader });
  await drawn(view.page);
});
after(async () => {
  await view.close();
  server.close();
});
const slide = (selector, share) => view.page.$eval(selector, (slider, to) => {
  slider.value = Number(slider.min) + to * (slider.max - slider.min);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
}, share);
const now = ".figure.x .one:not(.reference) canvas";

test("sliders are grouped by what enters, with trained ranges", async () => {
  assert.deepEqual(await view.page.$$eval(".group summary span:first-child", (all) => all.map((one) => one.innerText)), ["Primary air", "Burners", "Bed and state"]);
  assert.match(await text(view.page, ".group .trained"), /\d.* – \d/);
});

test("a slider moves every picture, and the guard speaks", async () => {
  const places = [now, ".figure.y .one:not(.reference) canvas", ".figure.z .one:not(.reference) canvas", ".profile canvas"];
  const before = await Promise.all(places.map((one) => picture(view.page, one)));

  await afterDrawing(view.page, () => slide("#input-primary_air", 1));

  const later = await Promise.all(places.map((one) => picture(view.page, one)));
  places.forEach((one, i) => assert.notEqual(later[i], before[i], one));
  assert.match(await text(view.page, ".verdict"), /outside/i);
  assert.match(await text(view.page, ".verdict"), /primary air/);
  await afterDrawing(view.page, () => slide("#load", 0.5));
  assert.match(await text(view.page, ".verdict"), /inside/i);
});

test("another field has its own unit and colours", async () => {
  await afterDrawing(view.page, () => view.page.select("#field", "gas_velocity_z"));

  assert.match(await text(view.page, ".readout"), /Gas velocity, up \[m\/s\]/);
  const marks = (await text(view.page, ".ramp-labels")).split(/\s+/).map(Number);
  assert.equal(marks[0], -marks[4]);
});

test("the pointer reads a value with its interval, and a click moves the other cuts", async () => {
  const box = await (await view.page.$(now)).boundingBox();
  await view.page.mouse.move(box.x + 90, box.y + 90);
  assert.match(await text(view.page, ".readout"), /± .* m\/s at x .*, y .*, z .* m/);

  const before = await text(view.page, ".figure.z output");
  await afterDrawing(view.page, () => view.page.mouse.click(box.x + 90, box.y + 90));

  assert.notEqual(await text(view.page, ".figure.z output"), before);
});

test("a cut shows the cells that it goes through", async () => {
  const front = ".figure.y .one:not(.reference) canvas"; // its outline is the same everywhere
  const before = await picture(view.page, front);

  await afterDrawing(view.page, () => slide("#cut-y", 0.95));

  assert.notEqual(await picture(view.page, front), before);
});

test("two operating points stand side by side", async () => {
  await view.page.click("#compare");
  await view.page.waitForSelector(".figure.x .reference:not([hidden])");
  await afterDrawing(view.page, () => slide("#load", 0.9));

  assert.notEqual(await picture(view.page, ".figure.x .reference canvas"), await picture(view.page, now));
  await afterDrawing(view.page, () => view.page.click("#differ"));
  assert.equal(await view.page.$(".figure.x .reference:not([hidden])"), null);
  assert.match(await text(view.page, ".readout"), /now − reference/);
  const differing = await picture(view.page, now);
  await afterDrawing(view.page, () => slide("#load", 0.3));
  assert.notEqual(await picture(view.page, now), differing);
  await view.page.click("#compare");
  await view.page.click("#compare"); // with itself
  const box = await (await view.page.$(now)).boundingBox();
  await view.page.mouse.move(box.x + 90, box.y + 90);
  assert.match(await text(view.page, ".readout"), /^0 m/);
  await view.page.click("#compare");
  assert.equal(await view.page.$eval("#differ", (one) => one.parentElement.hidden), true);
});

test("files of every format that is offered come down", async () => {
  const folder = join(server.folder, "down");
  const client = await view.page.createCDPSession();
  await client.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: folder });
  const names = ["hdf", "csv", "txt", "ip", "openfoam"];
  for (const format of names) {
    await view.page.$eval(`[data-format=${format}]`, (button) => button.click());
    await view.page.waitForFunction(() => document.querySelector(".notice")?.innerText === "The file is here.", { timeout: 60000 });
    await view.page.$eval(".notice", (one) => one.remove());
  }

  for (let i = 0; i < 50 && readdirSync(folder).filter((one) => !one.endsWith(".crdownload")).length < names.length; ++i)
    await new Promise((resolve) => setTimeout(resolve, 100));
  assert.deepEqual(readdirSync(folder).sort(), ["elrom.csv", "elrom.hdf", "elrom.ip", "elrom.tar", "elrom.txt"]);
  assert.match(readFileSync(join(folder, "elrom.csv"), "utf8"), /^plane,column,x \[m\]/);
  assert.match(readFileSync(join(folder, "elrom.tar"), "latin1"), /^0\/U/);
});

test("three dimensions are drawn", async () => {
  await view.page.click("[data-tab=space]");
  await view.page.waitForSelector(".space-stage canvas", { timeout: 60000 });
  const stage = await view.page.$(".space-stage");
  await stage.focus();
  const turned = async () => {
    await view.page.keyboard.press("ArrowLeft");
    await new Promise((resolve) => setTimeout(resolve, 1000));
    return (await stage.screenshot()).toString("base64");
  };

  const first = await turned(); // what focus and the first picture do is over
  assert.notEqual(await turned(), first);
  await view.page.click("[data-tab=cuts]");
});

test("the console stays silent", () => assert.deepEqual(view.faults, []));
