// ELROM live: an operating point on the left; its fields follow.
import * as api from "./api.js";
import { ColourBar, rangeOf } from "./colours.js";
import { CutView, plane } from "./cut.js";
import { chip, h, notice } from "./dom.js";
import { trainedLine } from "./line.js";
import { PointPanel } from "./point.js";
import { Profile } from "./profile.js";
import { fieldLabel, isSigned, number, percent, plain, shownUnit, spansDecades } from "./words.js";

const axes = ["y", "x", "z"]; // from left to right
const titles = { x: "Side view", y: "Front view", z: "From above" };
const files = { hdf: "HDF5 for ParaView and scripts (.hdf)", csv: "Table (.csv)", txt: "Columns for SFW3D (.txt)",
  ip: "Fluent interpolation file (.ip)", openfoam: "Start of an OpenFOAM run (.tar)" };

export class LiveView {
  static async open(shared) {
    const model = await api.get("/model");
    const cases = await api.get("/model/cases");
    return new LiveView(shared, model, cases);
  }

  constructor(shared, model, cases) {
    Object.assign(this, { shared, model, extent: model.extent });
    this.field = model.fields.find((one) => one.name === "solid_volume_fraction") ?? model.fields[0];
    this.places = [0, 1, 2].map((i) => (this.extent.low[i] + this.extent.high[i]) / 2);
    this.places[2] = this.extent.low[2] + 0.12 * (this.extent.high[2] - this.extent.low[2]);
    this.point = new PointPanel(model, trainedLine(cases, model.inputs), () => this.refresh());
    this.reference = null;
    this.build();
    if (shared.point) this.point.setNamed(shared.point.inputs, shared.point.load);
    this.observer = new ResizeObserver(() => {
      this.pixels = this.profileSize = null;
      this.draw();
    });
    this.observer.observe(this.pictures);
    this.refresh();
  }

  close() {
    this.observer.disconnect();
    this.space?.close();
    this.shared.point = this.point.request();
  }

  // ---- what is on the page

  build() {
    this.verdict = h("div", { class: "verdict", role: "status", "aria-live": "polite" });
    this.readout = h("p", { class: "readout" }, "\u00a0");
    this.bar = new ColourBar();
    this.profile = new Profile();
    this.pictures = h("div", { class: "pictures" }, this.figure("y"), this.figure("x"), h("div", { class: "aside" }, this.figure("z"), this.profileFigure()));
    this.spaceBox = h("div", { class: "space", hidden: true });
    this.element = h("div", { class: "live" }, this.point.element,
      h("div", { class: "stage" }, this.verdict, this.toolbar(),
        h("div", { class: "bar-row" }, this.bar.element, this.logLabel,
          h("label", { class: "check", for: "hold", title: "Keep what the colours mean while sliders move" }, this.hold, "Hold"), this.readout), this.pictures, this.spaceBox));
  }

  toolbar() {
    this.select = h("select", { id: "field", onchange: () => {
      this.field = this.model.fields.find((one) => one.name === this.select.value);
      this.hold.checked = false;
      this.adoptField();
      this.refresh();
    } }, this.model.fields.map((one) => h("option", { value: one.name, selected: one === this.field }, fieldLabel(one.name))));
    this.hold = h("input", { type: "checkbox", id: "hold", onchange: () => this.draw() });
    const tab = (name, text) => h("button", { type: "button", "aria-pressed": String(name === "cuts"), "data-tab": name, onclick: () => this.showTab(name) }, text);
    this.log = h("input", { type: "checkbox", id: "log", onchange: () => this.arrange() });
    this.logLabel = h("label", { class: "check", for: "log", title: "Colours and profile by orders of magnitude" }, this.log, "Log scale");
    this.adoptField();
    this.tabs = h("div", { class: "segments", role: "group", "aria-label": "View" }, tab("cuts", "Cuts"), tab("space", "3-D"));
    this.differ = h("input", { type: "checkbox", id: "differ", onchange: () => this.arrange() });
    this.differLabel = h("label", { class: "check", for: "differ", hidden: true }, this.differ, "Difference");
    this.compareButton = h("button", { type: "button", id: "compare", onclick: () => this.toggleReference() }, "Compare with this");
    return h("div", { class: "toolbar" },
      h("label", { for: "field", class: "sr" }, "Field"), this.select, this.tabs,
      h("span", { class: "gap" }),
      this.differLabel, this.compareButton, this.saveMenu(), this.downloadMenu());
  }

  /// What has a sign has no logarithm.
  adoptField() {
    this.logLabel.hidden = isSigned(this.field.name);
    this.log.checked = spansDecades(this.field.name);
  }

  downloadMenu() {
    const item = (format) => {
      const offered = this.model.files.includes(format);
      return h("button", { type: "button", disabled: !offered, "data-format": format, onclick: () => this.download(format) }, files[format],
        !offered && h("small", {}, format === "openfoam" ? "elrom-serve --openfoam-case CASE offers it" : "elrom-predict is not beside elrom-serve"));
    };
    return menu("Download", Object.keys(files).map(item));
  }

  saveMenu() {
    const name = h("input", { id: "scenario-name", required: true, maxlength: 100, placeholder: "Winter, 70 % load" });
    const form = h("form", { onsubmit: (event) => {
      event.preventDefault();
      this.save(name.value);
    } }, h("label", { for: "scenario-name" }, "Name of the scenario"), name, h("button", { type: "submit", class: "primary" }, "Save"));
    this.saver = menu("Save as scenario", [this.shared.may("model") ? form : h("p", {}, "This needs a token with the role model or admin.")]);
    return this.saver;
  }

  figure(axis) {
    const coordinate = "xyz".indexOf(axis);
    const low = this.extent.low[coordinate], high = this.extent.high[coordinate];
    const look = { pick: (view, point, i) => this.tell(view, point, i), choose: (view, point) => this.moveCuts(view, point) };
    const views = { now: new CutView(axis, this.extent, look), reference: new CutView(axis, this.extent, look) };
    const text = h("output", { for: `cut-${axis}` });
    const range = h("input", { type: "range", id: `cut-${axis}`, min: low, max: high, step: (high - low) / 200, "aria-label": `Cut at ${axis} [m]`,
      oninput: () => {
        this.places[coordinate] = Number(range.value);
        this.refresh();
      } });
    const holder = h("div", { class: "pair" }, h("div", { class: "one reference", hidden: true }, h("h4", {}, "Reference"), views.reference.canvas),
      h("div", { class: "one" }, h("h4", { hidden: true }, "Now"), views.now.canvas));
    const element = h("figure", { class: `figure ${axis}` },
      h("figcaption", {}, h("strong", {}, titles[axis]), h("label", { for: `cut-${axis}`, class: "cut-place" }, `${axis} = `, text), range), holder);
    this[`figure_${axis}`] = { views, range, text, element, holder, coordinate };
    return element;
  }

  profileFigure() {
    this.profileTitle = h("span", { class: "muted" });
    return h("figure", { class: "figure p" }, h("figcaption", {}, h("strong", {}, "Mean over each plane"), this.profileTitle), this.profile.element);
  }

  // ---- asking

  request(point) {
    return { ...point, fields: [this.field.name], intervals: true, profile: true,
      cuts: axes.map((axis) => ({ axis, at: this.places["xyz".indexOf(axis)] })) };
  }

  async ask(point) {
    const { head, floats } = await api.predict(this.request(point));
    const field = head.fields[this.field.name];
    const values = floats(field.values), half = field.half_width && floats(field.half_width);
    const part = (i) => head.parts[i].places;
    const of = (i) => ({ values: values.subarray(...part(i)), half: half?.subarray(...part(i)) });
    return { head, parts: axes.map((_, i) => of(i)), profile: of(axes.length) };
  }

  /// The last change counts: what comes while an answer is on its way is asked for when it is there.
  async refresh() {
    this.again = true;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.again) {
        this.again = false;
        await this.fetch();
        if (this.answer.head.model.digest !== this.model.digest) return this.shared.renew();
        this.draw();
      }
    } catch (error) {
      await this.showFault(error);
    } finally {
      this.busy = false;
    }
  }

  async fetch() {
    const asked = this.point.request();
    const [answer, polygons] = await Promise.all([this.ask(asked),
      Promise.all(axes.map((axis) => api.cut(axis, this.places["xyz".indexOf(axis)], this.model.mesh_digest)))]);
    const view = `${this.field.name} ${this.places}`;
    if (this.reference && this.reference.view !== view)
      this.reference = { ...this.reference, view, answer: await this.ask(this.reference.point) };
    Object.assign(this, { answer, polygons, asked, view });
  }

  /// Another model may have taken the place of this one, with other inputs.
  async showFault(error) {
    const now = error.problem?.status === 422 && (await api.get("/model").catch(() => null));
    if (now && now.digest !== this.model.digest) return this.shared.renew();
    this.verdict.replaceChildren(chip("bad", "not answered"), h("span", {}, error.message));
    this.verdict.className = "verdict bad";
    if (error.problem?.status === 401) this.shared.signIn();
  }

  // ---- showing

  showVerdict() {
    const { verdict, reason, nearest, model } = this.answer.head;
    const words = { inside: "inside the trained range", edge: "at the edge of the trained range", outside: "outside the trained range: do not rely on it" };
    this.verdict.className = `verdict ${verdict}`;
    this.verdict.replaceChildren(chip(verdict), h("div", {}, h("strong", {}, capitalised(words[verdict])), h("span", {}, ` – ${plain(reason)}.`),
      h("span", { class: "muted wide" }, ` Nearest training case: ${plain(nearest[0]?.case ?? "none")}`,
        nearest[0]?.load ? ` (${percent(nearest[0].load)} load)` : "", `. Model ${model.name.replace(".elrom", "")}.`)));
  }

  get answers() {
    return this.reference ? [this.reference.answer, this.answer] : [this.answer];
  }
  get differs() {
    return Boolean(this.reference) && this.differ.checked;
  }
  /// What the picture of a cut shows: the values of now, or how far they are above the reference's.
  shown(i) {
    const { values } = this.answer.parts[i];
    return this.differs ? values.map((one, k) => one - this.reference.answer.parts[i].values[k]) : values;
  }

  scale() {
    if (this.hold.checked && this.held) return this.held;
    if (this.differs) return (this.held = rangeOf(axes.map((_, i) => this.shown(i)), "signed"));
    const how = isSigned(this.field.name) ? "signed" : this.log.checked ? "log" : "amount";
    this.held = rangeOf(this.answers.flatMap((answer) => answer.parts.map((part) => part.values)), how);
    return this.held;
  }

  draw() {
    if (!this.answer) return;
    const colours = this.scale();
    const { factor, unit } = shownUnit(this.field);
    this.showVerdict();
    this.bar.show(colours, factor, unit, fieldLabel(this.field.name));
    if (!this.readoutBusy) this.readout.textContent = this.title(unit);
    if (this.spaceBox.hidden) {
      this.drawCuts(colours);
      this.drawProfile(factor, unit);
    } else {
      this.space?.show(this.spaceCuts(), colours);
    }
    performance.mark("drawn");
  }

  title(unit) {
    return `${fieldLabel(this.field.name)}${this.differs ? ", now − reference" : ""} [${unit}]`;
  }

  /// Pictures have other sizes, or show something else.
  arrange() {
    this.pixels = this.profileSize = null;
    this.hold.checked = false;
    this.draw();
  }

  /// CSS pixels a metre, the same in all pictures: as large as they fit, on a wide screen without scrolling.
  pixelsPerMetre() {
    const width = this.pictures.clientWidth, copies = this.reference && !this.differs ? 2 : 1;
    const length = (i) => this.extent.high[i] - this.extent.low[i];
    const phone = width < 560;
    const beside = !phone && copies === 1 ? length(1) : 0; // the view from above stands beside the other two
    const margins = phone ? 2 * 58 * copies + 12 : (beside ? 3 : 2 * copies) * 48 + 100;
    const top = this.pictures.getBoundingClientRect().top + window.scrollY;
    const tall = phone ? 300 : Math.max(330, window.innerHeight - top - (copies > 1 ? 170 : 150));
    return Math.max(2.4, Math.min(tall / length(2), (width - margins) / (copies * (length(0) + length(1)) + beside)));
  }

  drawCuts(colours) {
    const scale = (this.pixels ??= this.pixelsPerMetre()); // asks for the layout, which takes its time
    const lines = Object.fromEntries(axes.map((axis) => [axis, this.places["xyz".indexOf(axis)]]));
    axes.forEach((axis, i) => {
      const { views, range, text, holder, coordinate } = this[`figure_${axis}`];
      const [reference, now] = holder.children;
      const pair = this.reference && !this.differs;
      reference.hidden = !pair;
      now.firstChild.hidden = !pair;
      reference.firstChild.textContent = `Reference${loadText(this.reference?.point)}`;
      now.firstChild.textContent = `Now${loadText(this.asked)}`;
      views.now.place(this.polygons[i], scale);
      views.now.draw(this.shown(i), colours, lines);
      if (pair) {
        views.reference.place(this.polygons[i], scale);
        views.reference.draw(this.reference.answer.parts[i].values, colours, lines);
      }
      range.value = this.places[coordinate];
      text.textContent = `${number(this.places[coordinate])} m`;
      for (const view of Object.values(views)) view.canvas.setAttribute("aria-label", `${fieldLabel(this.field.name)}, cut at ${axis} = ${text.textContent}`);
    });
  }

  drawProfile(factor, unit) {
    const curve = ({ profile }) => ({ values: profile.values.map((one) => factor * one), half: profile.half?.map((one) => factor * one) });
    this.profileSize ??= { width: Math.max(230, this.profile.element.clientWidth || 300), height: this.profileHeight() };
    const level = this.answer.head.level;
    this.profileTitle.textContent = level ? `band: ${percent(level)} interval` : "";
    this.profile.show(this.extent.heights, { now: curve(this.answer), reference: this.reference && curve(this.reference.answer) },
      { ...this.profileSize, least: this.held.how === "log" ? factor * this.held.low : undefined, unit: `${fieldLabel(this.field.name)} [${unit}]`, name: fieldLabel(this.field.name) });
  }

  /// Down to where the cuts beside it end.
  profileHeight() {
    const side = this.figure_x.element.getBoundingClientRect(), above = this.figure_z.element.getBoundingClientRect();
    return above.left > side.left ? Math.max(250, Math.round(side.bottom - above.bottom - 76)) : 330;
  }

  spaceCuts() {
    return this.polygons.map((polygons, i) => ({ polygons, values: this.shown(i) }));
  }

  async showTab(name) {
    for (const button of this.tabs.children) button.setAttribute("aria-pressed", String(button.dataset.tab === name));
    this.pictures.hidden = name === "space";
    this.spaceBox.hidden = name !== "space";
    if (name === "space" && !this.space) await this.openSpace();
    this.draw();
  }

  async openSpace() {
    const stage = h("div", { class: "space-stage", tabindex: 0, role: "application", "aria-label": "Cuts in three dimensions: arrows turn, plus and minus zoom",
      onkeydown: (event) => {
        const turn = { ArrowLeft: [8, 0], ArrowRight: [-8, 0], ArrowUp: [0, -6], ArrowDown: [0, 6], "+": [0, 0, 1.15], "-": [0, 0, 1 / 1.15] }[event.key];
        if (!turn) return;
        event.preventDefault();
        this.space?.turn(...turn);
      } });
    this.spaceBox.replaceChildren(stage, h("p", { class: "muted" }, "Drag to turn, wheel to zoom; arrow keys and + − do the same. Cuts stay where the cut view has them."));
    try {
      const { Space } = await import("./space.js");
      this.space = new Space(stage, this.extent);
    } catch (error) {
      stage.replaceChildren(h("p", { class: "empty" }, `This browser shows no three dimensions (${error.message}).`));
    }
  }

  /// What is under the pointer, in numbers.
  tell(view, point, i) {
    this.readoutBusy = i >= 0;
    const { factor, unit } = shownUnit(this.field);
    if (i < 0) {
      this.readout.textContent = this.title(unit);
      return;
    }
    const answer = view === this[`figure_${view.axis}`].views.reference ? this.reference.answer : this.answer;
    const part = answer.parts[axes.indexOf(view.axis)];
    const half = part.half && !this.differs ? ` ± ${number(factor * part.half[i])}` : "";
    const value = this.differs ? this.shown(axes.indexOf(view.axis))[i] : part.values[i];
    this.readout.textContent = `${number(factor * value)}${half} ${unit} at x ${number(point[0])}, y ${number(point[1])}, z ${number(point[2])} m`;
  }

  moveCuts(view, point) {
    for (const coordinate of [plane[view.axis].right, plane[view.axis].up]) this.places[coordinate] = point[coordinate];
    this.refresh();
  }

  // ---- doing

  toggleReference() {
    this.reference = this.reference ? null : { point: this.asked, view: this.view, answer: this.answer };
    this.compareButton.textContent = this.reference ? "End comparison" : "Compare with this";
    this.differLabel.hidden = !this.reference;
    if (this.reference) notice("Kept as the reference: now move a slider.");
    this.arrange();
  }

  async save(name) {
    try {
      await api.post("/scenarios", { name, boiler: this.model.furnace ?? "", ...this.point.request() });
      this.saver.close();
      notice(`Scenario “${name}” is saved.`);
    } catch (error) {
      notice(error.message, "bad");
    }
  }

  async download(format) {
    try {
      notice("The file is being written.");
      await api.download({ ...this.point.request(), format, intervals: true }, `elrom.${format === "openfoam" ? "tar" : format}`);
      notice("The file is here.");
    } catch (error) {
      notice(error.message, "bad");
    }
  }
}

const loadText = (point) => (point?.load ? `, ${percent(point.load)}` : "");
const capitalised = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/// A button that opens a box below it; Escape and a click elsewhere close it.
function menu(title, content) {
  const box = h("details", { class: "menu" }, h("summary", { class: "button", role: "button" }, title), h("div", { class: "menu-box" }, content));
  box.close = () => box.removeAttribute("open");
  box.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    box.close();
    box.firstChild.focus();
  });
  document.addEventListener("click", (event) => {
    if (!box.contains(event.target)) box.close();
  });
  box.addEventListener("click", (event) => {
    if (event.target.closest("[data-format]")) box.close();
  });
  return box;
}
