// The page: which view is open, and who looks at it.
import "uplot/dist/uPlot.min.css";
import "./page.css";
import * as api from "./api.js";
import { h, notice } from "./dom.js";
import { LiveView } from "./live.js";
import { ModelsView } from "./models.js";
import { QuarantineView } from "./quarantine.js";
import { ScenariosView } from "./scenarios.js";

const views = { live: ["Live", LiveView], scenarios: ["Scenarios", ScenariosView], models: ["Models", ModelsView], quarantine: ["Quarantine", QuarantineView] };
const roles = ["reader", "model", "admin"];
const main = document.getElementById("view");

const shared = {
  caller: null, ///< { name, role }
  point: null, ///< operating point of the live view, while others are open
  may: (role) => shared.caller !== null && roles.indexOf(shared.caller.role) >= roles.indexOf(role),
  signIn: () => showSignIn(),
  /// Another model answers.
  renew() {
    notice("Another model answers now.");
    show();
  },
  openPoint(scenario) {
    shared.point = { inputs: scenario.inputs, load: scenario.load };
    location.hash = "#live";
  },
};

let open = null, turn = 0;

function showTop(name) {
  const who = shared.caller
    ? h("button", { type: "button", class: "who", onclick: () => showSignIn(), title: "Change token" }, shared.caller.name, h("span", { class: "chip none" }, shared.caller.role))
    : h("button", { type: "button", class: "who", onclick: () => showSignIn() }, "Sign in");
  document.getElementById("top").replaceChildren(h("a", { class: "brand", href: "#live" }, h("img", { src: "/icon.svg", alt: "", width: 26, height: 26 }), "ELROM"),
    h("nav", { "aria-label": "Views" }, Object.entries(views).map(([key, [title]]) => h("a", { href: `#${key}`, "aria-current": key === name ? "page" : null }, title))), who);
}

function showSignIn(fault) {
  open?.close();
  open = null;
  ++turn;
  const field = h("input", { id: "token", type: "password", autocomplete: "off", required: true, placeholder: "elrom.…" });
  const form = h("form", { class: "panel sign-in", onsubmit: async (event) => {
    event.preventDefault();
    api.setToken(field.value.trim());
    await start();
  } }, h("h1", {}, "Sign in"), h("p", {}, "The server asks for a token. Who runs it makes one with"),
    h("pre", {}, "elrom-serve --data DIR --make-token NAME=reader"), h("label", { for: "token" }, "Token"), field,
    fault && h("p", { class: "fault", role: "alert" }, fault),
    h("div", { class: "actions" }, h("button", { type: "submit", class: "primary" }, "Sign in"),
      api.hasToken() && h("button", { type: "button", onclick: async () => {
        api.setToken(null);
        await start();
      } }, "Sign out")));
  showTop(null);
  main.replaceChildren(form);
  field.focus();
}

async function show() {
  const name = views[location.hash.slice(1)] ? location.hash.slice(1) : "live";
  const mine = ++turn;
  open?.close();
  open = null;
  showTop(name);
  document.title = `${views[name][0]} – ELROM`;
  main.replaceChildren(h("p", { class: "empty", role: "status" }, "Loading …"));
  try {
    const view = await views[name][1].open(shared);
    if (mine !== turn) return view.close();
    open = view;
    main.replaceChildren(view.element, footer());
  } catch (error) {
    if (mine !== turn) return;
    if (error.problem?.status === 401) return showSignIn();
    main.replaceChildren(faultPage(error));
  }
}

function faultPage(error) {
  if (!error.problem) console.error(error);
  const advice = error.problem?.advice;
  return h("section", { class: "panel fault-page", role: "alert" }, h("h1", {}, error.problem?.status === 404 ? "There is no model yet" : "This did not work"),
    h("p", {}, error.message), advice && h("p", { class: "muted" }, advice), h("button", { type: "button", class: "primary", onclick: show }, "Try again"));
}

const footer = () => h("footer", {}, h("a", { href: "/openapi.json" }, "Requests (OpenAPI)"), h("a", { href: "/licences.txt" }, "Licences"));

async function start() {
  try {
    shared.caller = await api.get("/caller");
  } catch (error) {
    shared.caller = null;
    if (error.problem?.status === 401) return showSignIn(api.hasToken() ? error.message : undefined);
  }
  await show();
}

window.addEventListener("hashchange", show);
start();
