// Scenarios: operating points that were saved, and what the models make of them.
import * as api from "./api.js";
import { chain, modelName, modelNames, modelStates } from "./chain.js";
import { chip, h, notice, table } from "./dom.js";
import { ListView } from "./list_view.js";
import { number, percent, plain, short, time, unitText } from "./words.js";

const askable = ["elrom", "el3d"];
const period = 2000; // ms between two looks at runs that are not over

export class ScenariosView extends ListView {
  constructor(shared) {
    super(shared, "Scenarios", "Operating points, each judged by the guard when it came. Models take runs on them and give back results.");
  }

  close() {
    clearTimeout(this.timer);
    this.closed = true;
  }

  /// Shows anew only what is new: whoever reads keeps his place.
  async load() {
    [this.scenarios, this.runs] = await Promise.all([api.list("/scenarios"), api.list("/runs")]);
    if (this.model === undefined) await this.learnModel();
    const seen = JSON.stringify([this.scenarios, this.runs]);
    if (seen !== this.seen) {
      this.seen = seen;
      if (!this.scenarios.some((one) => one.id === this.chosen)) this.chosen = this.scenarios[0]?.id;
      this.showList();
      await this.showDetail();
    }
    clearTimeout(this.timer);
    const open = this.runs.some((one) => one.state === "waiting" || one.state === "running");
    if (open && !this.closed) this.timer = setTimeout(() => this.load().catch(() => {}), period);
  }

  /// Whose mesh pictures are drawn on; asking for one where there is none would be a fault in the browser's console.
  async learnModel() {
    this.model = (await api.get("/healthz")).model ? await api.get("/model") : null;
  }

  row(one) {
    const last = this.runs.filter((run) => run.scenario === one.id)[0];
    return h("tr", { class: one.id === this.chosen ? "chosen" : "", onclick: () => this.choose(one.id) },
      h("td", {}, h("button", { type: "button", class: "link", "aria-current": one.id === this.chosen ? "true" : null }, one.name)),
      h("td", { class: "number" }, one.load === null ? "–" : percent(one.load)),
      h("td", {}, chip(one.verdict, one.verdict ?? "not judged")),
      h("td", {}, last ? [chip(last.state), ` ${modelName(last.model)}`] : h("span", { class: "muted" }, "no run")),
      h("td", { class: "muted wide" }, time(one.at)));
  }

  showList() {
    this.list.replaceChildren(modelStates(this.runs), table(["Name", "Load", "Guard", "Last run", h("span", { class: "wide" }, "Saved")],
      this.scenarios.map((one) => this.row(one)), "No scenario yet. Move the sliders in Live, then “Save as scenario”."));
  }

  async choose(id) {
    if (id === this.chosen) return;
    this.chosen = id;
    this.showList();
    await this.showDetail();
  }

  async showDetail() {
    const one = this.scenarios.find((scenario) => scenario.id === this.chosen);
    if (!one) return this.detail.replaceChildren();
    const results = await api.list(`/scenarios/${one.id}/results`);
    if (this.chosen !== one.id) return;
    const runs = this.runs.filter((run) => run.scenario === one.id);
    this.detail.replaceChildren(h("section", { class: "panel" },
      h("h2", {}, one.name),
      h("p", {}, chip(one.verdict, one.verdict ?? "not judged"), ` ${plain(one.reason ?? "No model was there to judge it.")}`),
      one.note && h("p", {}, one.note),
      one.verdict === "outside" && h("p", { class: "muted" }, "ELROM was not trained for this: EL3D can say what happens here, and ELROM can learn it from that."),
      h("div", { class: "actions" }, h("button", { type: "button", class: "primary", onclick: () => this.shared.openPoint(one) }, "Open in Live"),
        this.shared.may("model") && askable.map((model) => h("button", { type: "button", onclick: () => this.ask(one, model) }, `Run ${modelNames[model]}`))),
      runs.length > 0 && [h("h3", {}, "Chain"), chain(runs, results, this.model)],
      h("h3", {}, "Runs"), table(["Run", "Model", "State", "Since", "What happened"], runs.map(runRow), "No model was asked yet."),
      h("h3", {}, "Results"), results.length ? results.map(resultCard) : h("p", { class: "empty" }, "Nothing came back yet."),
      h("details", {}, h("summary", {}, "Boundary conditions (SI)"), inputsTable(one.inputs))));
  }

  async ask(scenario, model) {
    try {
      await api.post("/runs", { scenario: scenario.id, model });
      notice(`A run of ${model} waits for its master.`);
      await this.load();
    } catch (error) {
      notice(error.message, "bad");
    }
  }
}

function runRow(run) {
  return h("tr", {}, h("td", { class: "number" }, run.id), h("td", {}, modelName(run.model)), h("td", {}, chip(run.state)),
    h("td", { class: "muted" }, time(run.at)), h("td", {}, run.reason ?? (run.worker ? `worked on by ${run.worker}` : "–")));
}

function resultCard(result) {
  const facts = Object.entries(result.document ?? {}).filter(([, value]) => typeof value !== "object");
  return h("article", { class: "card" },
    h("p", {}, h("strong", {}, modelName(result.model)), " ", chip(result.verdict, result.verdict ?? "no verdict"), " ",
      h("span", { class: "muted" }, `${time(result.at)}, version ${short(result.version)}`)),
    result.reason && h("p", {}, plain(result.reason)),
    facts.length > 0 && h("dl", {}, facts.map(([name, value]) => [h("dt", {}, plain(name)), h("dd", {}, typeof value === "number" ? number(value, 4) : String(value))])),
    result.fields && h("button", { type: "button", onclick: () => api.downloadFields(result.fields).catch((error) => notice(error.message, "bad")) },
      "Download its fields (.hdf)"));
}

function inputsTable(inputs) {
  return table(["Input", "Value", "Unit"], Object.entries(inputs).map(([name, value]) => {
    const [, words, unit] = /^(.*) \[(.*)\]$/.exec(name) ?? [null, name, ""];
    return h("tr", {}, h("td", {}, plain(words)), h("td", { class: "number" }, number(value, 5)), h("td", {}, unitText(unit)));
  }), "None.");
}
