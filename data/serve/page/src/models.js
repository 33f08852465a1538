// Versions of the model: what made each, how accurate it is, which one answers.
import * as api from "./api.js";
import { chip, h, notice, table } from "./dom.js";
import { ListView } from "./list_view.js";
import { fieldLabel, number, short } from "./words.js";

export class ModelsView extends ListView {
  constructor(shared) {
    super(shared, "Models", "Versions of the study's model. A new one answers only when the gate finds no field worse, or an administrator says so.");
  }

  async load() {
    try {
      this.versions = (await api.get("/models")).items.reverse();
    } catch (error) {
      if (error.problem?.status !== 404) throw error;
      this.list.replaceChildren(h("p", { class: "empty" }, "The server answers with a single bundle and not with a study, so there are no versions: elrom-serve --model STUDY."));
      return;
    }
    this.chosen ??= this.versions.find((one) => one.answers)?.number;
    this.showList();
    await this.showDetail();
  }

  row(one) {
    const open = () => {
      this.chosen = one.number;
      this.showList();
      this.showDetail();
    };
    return h("tr", { class: one.number === this.chosen ? "chosen" : "", onclick: open },
      h("td", {}, h("button", { type: "button", class: "link" }, `Version ${one.number}`)),
      h("td", {}, one.answers ? chip("done", "answers") : one.promoted ? chip("none", "answered before") : chip("edge", "kept back")),
      h("td", {}, one.by ?? "–"), h("td", { class: "number" }, one.cases ?? "–"),
      h("td", { class: "number" }, one.verdict ? `${number(one.verdict.before)} → ${number(one.verdict.after)}` : "–"),
      h("td", { class: "muted wide" }, one.date ?? ""));
  }

  showList() {
    this.list.replaceChildren(table(["Version", "State", "Made by", "Cases", "Error before → after", h("span", { class: "wide" }, "Date")],
      this.versions.map((one) => this.row(one)), "No version yet: elrom-train run STUDY."));
  }

  async showDetail() {
    const one = await api.get(`/models/${this.chosen}`);
    if (one.number !== this.chosen) return; // another was chosen meanwhile
    const accuracy = Object.entries(one.accuracy ?? {}).filter(([, of]) => of && typeof of === "object");
    this.detail.replaceChildren(h("section", { class: "panel" },
      h("h2", {}, `Version ${one.number}`),
      h("p", {}, `Made by “${one.by ?? "unknown"}” from ${one.cases ?? "?"} cases with ${one.program}. `, h("span", { class: "muted" }, short(one.digest))),
      h("div", { class: "actions" },
        !one.answers && this.shared.may("admin") && h("button", { type: "button", class: "primary", id: "promote", onclick: () => this.promote(one) }, "Promote: let this version answer"),
        h("button", { type: "button", id: "report", onclick: () => this.openReport(one) }, one.answers ? "Open its full report" : "Open its comparison with the version that answers")),
      !one.answers && !this.shared.may("admin") && h("p", { class: "muted" }, "Promoting a version needs a token with the role admin."),
      one.verdict && [h("h3", {}, "What the gate said"), gateTable(one.verdict)],
      h("h3", {}, "Error in cross-validation"),
      h("p", { class: "muted" }, "NRMSE: 0 is perfect, 1 is the mean of the training cases."),
      table(["Field", "ELROM", "Made of", "Best single method"], accuracy.map(accuracyRow), "This bundle tells no errors."),
      h("details", {}, h("summary", {}, "Settings and origin"),
        h("pre", {}, [one.settings, ...Object.entries(one.provenance ?? {}).map(([key, value]) => `# ${key}: ${value}`)].join("\n")))));
  }

  /// In a tab of its own, which browsers open only at once; its place needs no token.
  async openReport(one) {
    const tab = window.open();
    notice("elrom-report is asked for it; the first time it takes up to a minute.");
    try {
      (tab ?? window).location.href = (await api.post(`/models/${one.number}/report`)).place;
    } catch (error) {
      tab?.close();
      notice(error.message, "bad");
    }
  }

  async promote(one) {
    const against = one.verdict && !one.promoted ? " The gate found it worse." : "";
    if (!confirm(`Let version ${one.number} answer?${against}`)) return;
    try {
      await api.put("/models/current", { number: one.number });
      notice(`Version ${one.number} answers now.`);
      await this.load();
    } catch (error) {
      notice(error.message, "bad");
    }
  }
}

function accuracyRow([field, of]) {
  const others = (of.candidates ?? []).filter((one) => Number.isFinite(one.nrmse));
  const best = others.length ? others.reduce((a, b) => (b.nrmse < a.nrmse ? b : a)) : null;
  const width = Math.round(100 * Math.min(1, of.nrmse));
  return h("tr", {}, h("td", {}, fieldLabel(field)),
    h("td", { class: "number" }, h("meter", { min: 0, max: 100, value: width, "aria-hidden": "true" }), ` ${number(of.nrmse)}`),
    h("td", {}, of.kind === "composite" || !of.kind ? (of.method ?? "–") : of.kind), h("td", {}, best ? `${best.name.replaceAll("_", " ")} ${number(best.nrmse)}` : "–"));
}

function gateTable(verdict) {
  return table(["Field", "Before", "After", "Verdict"], (verdict.fields ?? []).map((one) =>
    h("tr", {}, h("td", {}, fieldLabel(one.field)), h("td", { class: "number" }, number(one.before)), h("td", { class: "number" }, number(one.after)),
      h("td", {}, chip({ worse: "outside", better: "inside" }[one.verdict] ?? "none", one.verdict)))), "Nothing to compare with.");
}
