// Colour scales: one for amounts, one for what has a sign, and their bar.
import { h } from "./dom.js";
import { number } from "./words.js";

const steps = 256;
const stops = {
  amount: ["#1b1040", "#2f3c8f", "#1f7a9c", "#35ac7f", "#a3cf52", "#fbe861"],
  signed: ["#0c3b7c", "#3f83c4", "#a9cbe4", "#f2f0ea", "#efb899", "#d0583f", "#7f1220"],
};

const channels = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

/// (steps) of bytes as canvases and WebGL want them: red, green, blue, opaque.
function ramp(colours) {
  const anchors = colours.map(channels);
  const bytes = new Uint8ClampedArray(4 * steps);
  for (let i = 0; i < steps; ++i) {
    const place = (i / (steps - 1)) * (anchors.length - 1);
    const k = Math.min(Math.floor(place), anchors.length - 2);
    for (let c = 0; c < 3; ++c) bytes[4 * i + c] = anchors[k][c] + (place - k) * (anchors[k + 1][c] - anchors[k][c]);
    bytes[4 * i + 3] = 255;
  }
  return bytes;
}
const ramps = { amount: ramp(stops.amount), signed: ramp(stops.signed) };

/// Values to colours between `low` and `high`. How: "amount", "signed" (symmetric about 0) or "log" (above 0).
export class Scale {
  constructor(low, high, how) {
    const size = Math.max(Math.abs(low), Math.abs(high));
    [this.low, this.high] = how === "signed" ? [-size, size] : how === "log" ? [Math.max(low, high / decades), high] : [low, high];
    if (!(this.high > this.low)) this.high = this.low + (Math.abs(this.low) || 1) * 1e-3;
    this.how = how;
    this.bytes = ramps[how === "signed" ? "signed" : "amount"];
    this.words = new Uint32Array(this.bytes.buffer);
    this.begin = this.along(this.low);
    this.factor = (steps - 1) / (this.along(this.high) - this.begin);
  }
  along(value) {
    return this.how === "log" ? Math.log(Math.max(value, 1e-30)) : value;
  }
  index(value) {
    const place = Math.round((this.along(value) - this.begin) * this.factor);
    return place < 0 ? 0 : place >= steps ? steps - 1 : place;
  }
  /// The value at a share of the bar.
  at(share) {
    return this.how === "log" ? this.low * (this.high / this.low) ** share : this.low + share * (this.high - this.low);
  }
}
const decades = 1e4; // of a logarithmic scale at most

/// Without the outermost half per cent, which a single cell may have to itself.
export function rangeOf(arrays, how) {
  const all = Float32Array.from(arrays.flatMap((one) => Array.from(one))).sort();
  const at = (share) => all[Math.min(all.length - 1, Math.round(share * (all.length - 1)))];
  return new Scale(at(0.005), at(0.995), how);
}

export class ColourBar {
  constructor() {
    this.canvas = h("canvas", { width: steps, height: 1, class: "ramp" });
    this.labels = h("div", { class: "ramp-labels" });
    this.element = h("div", { class: "colour-bar", role: "img" }, this.canvas, this.labels);
  }
  show(scale, factor, unit, name) {
    this.canvas.getContext("2d").putImageData(new ImageData(scale.bytes, steps, 1), 0, 0);
    const marks = [0, 0.25, 0.5, 0.75, 1].map((share) => number(factor * scale.at(share), 3));
    this.labels.replaceChildren(...marks.map((mark) => h("span", {}, mark)));
    this.element.setAttribute("aria-label", `Colours: ${name} from ${marks[0]} to ${marks[4]} ${unit}`);
  }
}
