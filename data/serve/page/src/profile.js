// Plane averages over the height, upright as a furnace is, with their intervals.
import uPlot from "uplot";
import { h } from "./dom.js";
import { number } from "./words.js";

const upright = (log) => ({ heights: { ori: 1, dir: 1, time: false }, values: { ori: 0, dir: 1, distr: log ? 3 : 1, ...(log && { range: (_, low, high) => [low / 1.2, high * 1.2] }) } });
/// Of a logarithmic scale, the powers of ten.
const decades = (_, marks) => marks.map((one) => (Math.abs(Math.log10(one) % 1) < 1e-6 || Math.abs(Math.log10(one) % 1) > 1 - 1e-6 ? one : null));
const mark = (value) => (value === null ? "" : String(Number(value.toPrecision(4))));
const token = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function axes(unit, log) {
  const shared = { stroke: token("--muted"), font: "11px system-ui", labelFont: "11px system-ui", labelSize: 16,
    grid: { stroke: token("--line"), width: 1 }, ticks: { stroke: token("--line"), size: 4 } };
  return [
    { ...shared, scale: "heights", side: 3, size: 36, label: "z [m]", space: 34 },
    { ...shared, scale: "values", side: 2, size: 28, label: unit, space: log ? 6 : 54, values: (_, all) => all.map(mark),
      ...(log && { filter: decades, grid: { ...shared.grid, filter: decades }, ticks: { ...shared.ticks, filter: decades } }) },
  ];
}

export class Profile {
  constructor() {
    this.element = h("div", { class: "profile", role: "img" });
  }

  /// @param curves { now: { values, half }, reference?: the same }, shown units; `half` may be missing
  /// @param least set: values go by orders of magnitude, from this one on
  show(heights, curves, { width, height, unit, name, least = -Infinity }) {
    const log = least > 0;
    const data = [Array.from(heights)];
    for (const one of [curves.now, curves.reference ?? curves.now]) {
      const half = one.half ?? one.values.map(() => 0);
      const above = (all) => all.map((v) => Math.max(v, least));
      data.push(above(Array.from(one.values)), above(Array.from(one.values, (v, i) => v - half[i])), above(Array.from(one.values, (v, i) => v + half[i])));
    }
    const form = `${width} ${height} ${unit} ${Boolean(curves.reference)} ${Boolean(curves.now.half)} ${token("--line")} ${log}`;
    if (this.form !== form) this.make(data, { width, height, unit, log, both: Boolean(curves.reference), bands: Boolean(curves.now.half) });
    else this.plot.setData(data);
    this.form = form;
    const top = curves.now.values.length - 1;
    this.element.setAttribute("aria-label",
      `${name} averaged over planes: ${number(curves.now.values[0])} ${unit} at the bottom, ${number(curves.now.values[top])} ${unit} at the top`);
  }

  make(data, { width, height, unit, log, both, bands }) {
    this.plot?.destroy();
    const now = token("--accent"), reference = token("--second"), band = token("--band"), other = token("--second-band");
    const edge = { scale: "values", stroke: "transparent", width: 0, points: { show: false } };
    const line = (colour, extra) => ({ scale: "values", stroke: colour, width: 2, points: { show: false }, ...extra });
    this.plot = new uPlot({
      width, height, padding: [8, 12, 0, 0], legend: { show: false },
      cursor: { drag: { x: false, y: false }, points: { show: false }, x: false, y: false },
      scales: upright(log), axes: axes(unit, log),
      series: [{ scale: "heights" }, line(now), edge, edge, line(reference, { show: both, dash: [6, 4] }), { ...edge, show: both }, { ...edge, show: both }],
      bands: bands ? [{ series: [3, 2], fill: band }, ...(both ? [{ series: [6, 5], fill: other }] : [])] : [],
    }, data, this.element);
  }
}
