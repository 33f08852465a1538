// A server with a small study and tokens of each role, and Chromium looking at its page.
import { execFileSync, spawn } from "node:child_process";
import { createHash } from "node:crypto";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

export const bin = resolve(process.env.ELROM_BIN ?? ".");
const packages = resolve(process.env.ELROM_PAGE_PACKAGES ?? ".");
export const chromium = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);

/// What is missing for a browser to look at the page; nothing: all is there.
export function lacks() {
  if (!existsSync(join(bin, "../page/index.html"))) return "the page was not built (ELROM_PAGE)";
  if (!chromium) return "no Chromium (package chromium, or CHROMIUM=PATH)";
  return null;
}

/// Two versions: the first answers, the second was kept back by the gate.
export function makeStudy(folder, bundles) {
  mkdirSync(join(folder, "models"), { recursive: true });
  bundles.forEach((bundle, i) => copyFileSync(bundle, join(folder, "models", `${i + 1}.elrom`)));
  symlinkSync("1.elrom", join(folder, "models/current"));
  symlinkSync("models/current", join(folder, "model.elrom"));
  const field = { field: "pressure", before: 0.11, after: 0.2, scatter: 0.01, verdict: "worse" };
  const verdict = { judged_on: "held-out cases", scatter_from: "cases", cases: ["load_064"], before: 0.63, after: 0.7, scatter: 0.01, passed: false,
    missing: [], verdict: "worse", fields: [field] };
  const event = (number, more) => ({ number, parent: number > 1 ? 1 : null, by: "run", promoted: true, digest: String(number).repeat(64), cases: 12, verdict: null, ...more });
  const events = [event(1, {}), event(2, { by: "retrain", promoted: false, date: "2026-01-02", verdict })].slice(0, bundles.length);
  writeFileSync(join(folder, "models/log.json"), JSON.stringify({ kind: "elrom-versions", format: [1, 0], program: "test", events }));
}

async function listening(server) {
  for await (const chunk of server.stdout) {
    const found = /listening at (\S+)/.exec(chunk);
    if (found) return found[1];
  }
  throw new Error("elrom-serve does not start");
}

/// @param model bundle or study; nothing: a small study made here
export async function serve({ model, arguments: more = [] } = {}) {
  const folder = mkdtempSync(join(tmpdir(), "elrom-page-"));
  const data = join(folder, "data");
  let study = model;
  if (!study) {
    execFileSync(join(bin, "../tests/make-sample-bundle"), [folder]);
    study = join(folder, "study");
    makeStudy(study, [join(folder, "furnace.elrom"), join(folder, "model.elrom")]);
  }
  const program = join(bin, "elrom-serve");
  const tokens = Object.fromEntries(["reader", "model", "admin"].map((role) =>
    [role, execFileSync(program, ["--data", data, "--make-token", `${role}=${role}`]).toString().trim()]));
  const server = spawn(program, ["--data", data, "--model", study, "--port", "0", "--quiet", "--requests-per-second", "100000", ...more],
    { stdio: ["ignore", "pipe", "inherit"] });
  const url = await listening(server);
  return {
    url, tokens, folder,
    /// As the admin. @return { status, body }
    async call(method, path, body, headers = {}) {
      const response = await fetch(url + path, { method, body: typeof body === "object" && !(body instanceof Uint8Array) ? JSON.stringify(body) : body,
        headers: { Authorization: `Bearer ${tokens.admin}`, "Content-Type": "application/json", "Idempotency-Key": `${Math.random()}`, ...headers } });
      const bytes = new Uint8Array(await response.arrayBuffer());
      const json = (response.headers.get("content-type") ?? "").includes("json");
      return { status: response.status, body: json ? JSON.parse(new TextDecoder().decode(bytes)) : bytes };
    },
    close() {
      server.kill("SIGTERM");
      rmSync(folder, { recursive: true, force: true });
    },
  };
}

export const sha256 = (bytes) => createHash("sha256").update(bytes).digest("hex");

/// @param token of the browser's tab; nothing: none yet
export async function look({ url, token, width = 1280, height = 860, dark = false, phone = false, hash = "" }) {
  const puppeteer = createRequire(join(packages, "node_modules/any"))("puppeteer-core");
  const browser = await puppeteer.launch({ executablePath: chromium, headless: true,
    args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"] });
  const page = await browser.newPage();
  const faults = [];
  page.on("console", (message) => ["error", "warn"].includes(message.type()) && faults.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => faults.push(`exception: ${error.message}`));
  page.on("requestfailed", (request) => faults.push(`no answer: ${request.url()}`));
  await page.setViewport({ width, height, deviceScaleFactor: phone ? 2 : 1, isMobile: phone, hasTouch: phone });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: dark ? "dark" : "light" }]);
  if (token) await page.evaluateOnNewDocument((one) => sessionStorage.setItem("elrom-token", one), token);
  await page.goto(`${url}/${hash}`);
  return { browser, page, faults, close: () => browser.close() };
}

/// The live view with its picture.
export async function drawn(page) {
  await page.waitForFunction(() => performance.getEntriesByName("drawn").length > 0, { timeout: 30000 });
}
/// What `change` leads to is on the screen.
export async function afterDrawing(page, change) {
  await page.evaluate(() => performance.clearMarks("drawn"));
  await change();
  await drawn(page);
}
export const text = (page, selector) => page.$eval(selector, (element) => element.innerText);
/// Differs with any pixel.
export const picture = async (page, selector) =>
  createHash("sha256").update(await page.$eval(selector, (canvas) => canvas.toDataURL())).digest("hex");
