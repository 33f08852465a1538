// The chain of a scenario as a picture: which model worked on it, whom it asked next, with what came of each.
import * as api from "./api.js";
import { rangeOf } from "./colours.js";
import { CutView } from "./cut.js";
import { chip, h } from "./dom.js";
import { fieldLabel, isSigned, number, plain, spansDecades, time } from "./words.js";

export const modelNames = { elrom: "ELROM", el3d: "EL3D", "elrom-build": "ELROM training" };
export const modelName = (model) => modelNames[model] ?? model;

/// What each model is doing, over all scenarios. @param runs the newest first
export function modelStates(runs) {
  const models = [...new Set([...Object.keys(modelNames), ...runs.map((run) => run.model)])];
  return h("ul", { class: "models" }, models.map((model) => {
    const own = runs.filter((run) => run.model === model);
    if (own.length === 0) return null;
    const count = (state) => own.filter((run) => run.state === state).length;
    const states = ["running", "waiting", "failed", "quarantined", "done"].filter(count);
    const at = own.find((run) => run.state === "running")?.worker;
    return h("li", { class: "card" }, h("strong", {}, modelName(model)), states.map((state) => chip(state, `${count(state)} ${state}`)),
      h("span", { class: "muted" }, at ? `at ${at}` : time(own[0].at)));
  }));
}

/// @param runs, results of one scenario @param model that answers; null: none
export function chain(runs, results, model) {
  const resultOf = (run) => results.find((one) => one.run === run.id);
  const asked = new Map(results.flatMap((one) => one.followed_by.map((id) => [id, one.run])));
  const byId = [...runs].sort((a, b) => a.id - b.id);
  const row = (run) => h("li", {}, step(run, resultOf(run), model), rows(byId.filter((one) => asked.get(one.id) === run.id)));
  const rows = (some) => some.length > 0 && h("ol", {}, some.map(row));
  return h("div", { class: "chain", role: "img", "aria-label": `Chain: ${byId.map((run) => `${modelName(run.model)} ${run.state}`).join(", ")}` },
    rows(byId.filter((run) => !asked.has(run.id))));
}

function step(run, result, model) {
  const warning = run.reason ?? (["outside", "edge"].includes(result?.verdict) ? result.reason : null);
  const facts = Object.entries(result?.document ?? {}).filter(([, value]) => typeof value === "number").slice(0, 3);
  return h("div", { class: `step ${run.state}` },
    h("p", {}, h("strong", {}, modelName(run.model)), " ", chip(run.state), result?.verdict && [" ", chip(result.verdict)]),
    facts.map(([name, value]) => h("p", { class: "muted" }, `${plain(name)} ${number(value, 3)}`)),
    warning && h("p", { class: "warning" }, plain(warning)),
    result?.fields && model && picture(result.fields, model));
}

/// A cut through the middle of the fields that came back, drawn when it is there: of the solids, where they are among them.
function picture(digest, model) {
  const { low, high } = model.extent;
  const at = (low[0] + high[0]) / 2;
  const view = new CutView("x", model.extent, {});
  const words = h("figcaption", {});
  const figure = h("figure", { hidden: true }, view.canvas, words);
  Promise.all([api.fieldsCut(digest, "x", at), api.cut("x", at, model.mesh_digest)]).then(([fields, polygons]) => {
    const name = "solid_volume_fraction" in fields ? "solid_volume_fraction" : Object.keys(fields)[0];
    if (!name) return; // on another mesh than the model that answers now
    figure.hidden = false;
    words.textContent = `${fieldLabel(name)}, x = ${number(at)} m`;
    view.canvas.setAttribute("aria-label", words.textContent);
    view.place(polygons, 150 / (high[2] - low[2]));
    view.draw(fields[name], rangeOf([fields[name]], isSigned(name) ? "signed" : spansDecades(name) ? "log" : "amount"), {});
  }).catch(() => figure.remove()); // its numbers are there all the same
  return figure;
}
