// node screenshots.mjs BIN PACKAGES STUDY OUT: pictures of the page with a trained study, for the README and to look at.
import { mkdirSync } from "node:fs";
import { join } from "node:path";

const [bin, packages, study, out] = process.argv.slice(2);
process.env.ELROM_BIN = bin;
process.env.ELROM_PAGE_PACKAGES = packages;
const { afterDrawing, drawn, look, serve, sha256 } = await import("./browser.mjs");
mkdirSync(out, { recursive: true });
const server = await serve({ model: study });

/// Scenarios of every kind: inside, outside, done, waiting, failed, stopped.
async function fill() {
  const cases = (await server.call("GET", "/model/cases")).body;
  const inputs = (i) => Object.fromEntries(cases.inputs.map((name, k) => [name, cases.items[i].values[k]]));
  const scenario = (name, i, change = {}) => server.call("POST", "/scenarios", { name, boiler: "Lagisza", load: cases.items[i].load, inputs: { ...inputs(i), ...change } });
  const run = async (id, model, outcome) => {
    await server.call("POST", "/runs", { scenario: id, model });
    if (!outcome) return;
    const claim = (await server.call("POST", "/claims", { model, worker: "machine-2", lease_s: 600 })).body;
    if (outcome !== "running") await server.call("POST", `/runs/${claim.id}/outcome`, { lease: claim.lease, ...outcome });
  };
  const result = { version: "e1b38bc44a24", verdict: "inside", reason: "every input is in its trained range", document: { distance: 0.61 } };
  await scenario("Summer, night load", 0);
  await run(1, "elrom", { state: "done", result });
  await scenario("Full load, wet fuel", 1);
  await run(2, "elrom", { state: "done", result });
  await run(2, "el3d", "running");
  await scenario("Primary air beyond the fan", 2, { "primary_air [kg/s]": 290 });
  await run(3, "elrom", { state: "done", ask: ["el3d"], result: { ...result, verdict: "outside", reason: "primary_air 290 kg/s (trained 142 to 228); a run of el3d is asked for", document: { distance: 3.1 } } });
  const simulated = (await server.call("POST", "/predictions", { inputs: inputs(2) }, { Accept: "application/x-hdf5" })).body;
  await server.call("PUT", `/fields/${sha256(simulated)}`, simulated, { "Content-Type": "application/x-hdf5" });
  const claim = (await server.call("POST", "/claims", { model: "el3d", worker: "cluster", lease_s: 600 })).body;
  await server.call("POST", `/runs/${claim.id}/outcome`, { lease: claim.lease, state: "done", ask: ["elrom-build"], result: { version: "MPPICFoam, OpenFOAM v1912", document: { seconds: 14.2 }, fields: sha256(simulated) } });
  await scenario("Stuck flow meter", 3, { "primary_air [kg/s]": -4 });
  const file = (await server.call("POST", "/predictions", { inputs: inputs(0) }, { Accept: "application/x-hdf5" })).body.slice(0, 400000);
  await server.call("PUT", `/fields/${sha256(file)}`, file, { "Content-Type": "application/x-hdf5" });
}

const slide = (page, selector, value) => page.$eval(selector, (slider, to) => {
  slider.value = to;
  slider.dispatchEvent(new Event("input", { bubbles: true }));
}, value);

async function picture(name, options, work) {
  const view = await look({ url: server.url, token: server.tokens.admin, ...options });
  if (!options.hash) await drawn(view.page);
  else await new Promise((resolve) => setTimeout(resolve, 1200));
  await work?.(view.page);
  await view.page.screenshot({ path: join(out, `${name}.png`), fullPage: Boolean(options.whole) });
  if (view.faults.length) console.log(name, view.faults);
  await view.close();
}

await fill();
await picture("live", {});
await picture("live_dark", { dark: true }, (page) => afterDrawing(page, () => page.select("#field", "gas_velocity_z")));
await picture("outside", {}, (page) => afterDrawing(page, () => slide(page, "#input-primary_air", 999)));
await picture("compare", { height: 1000 }, async (page) => {
  await afterDrawing(page, () => page.select("#field", "gas_velocity_z"));
  await afterDrawing(page, () => slide(page, "#load", 0.45));
  await page.locator("#compare").click();
  await afterDrawing(page, () => slide(page, "#load", 0.95));
  await page.$eval(".notice", (one) => one.remove());
});
await picture("difference", {}, async (page) => {
  await afterDrawing(page, () => page.select("#field", "gas_velocity_z"));
  await page.click("#compare");
  await afterDrawing(page, () => slide(page, "#load", 0.95));
  await afterDrawing(page, () => page.click("#differ"));
  await page.$eval(".notice", (one) => one.remove());
});
await picture("space", {}, async (page) => {
  await page.locator("[data-tab=space]").click();
  await page.waitForSelector(".space-stage canvas");
  await new Promise((resolve) => setTimeout(resolve, 3000));
});
await picture("download", {}, (page) => page.$$eval(".menu summary", (all) => all[1].click()));
await picture("phone", { width: 390, height: 844, phone: true });
await picture("phone_whole", { width: 390, height: 844, phone: true, whole: true });
for (const hash of ["scenarios", "models", "quarantine"]) await picture(hash, { hash: `#${hash}` });
await picture("phone_scenarios", { hash: "#scenarios", width: 390, height: 844, phone: true });
await picture("models_dark", { hash: "#models", dark: true });
server.close();
