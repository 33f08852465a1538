// A plane cut as a picture. Where each cell lies is worked out once; a new prediction only changes colours.
import { h } from "./dom.js";

const margin = { left: 34, bottom: 30, top: 8, right: 8 };
/// Coordinates that go right and up, by the axis of the cut.
export const plane = { x: { right: 1, up: 2 }, y: { right: 0, up: 2 }, z: { right: 1, up: 0 } };
const names = ["x", "y", "z"];

/// Which polygon covers each pixel: -1 for none. Polygons are convex.
function rasterise(polygons, { right, up }, toX, toY, width, height) {
  const ids = new Int32Array(width * height).fill(-1);
  for (let i = 0; i + 1 < polygons.offsets.length; ++i) {
    const xs = [], ys = [];
    for (let k = polygons.offsets[i]; k < polygons.offsets[i + 1]; ++k) {
      xs.push(toX(polygons.points[3 * k + right]));
      ys.push(toY(polygons.points[3 * k + up]));
    }
    const last = Math.min(height - 1, Math.ceil(Math.max(...ys) - 0.5) - 1);
    for (let row = Math.max(0, Math.ceil(Math.min(...ys) - 0.5)); row <= last; ++row) fillRow(ids, xs, ys, row, width, i);
  }
  return ids;
}

function fillRow(ids, xs, ys, row, width, id) {
  let low = Infinity, high = -Infinity;
  const y = row + 0.5;
  for (let k = 0; k < xs.length; ++k) {
    const next = (k + 1) % xs.length;
    if (ys[k] <= y === ys[next] <= y) continue;
    const x = xs[k] + ((y - ys[k]) / (ys[next] - ys[k])) * (xs[next] - xs[k]);
    low = Math.min(low, x);
    high = Math.max(high, x);
  }
  const end = Math.min(width - 1, Math.ceil(high - 0.5) - 1);
  for (let x = Math.max(0, Math.ceil(low - 0.5)); x <= end; ++x) ids[row * width + x] = id;
}

function niceStep(length, pixels) {
  const least = (length / pixels) * 34;
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((one) => one * power).find((one) => one >= least);
}

export class CutView {
  /// @param pick(point [m], i polygon or -1): the pointer is there; choose(point): it was clicked
  constructor(axis, extent, { pick, choose }) {
    Object.assign(this, { axis, extent, ...plane[axis] });
    this.canvas = h("canvas", { class: "cut", onpointermove: (e) => pick?.(this, ...this.at(e)), onpointerleave: () => pick?.(this, null, -1),
      onclick: (e) => this.at(e)[0] && choose?.(this, this.at(e)[0]) });
  }

  static size(extent, axis, scale) {
    const { right, up } = plane[axis];
    return { width: scale * (extent.high[right] - extent.low[right]) + margin.left + margin.right,
      height: scale * (extent.high[up] - extent.low[up]) + margin.top + margin.bottom };
  }

  /// @param scale CSS pixels a metre
  place(polygons, scale) {
    if (!polygons) return;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (this.polygons === polygons && this.scale === scale && this.ratio === ratio) return;
    Object.assign(this, { polygons, scale, ratio });
    const size = CutView.size(this.extent, this.axis, scale);
    this.canvas.width = Math.round(size.width * ratio);
    this.canvas.height = Math.round(size.height * ratio);
    this.canvas.style.width = `${size.width}px`;
    this.canvas.style.height = `${size.height}px`;
    const low = this.extent.low, high = this.extent.high;
    this.toX = (x) => (x - low[this.right]) * scale * ratio;
    this.toY = (y) => (high[this.up] - y) * scale * ratio;
    this.width = Math.max(1, Math.round(this.toX(high[this.right])));
    this.height = Math.max(1, Math.round(this.toY(low[this.up])));
    this.ids = rasterise(polygons, this, this.toX, this.toY, this.width, this.height);
    this.picture = new ImageData(this.width, this.height);
    this.pixels = new Uint32Array(this.picture.data.buffer);
  }

  /// @param lines where the other cuts go through: { axis: at }
  draw(values, colours, lines) {
    const of = new Uint32Array(values.length);
    for (let i = 0; i < values.length; ++i) of[i] = colours.words[colours.index(values[i])];
    const { ids, pixels } = this;
    for (let p = 0; p < ids.length; ++p) pixels[p] = ids[p] < 0 ? 0 : of[ids[p]];
    const context = this.canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.putImageData(this.picture, margin.left * this.ratio, margin.top * this.ratio);
    context.setTransform(this.ratio, 0, 0, this.ratio, margin.left * this.ratio, margin.top * this.ratio);
    this.drawAxes(context);
    this.drawLines(context, lines);
  }

  drawAxes(context) {
    const style = (this.style ??= getComputedStyle(this.canvas));
    const height = this.height / this.ratio, width = this.width / this.ratio;
    context.fillStyle = context.strokeStyle = style.color;
    context.font = `11px ${style.fontFamily}`;
    context.lineWidth = 1;
    const tick = (coordinate, draw, pixels) => {
      const low = this.extent.low[coordinate], high = this.extent.high[coordinate];
      const step = niceStep(high - low, pixels);
      for (let at = Math.ceil(low / step) * step; at <= high + 1e-9; at += step) draw(at, String(Number(at.toFixed(6))));
    };
    context.textAlign = "right";
    context.textBaseline = "middle";
    tick(this.up, (at, text) => {
      const y = this.toY(at) / this.ratio;
      context.fillRect(-5, y - 0.5, 4, 1);
      context.fillText(text, -8, y);
    }, height);
    context.textAlign = "center";
    context.textBaseline = "top";
    tick(this.right, (at, text) => {
      const x = this.toX(at) / this.ratio;
      context.fillRect(x - 0.5, height + 1, 1, 4);
      context.fillText(text, x, height + 7);
    }, width);
    context.textAlign = "right";
    context.fillText(`${names[this.right]} [m]`, width + 6, height + 18);
    context.textAlign = "left";
    context.textBaseline = "top";
    context.fillText(`${names[this.up]} [m]`, -margin.left + 2, height + 18);
  }

  drawLines(context, lines) {
    for (const [axis, at] of Object.entries(lines)) {
      const coordinate = names.indexOf(axis);
      if (axis === this.axis) continue;
      for (const [colour, offset] of [["rgba(0,0,0,.55)", 0], ["rgba(255,255,255,.85)", 4]]) {
        context.strokeStyle = colour;
        context.setLineDash([4, 4]);
        context.lineDashOffset = offset;
        context.beginPath();
        if (coordinate === this.right) {
          context.moveTo(this.toX(at) / this.ratio, 0);
          context.lineTo(this.toX(at) / this.ratio, this.height / this.ratio);
        } else {
          context.moveTo(0, this.toY(at) / this.ratio);
          context.lineTo(this.width / this.ratio, this.toY(at) / this.ratio);
        }
        context.stroke();
      }
      context.setLineDash([]);
    }
  }

  /// @return [point [m] or null, polygon or -1]
  at(event) {
    if (!this.ids) return [null, -1];
    const box = this.canvas.getBoundingClientRect();
    const shrunk = this.canvas.width / this.ratio / box.width;
    const x = (event.clientX - box.left) * shrunk - margin.left, y = (event.clientY - box.top) * shrunk - margin.top;
    const column = Math.floor(x * this.ratio), row = Math.floor(y * this.ratio);
    if (column < 0 || row < 0 || column >= this.width || row >= this.height) return [null, -1];
    const point = [0, 0, 0];
    point[names.indexOf(this.axis)] = this.polygons.at;
    point[this.right] = this.extent.low[this.right] + x / this.scale;
    point[this.up] = this.extent.high[this.up] - y / this.scale;
    return [point, this.ids[row * this.width + column]];
  }
}
