// Elements in one line: h("button", { class: "x", onclick: f, disabled: true }, "text", child).
export function h(tag, attributes = {}, ...children) {
  const element = tag === "svg" || tag === "path" ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name in element && typeof value !== "string") element[name] = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat(3).filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/// A list that may be empty: says so instead of showing nothing.
export function table(headings, rows, empty) {
  if (rows.length === 0) return h("p", { class: "empty" }, empty);
  return h("div", { class: "scroll" },
    h("table", {},
      h("thead", {}, h("tr", {}, headings.map((one) => h("th", { scope: "col", class: one.className || null }, one)))),
      h("tbody", {}, rows)));
}

export function chip(kind, text = kind) {
  return h("span", { class: `chip ${kind ?? "none"}` }, text ?? "not judged");
}

let noticeTimer = 0;
/// Told once, then gone; of kind "good" or "bad".
export function notice(text, kind = "good") {
  document.querySelector(".notice")?.remove();
  document.body.append(h("div", { class: `notice ${kind}`, role: kind === "bad" ? "alert" : "status" }, text));
  clearTimeout(noticeTimer);
  noticeTimer = setTimeout(() => document.querySelector(".notice")?.remove(), kind === "bad" ? 9000 : 4000);
}
