// A view of a list and, beside it, what was chosen there. Who extends it shows both in load().
import { h } from "./dom.js";

export class ListView {
  static async open(shared) {
    const view = new this(shared);
    await view.load();
    return view;
  }

  constructor(shared, title, lead) {
    this.shared = shared;
    this.list = h("div", { class: "list" });
    this.detail = h("div", { class: "detail" });
    this.element = h("div", { class: "page" }, h("h1", {}, title), h("p", { class: "lead" }, lead), h("div", { class: "columns" }, this.list, this.detail));
  }

  close() {}
}
