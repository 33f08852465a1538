// The cuts where they lie in the furnace, in three dimensions. Loaded when it is first looked at.
import "@kitware/vtk.js/Rendering/Profiles/Geometry";
import vtkGenericRenderWindow from "@kitware/vtk.js/Rendering/Misc/GenericRenderWindow";
import vtkActor from "@kitware/vtk.js/Rendering/Core/Actor";
import vtkMapper from "@kitware/vtk.js/Rendering/Core/Mapper";
import vtkPolyData from "@kitware/vtk.js/Common/DataModel/PolyData";
import vtkDataArray from "@kitware/vtk.js/Common/Core/DataArray";

const rgb = (text) => text.match(/\d+(\.\d+)?/g).slice(0, 3).map((one) => Number(one) / 255);

/// Cells as VTK lists them: count, points, count, points ...
function facesOf({ offsets }) {
  const faces = [];
  for (let i = 0; i + 1 < offsets.length; ++i) {
    faces.push(offsets[i + 1] - offsets[i]);
    for (let k = offsets[i]; k < offsets[i + 1]; ++k) faces.push(k);
  }
  return Uint32Array.from(faces);
}

/// Each polygon's points are its own, so that its colour is too.
function coloursOf({ offsets }, values, scale) {
  const bytes = new Uint8Array(3 * offsets[offsets.length - 1]);
  for (let i = 0; i + 1 < offsets.length; ++i) {
    const at = 4 * scale.index(values[i]);
    for (let k = offsets[i]; k < offsets[i + 1]; ++k) bytes.set(scale.bytes.subarray(at, at + 3), 3 * k);
  }
  return vtkDataArray.newInstance({ name: "colours", numberOfComponents: 3, values: bytes });
}

/// The furnace's edges: how wide it is at each height, told by a cut across.
function edgesOf(polygons, extent) {
  const widths = new Map();
  for (let k = 0; k < polygons.points.length; k += 3) {
    const z = polygons.points[k + 2].toFixed(3), x = polygons.points[k];
    const [low, high] = widths.get(z) ?? [Infinity, -Infinity];
    widths.set(z, [Math.min(low, x), Math.max(high, x)]);
  }
  const rows = [...widths].map(([z, [low, high]]) => [Number(z), low, high]).sort((a, b) => a[0] - b[0]);
  const points = [], lines = [];
  const polyline = (all) => {
    lines.push(all.length, ...all.map((_, i) => points.length / 3 + i));
    points.push(...all.flat());
  };
  for (const y of [extent.low[1], extent.high[1]])
    for (const side of [1, 2]) polyline(rows.map((row) => [row[side], y, row[0]]));
  for (const [z, low, high] of [rows[0], rows[rows.length - 1]]) {
    const [front, back] = [extent.low[1], extent.high[1]];
    polyline([[low, front, z], [high, front, z], [high, back, z], [low, back, z], [low, front, z]]);
  }
  return { points: Float32Array.from(points), lines: Uint32Array.from(lines) };
}

export class Space {
  constructor(container, extent) {
    this.container = container;
    this.extent = extent;
    this.window = vtkGenericRenderWindow.newInstance({ background: [0, 0, 0, 0], listenWindowResize: false });
    this.window.setContainer(container);
    this.renderer = this.window.getRenderer();
    this.parts = new Map();
    this.observer = new ResizeObserver(() => this.window.resize());
    this.observer.observe(container);
  }

  part(key) {
    if (!this.parts.has(key)) {
      const data = vtkPolyData.newInstance();
      const mapper = vtkMapper.newInstance();
      mapper.setInputData(data);
      const actor = vtkActor.newInstance();
      actor.setMapper(mapper);
      actor.getProperty().setLighting(false);
      this.renderer.addActor(actor);
      this.parts.set(key, { data, mapper, actor });
    }
    return this.parts.get(key);
  }

  /// @param cuts [{ polygons, values }] in the order of `axes`
  show(cuts, scale) {
    for (const { polygons, values } of cuts) {
      const part = this.part(polygons.axis);
      if (part.polygons !== polygons) {
        part.data.getPoints().setData(polygons.points, 3);
        part.data.getPolys().setData(facesOf(polygons));
        part.polygons = polygons;
      }
      part.data.getPointData().setScalars(coloursOf(polygons, values, scale));
      part.mapper.setColorModeToDirectScalars();
      part.data.modified();
    }
    this.drawEdges(cuts.find((one) => one.polygons.axis === "y").polygons);
    this.aim();
    this.window.getRenderWindow().render();
  }

  drawEdges(across) {
    const part = this.part("edges");
    if (!part.polygons) {
      const { points, lines } = edgesOf(across, this.extent);
      part.data.getPoints().setData(points, 3);
      part.data.getLines().setData(lines);
      part.data.modified();
      part.polygons = across;
    }
    part.actor.getProperty().setColor(...rgb(getComputedStyle(this.container).color));
  }

  aim() {
    if (this.aimed) return;
    this.aimed = true;
    const camera = this.renderer.getActiveCamera();
    const { low, high } = this.extent;
    const middle = low.map((one, i) => (one + high[i]) / 2);
    camera.setFocalPoint(...middle);
    camera.setViewUp(0, 0, 1);
    camera.setPosition(middle[0] + 90, middle[1] - 62, middle[2] + 36);
    this.renderer.resetCamera();
    camera.zoom(1.05);
    this.renderer.resetCameraClippingRange();
  }

  /// For who has no mouse.
  turn(azimuth, elevation, zoom = 1) {
    const camera = this.renderer.getActiveCamera();
    camera.azimuth(azimuth);
    camera.elevation(elevation);
    camera.zoom(zoom);
    camera.orthogonalizeViewUp();
    this.renderer.resetCameraClippingRange();
    this.window.getRenderWindow().render();
  }

  close() {
    this.observer.disconnect();
    this.window.delete();
  }
}
