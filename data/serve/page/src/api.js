// Requests to the server that the page came from. A token lives as long as the browser's tab.
const place = "elrom-token";

export class Refused extends Error {
  constructor(problem) {
    super(problem.detail ?? "the server does not answer");
    this.problem = problem;
  }
}

export const hasToken = () => sessionStorage.getItem(place) !== null;
export const setToken = (token) => (token ? sessionStorage.setItem(place, token) : sessionStorage.removeItem(place));

async function problemOf(response) {
  try {
    return await response.json();
  } catch {
    return { status: response.status, detail: `${response.status} ${response.statusText}` };
  }
}

async function ask(method, path, { body, accept = "application/json", headers = {}, signal } = {}) {
  const token = sessionStorage.getItem(place);
  const response = await fetch(path, {
    method, signal, body: body && JSON.stringify(body),
    headers: { Accept: accept, ...(token && { Authorization: `Bearer ${token}` }),
      ...(body && { "Content-Type": "application/json" }), ...headers },
  }).catch((error) => {
    throw new Refused({ status: 0, detail: `the server cannot be reached (${error.message})` });
  });
  if (!response.ok) throw new Refused(await problemOf(response));
  return response;
}

export const get = async (path) => (await ask("GET", path)).json();
export const put = async (path, body) => (await ask("PUT", path, { body })).json();
/// A write that is done once, however often it is sent.
export const post = async (path, body) =>
  (await ask("POST", path, { body, headers: { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` } })).json();

/// All of a list, the newest first; of very long ones the newest thousands are enough for a page.
export async function list(path) {
  const items = [];
  for (let next = 0; next !== null; ) {
    const part = await get(`${path}${path.includes("?") ? "&" : "?"}limit=1000&after=${next}`);
    items.push(...part.items);
    next = part.next;
  }
  return items.reverse();
}

/// A JSON header and numbers of four bytes behind it (see GET /openapi.json).
function unframed(buffer) {
  const length = Number(new DataView(buffer).getBigUint64(0, true));
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  const view = (Kind) => ([begin, end]) => new Kind(buffer, 8 + length + 4 * begin, end - begin);
  return { head, floats: view(Float32Array), ints: view(Int32Array) };
}
const binary = "application/octet-stream";

export async function predict(request) {
  return unframed(await (await ask("POST", "/predictions", { body: request, accept: binary })).arrayBuffer());
}

const cuts = new Map();
/// Polygons of a cut; kept, since the mesh stays.
export async function cut(axis, at, mesh) {
  const key = `${mesh} ${axis} ${at}`;
  if (!cuts.has(key)) {
    const response = await ask("GET", `/mesh/cut?axis=${axis}&at=${at}`, { accept: binary });
    const { head, floats, ints } = unframed(await response.arrayBuffer());
    if (cuts.size > 300) cuts.delete(cuts.keys().next().value);
    cuts.set(key, { axis, at, cells: ints(head.cells), offsets: ints(head.offsets), points: floats(head.points) });
  }
  return cuts.get(key);
}

/// Values of a kept file along a cut, in the order of its polygons: { name: values }; empty: it is on another mesh.
export async function fieldsCut(digest, axis, at) {
  const { head, floats } = unframed(await (await ask("GET", `/fields/${digest}/cut?axis=${axis}&at=${at}`, { accept: binary })).arrayBuffer());
  return Object.fromEntries(Object.entries(head.fields ?? {}).map(([name, of]) => [name, floats(of.values)]));
}

async function save(response, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await response.blob());
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
export async function download(request, name) {
  await save(await ask("POST", "/predictions/file", { body: request, accept: "*/*" }), name);
}
export async function downloadFields(digest) {
  await save(await ask("GET", `/fields/${digest}`, { accept: "application/x-hdf5" }), `${digest.slice(0, 12)}.hdf`);
}
