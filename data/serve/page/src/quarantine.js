// What was sent and is wrong: it reached no model, and people may look at it here.
import * as api from "./api.js";
import { chip, h } from "./dom.js";
import { time } from "./words.js";

export class QuarantineView {
  static async open() {
    const view = new QuarantineView();
    view.show(await api.list("/quarantine"), (await api.list("/runs?state=quarantined")));
    return view;
  }

  constructor() {
    this.list = h("div", { class: "cards" });
    this.element = h("div", { class: "page" }, h("h1", {}, "Quarantine"),
      h("p", { class: "lead" }, "Data that no furnace can have, and files that no model can have made. Each was stopped at the door, with the reason; no model saw it."),
      this.list);
  }

  close() {}

  show(items, runs) {
    const cards = [...items.map(card), ...runs.map(runCard)];
    this.list.replaceChildren(...(cards.length ? cards : [h("p", { class: "empty" }, "Nothing was stopped. Wrong sensors, impossible loads and broken files of fields will be listed here.")]));
  }
}

const kinds = { scenario: "Boundary conditions", fields: "File of fields", result: "Result" };

function card(one) {
  return h("article", { class: "card" },
    h("p", {}, chip("outside", kinds[one.kind] ?? one.kind), h("span", { class: "muted" }, ` ${time(one.at)}, sent by ${one.by || "somebody without a token"}`)),
    h("p", { class: "reason" }, one.reason), h("details", {}, h("summary", {}, "What was sent"), h("pre", {}, pretty(one.document))));
}

function runCard(run) {
  return h("article", { class: "card" }, h("p", {}, chip("outside", "Run"), h("span", { class: "muted" }, ` ${time(run.at)}, ${run.model}, run ${run.id}`)),
    h("p", { class: "reason" }, run.reason ?? "given up"));
}

function pretty(text) {
  try {
    return JSON.stringify(JSON.parse(text), null, 1);
  } catch {
    return text;
  }
}
