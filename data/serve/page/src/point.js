// The panel of an operating point: a slider for each input, grouped by what enters the furnace, with the trained ranges.
import { h } from "./dom.js";
import { capital, number, plain, unitText } from "./words.js";

const kinds = [["primary_air", "Primary air"], ["secondary_air", "Secondary air"], ["fuel", "Fuel"], ["burner", "Burners"],
  ["return", "Solids return"], ["heat_exchanger", "Heat exchangers (INTREX)"], ["other", "Bed and state"]];
const beyond = 0.15; // of the trained width: how far a slider goes outside

/// SI to the unit that people use, which may have another zero.
const shown = (input, si) => input.high > input.low
  ? input.display_low + ((si - input.low) / (input.high - input.low)) * (input.display_high - input.display_low)
  : input.display_low + (si - input.low);
const inSi = (input, value) => input.display_high > input.display_low
  ? input.low + ((value - input.display_low) / (input.display_high - input.display_low)) * (input.high - input.low)
  : input.low + (value - input.display_low);

function limits(input) {
  const width = input.display_high - input.display_low || Math.abs(input.display_low) || 1;
  const low = input.display_low - beyond * width;
  return { low: input.display_low >= 0 ? Math.max(0, low) : low, high: input.display_high + beyond * width };
}

/// "secondary_front_lower_left" in the group of secondary air: "front lower left".
function labelOf(input, group) {
  const words = input.name.split("_");
  const shared = group.length > 1 && group.every((one) => one.name.split("_")[0] === words[0]);
  return capital(plain(shared && words.length > 1 ? words.slice(1).join("_") : input.name));
}

function slider(input, label, changed) {
  const { low, high } = limits(input);
  const step = (high - low) / 200;
  const id = `input-${input.name}`;
  const range = h("input", { type: "range", id, min: low, max: high, step: "any", class: "slider",
    "aria-label": `${label} [${unitText(input.display_unit)}]`, oninput: () => set(Number(range.value)),
    onkeydown: (event) => {
      const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
      if (!by) return;
      event.preventDefault(); // a slider without steps would go by a hundredth of itself anyway; this one is the same everywhere
      range.value = Number(range.value) + by * step;
      range.dispatchEvent(new Event("input", { bubbles: true }));
    } });
  const box = h("input", { type: "text", inputmode: "decimal", class: "value", "aria-label": `${label}, value`,
    onchange: () => {
      const value = Number(box.value.replace(",", "."));
      if (box.value.trim() !== "" && Number.isFinite(value)) set(value);
      else show(input.value);
    } });
  const place = (value) => `${(100 * (value - low)) / (high - low)}%`;
  range.style.setProperty("--from", place(input.display_low));
  range.style.setProperty("--to", place(input.display_high));
  const row = h("div", { class: "input" }, h("label", { for: id }, label),
    h("span", { class: "unit" }, box, h("span", {}, unitText(input.display_unit))), range,
    h("span", { class: "trained", title: "trained range" }, `${number(input.display_low)} – ${number(input.display_high)}`));
  function show(si) {
    input.value = si;
    const value = shown(input, si);
    range.value = value;
    box.value = number(value, 4);
    const slack = 1e-9 * Math.abs(input.high || 1);
    row.classList.toggle("beyond", si < input.low - slack || si > input.high + slack);
  }
  function set(value) {
    show(inSi(input, value));
    changed();
  }
  input.show = show;
  return row;
}

export class PointPanel {
  /// @param changed() told after each change by hand
  constructor(model, line, changed) {
    this.inputs = model.inputs.map((input) => ({ ...input, kind: input.opening?.kind ?? "other" }));
    this.line = line;
    this.changed = changed;
    this.load = null;
    const edited = () => {
      this.showTotals();
      changed();
    };
    this.groups = kinds.map(([kind, title]) => ({ kind, title, inputs: this.inputs.filter((input) => input.kind === kind) }))
      .filter((group) => group.inputs.length > 0);
    if (this.groups.length === 1) this.groups[0].title = "Inputs";
    this.element = h("section", { class: "panel point", "aria-label": "Operating point" },
      h("h2", {}, "Operating point"), line && this.loadRow(), this.groups.map((group) => this.group(group, edited)));
    this.setLoad(line ? Math.round(20 * (line.low + 0.6 * (line.high - line.low))) / 20 : null);
  }

  loadRow() {
    const { line } = this;
    this.loadText = h("output", { for: "load" });
    this.loadRange = h("input", { type: "range", id: "load", class: "slider", min: line.low, max: line.high, step: 0.005,
      oninput: () => {
        this.setLoad(Number(this.loadRange.value));
        this.changed();
      } });
    return h("div", { class: "input load" }, h("label", { for: "load" }, "Boiler load"), this.loadText, this.loadRange,
      h("span", { class: "trained" }, "moves all inputs along the trained line"));
  }

  group(group, edited) {
    group.total = h("span", { class: "total" });
    return h("details", { class: "group", open: group.kind === "primary_air" || this.groups.length === 1 },
      h("summary", {}, h("span", {}, group.title), group.total),
      group.inputs.length > 1 && group.inputs.every((one) => one.unit === "kg/s") && group.kind !== "other" && this.scaleRow(group, edited),
      group.inputs.map((input) => slider(input, labelOf(input, group.inputs), edited)));
  }

  /// All of a group up or down together.
  scaleRow(group, edited) {
    const by = (factor) => () => {
      for (const input of group.inputs) input.show(input.value * factor);
      edited();
    };
    return h("div", { class: "together" }, h("span", {}, "All together"),
      h("button", { type: "button", class: "small", onclick: by(1 / 1.02), "aria-label": `${group.title} 2 % down` }, "− 2 %"),
      h("button", { type: "button", class: "small", onclick: by(1.02), "aria-label": `${group.title} 2 % up` }, "+ 2 %"));
  }

  showTotals() {
    for (const { inputs, total } of this.groups) {
      const flows = inputs.every((one) => one.unit === "kg/s" && one.display_unit === inputs[0].display_unit);
      total.textContent = flows && inputs[0].kind !== "other"
        ? `${number(inputs.reduce((sum, one) => sum + shown(one, one.value), 0))} ${unitText(inputs[0].display_unit)}` : "";
    }
  }

  setLoad(load) {
    this.load = load;
    this.set(load === null ? this.inputs.map((one) => (one.low + one.high) / 2) : this.line.at(load));
    if (load === null) return;
    this.loadRange.value = load;
    this.loadText.textContent = `${number(100 * load, 3)} %`;
  }

  /// @param values SI, in the model's order
  set(values) {
    this.inputs.forEach((input, i) => input.show(values[i]));
    this.showTotals();
  }

  /// Of a scenario: { "primary_air [kg/s]": ... } in SI. @return what the model does not know
  setNamed(named, load) {
    this.load = load ?? null;
    if (this.loadRange && load) {
      this.loadRange.value = load;
      this.loadText.textContent = `${number(100 * load, 3)} %`;
    }
    for (const input of this.inputs) {
      const value = named[`${input.name} [${input.unit}]`];
      if (value !== undefined) input.show(value);
    }
    this.showTotals();
  }

  /// As requests want it.
  request() {
    const inputs = Object.fromEntries(this.inputs.map((one) => [`${one.name} [${one.unit}]`, one.value]));
    return this.load === null ? { inputs } : { inputs, load: this.load };
  }
}
