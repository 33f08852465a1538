// Scenarios, runs, versions and quarantine, as people see them.
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { drawn, look, serve, sha256, text } from "./browser.mjs";

let server, inputs;
const views = [];
before(async () => {
  server = await serve();
  const model = (await server.call("GET", "/model")).body;
  inputs = Object.fromEntries(model.inputs.map((one) => [`${one.name} [${one.unit}]`, (one.low + one.high) / 2]));
});
after(async () => {
  await Promise.all(views.map((view) => view.close()));
  server.close();
});
async function see(hash, role = "admin") {
  const view = await look({ url: server.url, token: server.tokens[role], hash });
  views.push(view);
  return view;
}
const has = (page, selector, words) =>
  page.waitForFunction((where, what) => document.querySelector(where)?.innerText.includes(what), { timeout: 15000 }, selector, words);

test("an empty list says what to do", async () => {
  const { page } = await see("#scenarios");
  await has(page, ".list", "No scenario yet");
  await page.goto(`${server.url}/#quarantine`);
  await has(page, ".cards", "Nothing was stopped");
});

test("an operating point is saved, run, and opened again", async () => {
  const { page, faults } = await see("#live");
  await drawn(page);
  assert.ok(await page.$eval("[data-format=openfoam]", (button) => button.disabled)); // no case to start was given
  await page.locator(".menu summary").click();
  await page.type("#scenario-name", "Night load");
  await page.locator(".menu form button").click();
  await has(page, ".notice", "is saved");
  await page.locator("nav a[href='#scenarios']").click();
  await has(page, ".list", "Night load");
  await page.evaluate(() => [...document.querySelectorAll(".actions button")].find((one) => one.innerText === "Run ELROM").click());
  await has(page, ".detail", "waiting");

  const claim = (await server.call("POST", "/claims", { model: "elrom", worker: "w1", lease_s: 60 })).body;
  await has(page, ".detail", "worked on by w1");
  const file = (await server.call("POST", "/predictions", { inputs, fields: ["gas_velocity_x"] }, { Accept: "application/x-hdf5" })).body;
  assert.equal((await server.call("PUT", `/fields/${sha256(file)}`, file, { "Content-Type": "application/x-hdf5" })).status, 201);
  await server.call("POST", `/runs/${claim.id}/outcome`, { lease: claim.lease, state: "done", ask: ["el3d"],
    result: { version: "abc", verdict: "outside", reason: "too much air", document: { distance: 0.4 }, fields: sha256(file) } });
  await has(page, ".detail", "distance");
  assert.match(await text(page, ".chain"), /ELROM\s+done\s+outside[\s\S]*distance 0.400[\s\S]*too much air/);
  assert.match(await text(page, ".chain li li"), /EL3D\s+waiting/); // asked by the other, so to its right
  await page.waitForSelector(".chain figure:not([hidden]) canvas");
  assert.ok(await page.$eval(".chain canvas", (one) => one.getContext("2d").getImageData(0, 0, one.width, one.height).data.some((byte) => byte > 0)));
  assert.match(await text(page, ".models"), /ELROM\s+1 done[\s\S]*EL3D\s+1 waiting/);
  await page.locator(".detail .primary").click();
  await drawn(page);
  assert.deepEqual(faults, []);
});

test("an out-of-range load is marked", async () => {
  const first = Object.keys(inputs)[0];
  await server.call("POST", "/scenarios", { name: "Overload", load: 1.4, inputs: { ...inputs, [first]: 3 * inputs[first] } });
  const { page } = await see("#scenarios");
  await has(page, ".list .chosen", "outside");
  await has(page, ".detail", "primary air");
});

test("a wrong sensor and a corrupt field are stopped, with the reason", async () => {
  const first = Object.keys(inputs)[0];
  assert.equal((await server.call("POST", "/scenarios", { name: "Stuck sensor", inputs: { ...inputs, [first]: -5 } })).status, 422);
  const file = (await server.call("POST", "/predictions", { inputs }, { Accept: "application/x-hdf5" })).body;
  const broken = file.slice(0, file.length / 2);
  assert.equal((await server.call("PUT", `/fields/${sha256(broken)}`, broken, { "Content-Type": "application/x-hdf5" })).status, 422);

  const { page, faults } = await see("#quarantine", "reader");

  await has(page, ".cards", "Boundary conditions");
  const words = await text(page, ".cards");
  assert.match(words, /primary_air/);
  assert.match(words, /File of fields/);
  assert.equal((await page.$$(".card")).length, 2);
  assert.deepEqual(faults, []);
});

test("a reader sees versions and may not promote", async () => {
  const { page, faults } = await see("#models", "reader");
  await has(page, ".list", "Version 2");
  assert.match(await text(page, ".list"), /kept back/);
  await page.evaluate(() => [...document.querySelectorAll(".list button")].find((one) => one.innerText === "Version 2").click());
  await has(page, ".detail", "needs a token with the role admin");
  assert.match(await text(page, ".detail"), /What the gate said[\s\S]*worse/);
  assert.deepEqual(faults, []);
});

test("a report opens with its own scripts, which reach nothing", async () => {
  const digest = (await server.call("GET", "/model")).body.digest;
  mkdirSync(join(server.folder, "data/reports"), { recursive: true });
  writeFileSync(join(server.folder, `data/reports/${digest}.html`), `<!doctype html><title>quiet</title><p>no script ran</p>
    <button onclick="document.title = 'a handler ran'">-</button><script>document.querySelector("p").textContent = "its script ran";</script>`);
  const { page, browser, faults } = await see("#models", "reader");
  await has(page, ".detail", "Version 1");
  await page.locator("#report").click();
  const report = await (await browser.waitForTarget((one) => one.url().includes("/reports/"), { timeout: 15000 })).page();

  await has(report, "p", "its script ran");
  await report.click("button");
  assert.equal(await report.title(), "quiet");
  assert.equal(await report.evaluate(() => self.origin), "null");
  assert.deepEqual(await report.evaluate(async () => {
    const tries = [() => sessionStorage.length, () => fetch("/healthz"), () => new Worker("/page.js"), () => opener.document];
    const told = [];
    for (const one of tries) told.push(await Promise.resolve().then(one).then(() => "reached", () => "kept out"));
    return told;
  }), ["kept out", "kept out", "kept out", "kept out"]);
  assert.deepEqual(faults, []);
});

test("an administrator promotes, and every live view has the new model", async () => {
  const other = (await see("#live", "reader")).page;
  await drawn(other);
  const { page } = await see("#models");
  await has(page, ".list", "Version 2");
  page.on("dialog", (dialog) => dialog.accept());
  await page.evaluate(() => [...document.querySelectorAll(".list button")].find((one) => one.innerText === "Version 2").click());
  await page.waitForSelector("#promote");
  await page.locator("#promote").click();
  await has(page, ".notice", "Version 2 answers now");
  await page.locator("nav a[href='#live']").click();
  await drawn(page);
  assert.notEqual(await page.$("#input-flow_0"), null);
  await other.focus("#load");
  await other.keyboard.press("ArrowRight");
  await other.waitForSelector("#input-flow_0");
  await has(other, ".notice", "Another model answers");
});
