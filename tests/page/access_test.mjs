// Who may look, by keyboard alone, on a phone, and what the policy keeps out.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { afterDrawing, drawn, look, picture, serve, text } from "./browser.mjs";

let server;
before(async () => (server = await serve()));
after(() => server.close());
/// A browser that is closed whatever happens. A 401 is told in the console by the browser itself.
async function with_(options, work) {
  const view = await look({ url: server.url, token: server.tokens.reader, ...options });
  try {
    await work(view.page, view);
    assert.deepEqual(view.faults.filter((one) => !one.includes("401")), []);
  } finally {
    await view.close();
  }
}

test("without a token the page asks for one, and says when it is wrong", () => with_({ token: null }, async (page) => {
  await page.waitForSelector("#token");
  await page.type("#token", "elrom.no.thing");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".fault");
  assert.match(await text(page, ".fault"), /token/);
  await page.type("#token", server.tokens.reader);
  await page.keyboard.press("Enter");
  await drawn(page);
  assert.match(await text(page, ".who"), /reader/);
}));

test("everything can be reached by keyboard, and keys move a slider", () => with_({}, async (page) => {
  await drawn(page);
  const reached = new Set();
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.textContent.trim().slice(0, 20)));
  }
  for (const one of ["load", "input-primary_air", "field", "hold", "compare", "cut-x", "cut-y", "cut-z", "Scenarios"]) assert.ok(reached.has(one), one);
  await page.focus("#input-primary_air");
  const before = await picture(page, ".figure.x .one:not(.reference) canvas");
  const value = await text(page, ".total");
  await afterDrawing(page, () => page.keyboard.press("ArrowRight"));
  assert.notEqual(await text(page, ".total"), value);
  await afterDrawing(page, () => page.keyboard.press("PageUp"));
  assert.notEqual(await picture(page, ".figure.x .one:not(.reference) canvas"), before);
}));

test("every control has a name", () => with_({}, async (page) => {
  await drawn(page);
  const nameless = await page.$$eval("input, select, button, canvas, a", (all) => all.filter((one) => one.checkVisibility() &&
    !(one.getAttribute("aria-label") || one.labels?.length || one.textContent.trim() || one.closest("[role=img]"))).map((one) => one.outerHTML.slice(0, 100)));
  assert.deepEqual(nameless, []);
}));

for (const hash of ["#live", "#scenarios", "#models", "#quarantine"])
  test(`a phone shows ${hash} without sideways scrolling`, () => with_({ width: 390, height: 844, phone: true, hash }, async (page) => {
    if (hash === "#live") await drawn(page);
    else await page.waitForSelector("h1");
    const { content, screen } = await page.evaluate(() => ({ content: document.documentElement.scrollWidth, screen: window.innerWidth }));
    assert.ok(content <= screen, `${content} px of ${screen}`);
  }));

test("dark and light differ", async () => {
  const ground = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  let light;
  await with_({}, async (page) => (light = await ground(page)));
  await with_({ dark: true }, async (page) => assert.notEqual(await ground(page), light));
});

test("no script of a stranger runs, and nothing comes from elsewhere", () => with_({}, async (page, view) => {
  await drawn(page);
  const answer = await fetch(`${server.url}/`);
  assert.match(answer.headers.get("content-security-policy"), /default-src 'none'; script-src 'self';/);
  assert.doesNotMatch(answer.headers.get("content-security-policy"), /unsafe/);
  const ran = await page.evaluate(() => {
    const script = document.createElement("script");
    script.textContent = "window.ran = true";
    document.body.append(script);
    return window.ran === true;
  });
  assert.equal(ran, false);
  assert.match(view.faults.pop(), /Content Security Policy/);
  const hosts = await page.evaluate(() => performance.getEntriesByType("resource").map((one) => new URL(one.name).host));
  assert.deepEqual([...new Set(hosts)], [new URL(server.url).host]);
}));

test("licences of all that is bundled are there", async () => {
  const words = await (await fetch(`${server.url}/licences.txt`)).text();
  for (const name of ["vtk.js", "uplot"]) assert.match(words, new RegExp(name));
});
