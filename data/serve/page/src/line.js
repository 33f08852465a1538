// The trained line: how the inputs usually go with the load, a parabola through the training cases.
function solve(matrix, right) {
  const a = matrix.map((row, i) => [...row, right[i]]);
  const n = a.length;
  for (let i = 0; i < n; ++i) {
    const pivot = a.slice(i).reduce((best, row, k) => (Math.abs(row[i]) > Math.abs(a[best][i]) ? i + k : best), i);
    [a[i], a[pivot]] = [a[pivot], a[i]];
    for (let k = 0; k < n; ++k) {
      if (k === i) continue;
      const share = a[k][i] / a[i][i];
      for (let j = i; j <= n; ++j) a[k][j] -= share * a[i][j];
    }
  }
  return a.map((row, i) => row[n] / row[i]);
}

/// @return c of c0 + c1 x + c2 x^2, by least squares
function parabola(xs, ys) {
  const sums = [0, 1, 2, 3, 4].map((power) => xs.reduce((sum, x) => sum + x ** power, 0));
  const matrix = [0, 1, 2].map((i) => [0, 1, 2].map((j) => sums[i + j]));
  return solve(matrix, [0, 1, 2].map((power) => xs.reduce((sum, x, i) => sum + ys[i] * x ** power, 0)));
}

/// @param cases as GET /model/cases gives them
/// @return { low, high, at(load): inputs in SI }, or null where the cases tell no loads
export function trainedLine(cases, inputs) {
  const known = cases.items.filter((one) => one.load !== null);
  const loads = known.map((one) => one.load);
  if (new Set(loads).size < 4) return null;
  const fits = inputs.map((_, i) => parabola(loads, known.map((one) => one.values[i])));
  const clamp = (value, input) => Math.min(input.high, Math.max(input.low, value));
  return {
    low: Math.min(...loads), high: Math.max(...loads),
    at: (load) => fits.map((c, i) => clamp(c[0] + load * (c[1] + load * c[2]), inputs[i])),
  };
}
