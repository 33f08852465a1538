// Names, units and numbers as people read them.
const small = { "gas velocity x": "Gas velocity, x", "gas velocity y": "Gas velocity, y", "gas velocity z": "Gas velocity, up",
  "solid velocity x": "Solids velocity, x", "solid velocity y": "Solids velocity, y", "solid velocity z": "Solids velocity, up",
  "solid volume fraction": "Solids volume fraction", "solid diameter": "Solids diameter", pressure: "Pressure" };

export const plain = (name) => name.replaceAll("_", " ").replaceAll("+-", "±");
export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
export const fieldLabel = (name) => small[plain(name)] ?? capital(plain(name));

/// How a field is shown: SI times `factor` is in `unit`.
export function shownUnit(field) {
  if (field.name.includes("diameter") && field.unit === "m") return { factor: 1e6, unit: "µm" };
  if (field.unit === "1") return { factor: 1, unit: "–" };
  return { factor: 1, unit: field.unit };
}
export const isSigned = (name) => name.includes("velocity");
/// From the bed to the exit it falls by orders of magnitude.
export const spansDecades = (name) => name.includes("volume_fraction");
export const unitText = (unit) => ({ 1: "–", um: "µm", degC: "°C" })[unit] ?? unit;

export function number(value, digits = 3) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e6) return value.toExponential(Math.max(0, digits - 2));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(decimals, 6));
}
export const percent = (share) => `${number(100 * share, 3)} %`;
export const time = (seconds) => new Date(1000 * seconds).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });
export const short = (digest) => (digest ? digest.slice(0, 12) : "–");
