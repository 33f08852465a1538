// Switches of the report's page: which score the table shows, and which case and field the cuts are drawn of.
"use strict";
(() => {
  const $ = (selector) => document.querySelector(selector);
  const all = (selector) => [...document.querySelectorAll(selector)];

  let redraw = () => {};  // the cuts, where the page has them

  // Theme: follows the system until the reader chooses.
  const themeButton = $("#theme");
  const isDark = () => {
    const chosen = document.documentElement.dataset.theme;
    return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  };
  themeButton.addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    redraw();
  });

  // Score tables: one is visible at a time.
  all("[data-score-button]").forEach((button) => button.addEventListener("click", () => {
    all("[data-score-button]").forEach((other) => other.setAttribute("aria-pressed", String(other === button)));
    all("[data-score]").forEach((table) => { table.hidden = table.dataset.score !== button.dataset.scoreButton; });
  }));

  const source = $("#cut-data");
  if (!source) return;
  const data = JSON.parse(source.textContent);
  const state = { field: 0, case: 0, method: 0, third: "difference", log: false };
  const maps = { sequential: parseMap(data.sequential), diverging: parseMap(data.diverging) };
  const cache = new Map();
  const slots = all(".slices canvas");

  function parseMap(hex) {
    return Array.from({ length: 256 }, (_, i) => "#" + hex.slice(6 * i, 6 * i + 6));
  }
  function bytesOf(base64) {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
  }
  // 16-bit steps between the series' own extremes, little-endian.
  function valuesOf(series) {
    if (!series) return null;
    if (!cache.has(series)) {
      const view = new DataView(bytesOf(series.data).buffer);
      const step = (series.high - series.low) / 65535;
      cache.set(series, Float64Array.from({ length: view.byteLength / 2 },
        (_, i) => series.low + step * view.getUint16(2 * i, true)));
    }
    return cache.get(series);
  }
  const corners = data.cuts.map((cut) => {
    const view = new DataView(bytesOf(cut.corners).buffer);
    return Float32Array.from({ length: view.byteLength / 2 }, (_, i) => view.getUint16(2 * i, true) * cut.step);
  });
  const extents = corners.map((list) => {
    let width = 0, height = 0;
    for (let i = 0; i < list.length; i += 2) {
      width = Math.max(width, list[i]);
      height = Math.max(height, list[i + 1]);
    }
    return { width, height };
  });
  function quantile(values, share) {
    const sorted = Float64Array.from(values).sort();
    return sorted[Math.min(sorted.length - 1, Math.round(share * (sorted.length - 1)))];
  }
  // Colours of truth and prediction: one scale, from the truth; signed fields are centred on zero.
  function scaleOf(truth, log) {
    const low = quantile(truth, 0.005), high = quantile(truth, 0.995);
    if (low < 0 && high > 0) {
      const reach = Math.max(-low, high);
      return { low: -reach, high: reach, map: maps.diverging, log: false };
    }
    if (log) {
      const positive = truth.filter((v) => v > 0);
      return { low: Math.max(quantile(positive, 0.02), 1e-4 * high), high, map: maps.sequential, log: true };
    }
    return { low, high: high > low ? high : low + 1, map: maps.sequential, log: false };
  }
  function colourOf(scale, value) {
    let t = scale.log ? Math.log(Math.max(value, scale.low) / scale.low) / Math.log(scale.high / scale.low)
                      : (value - scale.low) / (scale.high - scale.low);
    t = Math.min(1, Math.max(0, t));
    return scale.map[Math.round(255 * t)];
  }
  function shown(value, field) {
    const v = value * field.factor;
    return Math.abs(v) >= 1e5 || (v !== 0 && Math.abs(v) < 1e-3) ? v.toExponential(2) : String(Number(v.toPrecision(4)));
  }
  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const margin = { left: 34, right: 4, top: 20, bottom: 34, between: 12, bar: 46 };

  // Both cuts side by side on one scale of metres; a colour bar beneath.
  function drawPanel(canvas, values, scale, field) {
    const width = canvas.clientWidth;
    const metres = extents.reduce((sum, e) => sum + e.width, 0);
    const tall = Math.max(...extents.map((e) => e.height));
    const perMetre = (width - margin.left - margin.right - margin.between * (extents.length - 1)) / metres;
    const height = margin.top + tall * perMetre + margin.bottom + margin.bar;
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = height + "px";
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, 'DejaVu Sans', sans-serif";
    const floor = margin.top + tall * perMetre;
    const places = [];
    let left = margin.left, offset = 0;
    data.cuts.forEach((cut, k) => {
      const list = corners[k], n = list.length / 8;
      for (let i = 0; i < n; ++i) {
        pen.fillStyle = pen.strokeStyle = colourOf(scale, values[offset + i]);
        pen.lineWidth = 1;
        pen.beginPath();
        for (let c = 0; c < 4; ++c) pen.lineTo(left + list[8 * i + 2 * c] * perMetre, floor - list[8 * i + 2 * c + 1] * perMetre);
        pen.closePath();
        pen.fill();
        pen.stroke();
      }
      places.push({ left, offset, n });
      drawAxes(pen, cut, k, left, floor, perMetre);
      left += extents[k].width * perMetre + margin.between;
      offset += n;
    });
    drawBar(pen, scale, field, width, floor + margin.bottom + 8);
    canvas.layout = { places, perMetre, floor };
  }
  function drawAxes(pen, cut, k, left, floor, perMetre) {
    pen.fillStyle = ink("--soft");
    pen.strokeStyle = ink("--line");
    pen.lineWidth = 1;
    pen.textAlign = "center";
    const middle = left + extents[k].width * perMetre / 2;
    pen.fillText(cut.title, middle, margin.top - 8);
    const step = extents[k].width > 15 ? 10 : 5;
    const [u0, z0] = cut.low;
    for (let u = Math.ceil(u0 / step) * step; u <= u0 + extents[k].width; u += step) {
      const at = left + (u - u0) * perMetre;
      pen.beginPath();
      pen.moveTo(at, floor + 1);
      pen.lineTo(at, floor + 5);
      pen.stroke();
      pen.fillText(String(u), at, floor + 17);
    }
    pen.fillText(cut.horizontal, middle, floor + 31);
    if (k > 0) return;
    pen.textAlign = "right";
    for (let z = Math.ceil(z0 / 10) * 10; z <= z0 + extents[k].height; z += 10) {
      const at = floor - (z - z0) * perMetre;
      pen.beginPath();
      pen.moveTo(left - 5, at);
      pen.lineTo(left - 1, at);
      pen.stroke();
      pen.fillText(String(z), left - 8, at + 4);
    }
    pen.save();
    pen.translate(10, (margin.top + floor) / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(cut.vertical, 0, 0);
    pen.restore();
  }
  function drawBar(pen, scale, field, width, top) {
    const left = margin.left, length = width - margin.left - margin.right;
    for (let i = 0; i < 256; ++i) {
      pen.fillStyle = scale.map[i];
      pen.fillRect(left + length * i / 256, top, length / 256 + 0.6, 10);
    }
    pen.fillStyle = ink("--soft");
    const marks = scale.log ? [scale.low, Math.sqrt(scale.low * scale.high), scale.high]
                            : [scale.low, (scale.low + scale.high) / 2, scale.high];
    marks.forEach((value, i) => {
      pen.textAlign = ["left", "center", "right"][i];
      const unit = i === 2 && field.unit !== "1" ? " " + field.unit : "";
      pen.fillText(shown(value, field) + unit, left + length * i / 2, top + 24);
    });
  }

  // Every canvas says what it shows: a series ("0" is the truth), the one that was chosen, or a difference of two.
  function shownOf(canvas, series) {
    const of = (name) => valuesOf(series[name === "chosen" ? state.method + 1 : Number(name)]) || valuesOf(series[1]);
    const [a, b] = canvas.dataset.series.split("-");
    if (b === undefined) return of(a);
    const minus = of(b);
    return of(a).map((v, i) => v - minus[i]);
  }
  const isDifference = (canvas) => canvas.dataset.series.includes("-");

  let current = null;
  function draw() {
    const field = data.fields[state.field];
    const series = field.cases[state.case];
    const truth = valuesOf(series[0]);
    const scale = scaleOf(truth, state.log);
    const values = slots.map((canvas) => shownOf(canvas, series));
    const differences = values.filter((_, k) => isDifference(slots[k]));
    const reach = Math.max(...differences.map((list) => quantile(list.map(Math.abs), 0.99))) || 1;
    slots.forEach((canvas, k) => drawPanel(canvas, values[k], isDifference(canvas)
      ? { low: -reach, high: reach, map: maps.diverging, log: false } : scale, field));
    current = { field, values };
    const chosen = $("#cut-method-name");
    if (chosen) chosen.textContent = data.methods[state.method];
    $("#cut-log").closest("label").hidden = truth.some((v) => v < 0);
    all("[data-profile-case]").forEach((figure) => { figure.hidden = Number(figure.dataset.profileCase) !== state.case; });
  }

  // The cell under the pointer, by its quadrilateral.
  function contains(list, i, x, y) {
    let inside = true;
    for (let c = 0; c < 4; ++c) {
      const d = (c + 1) % 4;
      const ax = list[8 * i + 2 * c], ay = list[8 * i + 2 * c + 1];
      const bx = list[8 * i + 2 * d], by = list[8 * i + 2 * d + 1];
      inside = inside && (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0;
    }
    return inside;
  }
  function readOut(event) {
    const canvas = event.target, box = canvas.getBoundingClientRect(), layout = canvas.layout;
    if (!layout || !current) return;
    layout.places.forEach((place, k) => {
      const u = (event.clientX - box.left - place.left) / layout.perMetre;
      const z = (layout.floor - (event.clientY - box.top)) / layout.perMetre;
      for (let i = 0; i < place.n; ++i) {
        if (!contains(corners[k], i, u, z)) continue;
        const at = place.offset + i, unit = current.field.unit === "1" ? "" : " " + current.field.unit;
        const where = data.cuts[k].title + ", " + data.cuts[k].horizontal[0] + " = " +
          (u + data.cuts[k].low[0]).toFixed(1) + " m, z = " + (z + data.cuts[k].low[1]).toFixed(1) + " m: ";
        const readout = $("#readout");
        readout.textContent = where;
        slots.forEach((slot, j) => {
          const value = document.createElement("b");
          value.textContent = shown(current.values[j][at], current.field) + unit;
          readout.append((j > 0 ? ", " : "") + slot.parentElement.querySelector("h3").textContent + " ", value);
        });
        return;
      }
    });
  }
  slots.forEach((canvas) => canvas.addEventListener("pointermove", readOut));

  const bind = (selector, key, read) => all(selector).forEach((control) => control.addEventListener("change", () => {
    state[key] = read(control);
    all(selector).forEach((other) => { if (other !== control && "value" in other) other.value = control.value; });
    draw();
  }));
  bind("#cut-field", "field", (control) => Number(control.value));
  bind("#cut-case, #profile-case", "case", (control) => Number(control.value));
  bind("#cut-method", "method", (control) => Number(control.value));
  bind("#cut-log", "log", (control) => control.checked);
  $("#cut-field").addEventListener("change", () => {
    state.log = data.fields[state.field].log;
    $("#cut-log").checked = state.log;
    draw();
  });
  state.field = Number($("#cut-field").value);
  state.log = data.fields[state.field].log;
  $("#cut-log").checked = state.log;
  let pending = 0;
  addEventListener("resize", () => { cancelAnimationFrame(pending); pending = requestAnimationFrame(draw); });
  addEventListener("beforeprint", draw);
  redraw = draw;
  draw();
})();
