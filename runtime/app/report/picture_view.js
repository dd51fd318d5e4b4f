// A picture: exposure, channels, false colour, marks on what is not finite, and a probe with the stored values.
import {element, exact, number} from "./dom.js";
import {idColor, overCheckerboard, srgbByte, srgbLinear, turbo} from "./color.js";
import {numbers} from "./codec.js";
import {histogram} from "./histogram.js";

// "display" values are encoded for a screen already; all others are linear light or plain data.
const isDisplay = (space) => /srgb|display|rec709$|gamma/i.test(space) && !/^lin/i.test(space);

// What can be looked at: the colour, if there is one, groups of x y z or u v, and each plane.
function channelsOf(planes) {
  const names = planes.map((p) => p.name), list = [];
  const find = (...wanted) => wanted.map((n) => names.indexOf(n));
  const prefixes = [...new Set(names.map((n) => n.match(/^(.*\.)?R$/)?.[1] ?? (/^R$/.test(n) ? "" : null)).filter((p) => p !== null))];
  for (const p of prefixes) {
    const rgb = find(`${p}R`, `${p}G`, `${p}B`);
    if (rgb.every((i) => i >= 0)) list.push({name: `${p}RGB`, planes: rgb, mode: "color", alpha: names.indexOf(`${p}A`)});
  }
  for (const p of [...new Set(names.map((n) => n.match(/^(.*)\.x$/)?.[1]).filter(Boolean))]) {
    const xyz = find(`${p}.x`, `${p}.y`, `${p}.z`);
    if (xyz.every((i) => i >= 0)) list.push({name: `${p} as colour`, planes: xyz, mode: "direction"});
  }
  names.forEach((n, i) => list.push({name: n, planes: [i], mode: planes[i].data.kind === "u32" ? "id" : "plane"}));
  return list;
}

// The range that false colour and grey span: what lies between the 1st and 99th percentile of the whole buffer.
function rangeOf(statistics) {
  const low = statistics?.percentiles?.["1"] ?? statistics?.min ?? 0, high = statistics?.percentiles?.["99"] ?? statistics?.max ?? 1;
  if (typeof low !== "number" || typeof high !== "number") return [0, 1];
  return low < high ? [low, high] : [statistics.min, statistics.max > statistics.min ? statistics.max : statistics.min + 1];
}

class PictureView {
  constructor(view, summary) {
    Object.assign(this, {view, summary, planes: [], at: null, scale: 1});
    this.channels = channelsOf(view.planes);
    this.channel = this.channels[0];
    this.display = isDisplay(view.color_space);
    this.exposure = 0;
    this.falseColor = this.channel.mode === "plane";
    this.build();
  }

  build() {
    const {view} = this;
    this.canvas = element("canvas", {width: view.width, height: view.height, tabindex: 0, role: "img",
        "aria-label": "The picture; arrow keys move the probe",
        onmousemove: (e) => this.pointAt(e), onclick: (e) => this.pointAt(e), onkeydown: (e) => this.key(e)});
    this.mark = element("div", {class: "probe-mark", hidden: true});
    this.stage = element("div", {class: "stage"}, element("div", {style: "position:relative;width:max-content;margin:0 auto"}, this.canvas, this.mark));
    this.readout = element("div", {class: "probe", "aria-live": "polite"}, element("p", {class: "soft"}, "Point at a pixel, or use the arrow keys."));
    this.distribution = element("div");
    const select = element("select", {"aria-label": "Channel", onchange: () => this.setChannel(this.channels[select.value])},
                           this.channels.map((c, i) => element("option", {value: i}, c.name)));
    this.stops = element("input", {type: "range", min: -10, max: 10, step: 0.25, value: 0, "aria-label": "Exposure in stops",
        oninput: () => { this.exposure = Number(this.stops.value); this.stopsText.textContent = this.stopText(); this.draw(); },
        ondblclick: () => { this.stops.value = 0; this.stops.dispatchEvent(new Event("input")); }});
    this.stopsText = element("output", {style: "min-width:3.6rem;display:inline-block"}, this.stopText());
    this.falseButton = element("button", {"aria-pressed": this.falseColor, onclick: () => this.setFalse(!this.falseColor)}, "False colour");
    const zoom = element("select", {"aria-label": "Size", onchange: () => { this.scale = zoom.value === "fit" ? null : Number(zoom.value); this.resize(); }},
        [["fit", "Fit"], [1, "100 %"], [2, "200 %"], [4, "400 %"], [8, "800 %"]].map(([v, t]) => element("option", {value: v}, t)));
    this.scale = null;
    this.element = element("div", {class: "viewer"},
        element("div", {class: "tools"}, element("label", {class: "field"}, "Channel", select), this.falseButton,
                element("label", {class: "field"}, "Exposure", this.stops, this.stopsText), element("label", {class: "field"}, "Size", zoom)),
        element("div", {class: "split"}, this.stage, element("div", {class: "side"},
            element("div", {}, element("h3", {}, "Pixel"), this.readout), element("div", {}, element("h3", {}, "Distribution"), this.distribution))));
    this.setDistribution();
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  async load() {
    this.planes = await Promise.all(this.view.planes.map((p) => numbers(p.data)));
    this.draw();
    this.element.dataset.ready = "true";
  }

  stopText() { return `${this.exposure > 0 ? "+" : ""}${number(this.exposure)} EV`; }
  statistics(plane) { return this.summary.planes[plane]; }

  setChannel(channel) {
    this.channel = channel;
    if (channel.mode !== "plane") this.falseColor = false;
    this.setDistribution();
    this.setFalse(channel.mode === "plane" && !["R", "G", "B", "A"].includes(channel.name));
  }

  setFalse(on) {
    this.falseColor = on;
    this.falseButton.setAttribute("aria-pressed", on);
    this.setDistribution();
    this.draw();
  }

  setDistribution() {
    this.distribution.replaceChildren(...this.channel.planes.map((p) => {
      const s = this.statistics(p);
      const odd = ["nan", "positive_infinity", "negative_infinity"].filter((k) => s[k] > 0).map((k) => `${number(s[k])} ${k.replace("_", " ")}`);
      return element("div", {style: "margin-bottom:.5rem"},
                     element("div", {class: "small soft"}, this.view.planes[p].name, odd.length > 0 ? `: ${odd.join(", ")}` : ""),
                     s.histogram ? histogram(s.histogram, s.min, s.max) : element("p", {class: "small"}, "no finite value"));
    }));
    if (this.falseColor && this.channel.mode === "plane") {
      const [low, high] = rangeOf(this.statistics(this.channel.planes[0]));
      const ramp = Array.from({length: 17}, (_, i) => `rgb(${turbo(i / 16).join()})`).join();
      this.distribution.append(element("div", {class: "ramp", style: `background:linear-gradient(to right,${ramp})`}),
                               element("div", {class: "axis"}, element("span", {}, number(low, 4)), element("span", {}, number(high, 4))));
    }
  }

  // Writes the colour of value(s) i into out[4 i ...]; one function for each way of looking, so that the loop has no choice in it.
  painter(out) {
    const {channel} = this, gain = 2 ** this.exposure, p = channel.planes.map((i) => this.planes[i]);
    const put = (i, r, g, b) => { out[4 * i] = r; out[4 * i + 1] = g; out[4 * i + 2] = b; out[4 * i + 3] = 255; };
    if (channel.mode === "id") return (i) => p[0][i] === 0xffffffff ? (out[4 * i + 3] = 0) : put(i, ...idColor(p[0][i]));
    if (channel.mode === "direction") {
      const byte = (v) => Math.round(255 * Math.min(1, Math.max(0, 0.5 + 0.5 * v * gain)));
      return (i) => put(i, byte(p[0][i]), byte(p[1][i]), byte(p[2][i]));
    }
    if (channel.mode === "plane" && this.falseColor) {
      const [low, high] = rangeOf(this.statistics(channel.planes[0])), lut = Array.from({length: 256}, (_, i) => turbo(i / 255));
      const scale = 255 * gain / (high - low);
      return (i) => put(i, ...lut[Math.min(255, Math.max(0, Math.round((p[0][i] - low) * scale)))]);
    }
    const byte = this.display ? (v) => srgbByte(gain * srgbLinear(Math.max(0, v))) : (v) => srgbByte(gain * v);
    if (channel.mode === "plane" && !["R", "G", "B", "A"].includes(channel.name.replace(/^.*\./, ""))) {
      const [low, high] = rangeOf(this.statistics(channel.planes[0]));
      return (i) => { const g = Math.min(255, Math.max(0, Math.round(255 * gain * (p[0][i] - low) / (high - low)))); put(i, g, g, g); };
    }
    if (channel.mode === "color" && channel.alpha >= 0 && this.view.alpha !== "none") {
      const over = overCheckerboard(this.view, p, this.planes[channel.alpha], this.display);
      return (i) => put(i, ...over(i, gain));
    }
    const [r, g, b] = channel.mode === "color" ? p : [p[0], p[0], p[0]];
    return (i) => put(i, byte(r[i]), byte(g[i]), byte(b[i]));
  }

  draw() {
    if (this.planes.length === 0) return;
    const {width, height} = this.view, context = this.canvas.getContext("2d");
    const image = context.createImageData(width, height), out = image.data, paint = this.painter(out);
    const planes = this.channel.planes.map((p) => this.planes[p]), real = this.channel.mode !== "id";
    for (let i = 0; i < width * height; ++i) {
      let sum = 0;
      if (real) for (const p of planes) sum += p[i] - p[i];  // NaN where any is NaN or infinite
      if (sum === 0) { paint(i); continue; }
      // Magenta for NaN, cyan for an infinity, in a pattern that no smooth picture has.
      const nan = planes.some((p) => Number.isNaN(p[i])), bright = (i % width + Math.floor(i / width)) % 2 ? 255 : 150;
      out.set(nan ? [bright, 0, bright, 255] : [0, bright, bright, 255], 4 * i);
    }
    context.putImageData(image, 0, 0);
    this.resize();
  }

  resize() {
    const room = this.stage.clientWidth, ratio = globalThis.devicePixelRatio > 1 ? 1 : 1;
    const fit = Math.min(room / this.view.width, this.view.width * ratio < 200 ? 4 : 1.5);
    const factor = this.scale ?? Math.max(fit, 0.05);
    this.canvas.style.width = `${this.view.width * factor}px`;
    this.canvas.style.height = `${this.view.height * factor}px`;
    if (this.at) this.probe(...this.at);
  }

  pointAt(event) {
    const r = this.canvas.getBoundingClientRect();
    this.probe(Math.floor((event.clientX - r.left) / r.width * this.view.width), Math.floor((event.clientY - r.top) / r.height * this.view.height));
  }

  key(event) {
    const moves = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
    if (!moves[event.key]) return;
    event.preventDefault();
    const [x, y] = this.at ?? [this.view.width >> 1, this.view.height >> 1], step = event.shiftKey ? 10 : 1;
    this.probe(x + step * moves[event.key][0], y + step * moves[event.key][1]);
  }

  // Column and row of the shown values; the readout has the buffer's own coordinates.
  probe(column, row) {
    const {view} = this;
    if (this.planes.length === 0) return;
    const x = Math.min(view.width - 1, Math.max(0, column)), y = Math.min(view.height - 1, Math.max(0, row)), i = y * view.width + x;
    this.at = [x, y];
    const box = this.canvas.getBoundingClientRect();
    this.mark.hidden = false;
    this.mark.style.left = `${(x + 0.5) * box.width / view.width}px`;
    this.mark.style.top = `${(y + 0.5) * box.height / view.height}px`;
    const color = [...this.canvas.getContext("2d").getImageData(x, y, 1, 1).data.slice(0, 3)];
    this.readout.replaceChildren(
        element("div", {style: "margin-bottom:.35rem"}, element("span", {class: "swatch", style: `background:rgb(${color})`}),
                `x ${view.first[0] + x * view.step}, y ${view.first[1] + y * view.step}`),
        element("div", {class: "scroll", style: "max-height:15rem"}, element("table", {}, element("tbody", {}, view.planes.map((p, k) =>
            element("tr", {"data-plane": p.name}, element("td", {}, p.name), element("td", {}, exact(this.planes[k][i], p.data.kind))))))));
  }
}

// The element, and load() for when it comes into sight.
export function pictureView(view, summary) {
  const v = new PictureView(view, summary);
  return {element: v.element, load: () => v.load()};
}
