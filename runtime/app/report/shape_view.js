// Faces or lines in an orthographic view that turns: near edges are strong, far ones faint.
import {element, number, ordinal} from "./dom.js";
import {numbers} from "./codec.js";

const shades = 8;

class ShapeView {
  constructor(view) {
    // A mesh that a camera has projected is seen as the camera saw it; others from above, to the side.
    Object.assign(this, {view, yaw: view.flat ? 0 : -0.6, pitch: view.flat ? 0 : 0.35, zoom: 1});
    this.canvas = element("canvas", {tabindex: 0, role: "img", "aria-label": "The shape; drag or use the arrow keys to turn it, + and - to zoom",
        onpointerdown: (e) => { this.drag = [e.clientX, e.clientY]; this.canvas.setPointerCapture(e.pointerId); },
        onpointermove: (e) => this.turnTo(e), onpointerup: () => { this.drag = null; }, onkeydown: (e) => this.key(e),
        ondblclick: () => { Object.assign(this, {yaw: view.flat ? 0 : -0.6, pitch: view.flat ? 0 : 0.35, zoom: 1}); this.draw(); }});
    const what = view.type === "faces" ? "faces" : "lines of the control net";
    const shown = view.shown < view.total ? `Every ${ordinal(Math.round(view.total / view.shown))} of ${number(view.total)} ${what}` : `All ${number(view.total)} ${what}`;
    this.element = element("div", {class: "viewer"}, element("div", {class: "stage shape"}, this.canvas),
                           element("p", {class: "soft small", style: "margin-top:.4rem"}, `${shown}, ${view.space} space; drag to turn, double click to reset.`));
    new ResizeObserver(() => this.draw()).observe(this.element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    document.addEventListener("themechange", () => this.draw());
  }

  async load() {
    [this.positions, this.indices] = await Promise.all([numbers(this.view.positions), numbers(this.view.indices)]);
    this.measure();
    this.draw();
    this.element.dataset.ready = "true";
  }

  // The box of the finite points, so that one bad vertex does not hide the rest.
  measure() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    this.positions.forEach((v, i) => { if (Number.isFinite(v)) low[i % 3] = Math.min(low[i % 3], v), high[i % 3] = Math.max(high[i % 3], v); });
    this.center = low.map((l, k) => (Number.isFinite(l) ? (l + high[k]) / 2 : 0));
    const size = low.map((l, k) => (Number.isFinite(l) ? high[k] - l : 0));
    // Projected depths have another scale than pixels: they are stretched to the size of the picture.
    this.depthScale = this.view.flat && size[2] > 0 ? Math.max(size[0], size[1]) / size[2] / 2 : 1;
    this.extent = this.extents();
  }

  // Half the width and height of what is seen before it is turned.
  extents() {
    const points = this.projected(0, 0, 1), most = [0, 0];
    points.forEach((v, i) => { if (i % 3 < 2 && Number.isFinite(v)) most[i % 3] = Math.max(most[i % 3], Math.abs(v)); });
    return most.map((v) => v || 1);
  }

  // Pixels a unit, such that all of it is in sight.
  scaleFor(width, height) { return this.zoom * 0.86 * Math.min(width / 2 / this.extent[0], height / 2 / this.extent[1]); }

  turnTo(event) {
    if (!this.drag) return;
    this.yaw += (event.clientX - this.drag[0]) * 0.01;
    this.pitch = Math.max(-1.57, Math.min(1.57, this.pitch + (event.clientY - this.drag[1]) * 0.01));
    this.drag = [event.clientX, event.clientY];
    requestAnimationFrame(() => this.draw());
  }

  key(event) {
    const turns = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]}, zooms = {"+": 1.15, "=": 1.15, "-": 1 / 1.15};
    if (turns[event.key]) this.yaw += turns[event.key][0], this.pitch += turns[event.key][1];
    else if (zooms[event.key]) this.zoom *= zooms[event.key];
    else return;
    event.preventDefault();
    this.draw();
  }

  // x, y on the canvas and depth (towards the viewer) of every point.
  projected(width, height, scale) {
    const n = this.positions.length / 3, out = new Float32Array(3 * n), [cy, sy, cx, sx] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    for (let i = 0; i < n; ++i) {
      const x = this.positions[3 * i] - this.center[0], y = this.positions[3 * i + 1] - this.center[1], z = (this.positions[3 * i + 2] - this.center[2]) * this.depthScale;
      const u = cy * x + sy * z, d = -sy * x + cy * z;
      out[3 * i] = width / 2 + scale * u;
      out[3 * i + 1] = height / 2 - scale * (cx * y - sx * d);
      out[3 * i + 2] = (sx * y + cx * d) * (this.view.flat ? -1 : 1);
    }
    return out;
  }

  draw() {
    if (!this.positions) return;
    const ratio = globalThis.devicePixelRatio || 1, width = this.canvas.clientWidth, height = Math.round(Math.min(460, Math.max(240, width * 0.56)));
    if (width === 0) return;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.canvas.style.height = `${height}px`;
    const context = this.canvas.getContext("2d"), points = this.projected(width, height, this.scaleFor(width, height)), per = this.view.type === "faces" ? 3 : 2;
    const buckets = Array.from({length: shades}, () => new Path2D());
    let near = -Infinity, far = Infinity;
    for (let i = 2; i < points.length; i += 3) if (Number.isFinite(points[i])) near = Math.max(near, points[i]), far = Math.min(far, points[i]);
    for (let i = 0; i < this.indices.length; i += per) {
      const corners = Array.from({length: per}, (_, k) => 3 * this.indices[i + k]);
      const depth = corners.reduce((s, c) => s + points[c + 2], 0) / per;
      if (!corners.every((c) => Number.isFinite(points[c]) && Number.isFinite(points[c + 1]))) continue;
      const bucket = buckets[Math.min(shades - 1, Math.max(0, Math.floor((depth - far) / (near - far || 1) * shades) || 0))];
      bucket.moveTo(points[corners[0]], points[corners[0] + 1]);
      for (const c of corners.slice(1)) bucket.lineTo(points[c], points[c + 1]);
      if (per === 3) bucket.closePath();
    }
    context.scale(ratio, ratio);
    context.strokeStyle = getComputedStyle(this.element).getPropertyValue("--accent");
    const dense = Math.min(1, 3000 / (this.indices.length / per));
    context.lineWidth = 0.45 + 0.5 * dense;
    buckets.forEach((path, i) => {
      context.globalAlpha = (0.1 + 0.75 * ((i + 1) / shades) ** 1.6) * (0.45 + 0.55 * dense);
      context.stroke(path);
    });
  }
}

export function shapeView(view) {
  const v = new ShapeView(view);
  return {element: v.element, load: () => v.load()};
}
