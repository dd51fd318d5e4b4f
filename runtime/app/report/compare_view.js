// Two pictures that should be alike: reference, output and difference beside each other; pointing at one shows the other.
import {element, exact, number} from "./dom.js";
import {idColor, overCheckerboard, srgbByte, turbo} from "./color.js";
import {numbers} from "./codec.js";

const isDisplay = (space) => /srgb|display|rec709$|gamma/i.test(space) && !/^lin/i.test(space);

class CompareView {
  // {"port", "against", "output": view, "reference": view or null} with views as a report has them.
  constructor(pair) {
    Object.assign(this, {pair, planes: [], gain: 1});
    const names = pair.output.planes.map((p) => p.name), rgb = ["R", "G", "B"].map((n) => names.indexOf(n));
    this.choices = rgb.every((i) => i >= 0) ? [{name: "RGB", planes: rgb, alpha: names.indexOf("A")}] : [];
    names.forEach((name, i) => this.choices.push({name, planes: [i]}));
    this.choice = this.choices[0];
    this.build();
  }

  canvas(title, label) {
    const {width, height} = this.pair.output;
    const canvas = element("canvas", {width, height, role: "img", "aria-label": `${label} of ${this.pair.port}`,
        onmousemove: (e) => this.point(e), onmouseleave: () => this.swap(false), onmouseenter: (e) => this.swap(e.target !== this.difference)});
    return {canvas, figure: element("figure", {}, element("figcaption", {}, title), canvas)};
  }

  build() {
    const {pair} = this;
    const reference = pair.reference ? this.canvas("Reference", "Reference") : null, output = this.canvas("Output", "Output");
    const difference = pair.reference ? this.canvas("Difference", "Difference") : null;
    this.reference = reference?.canvas, this.output = output.canvas, this.difference = difference?.canvas;
    this.captions = [reference, output].map((f) => f?.figure.firstChild);
    this.readout = element("p", {class: "soft small mono readout", "aria-live": "polite"}, pair.reference ? "Point at a picture: it shows the other one." : "Nothing was accepted yet.");
    const select = element("select", {"aria-label": "Plane", onchange: () => { this.choice = this.choices[select.value]; this.draw(); }},
                           this.choices.map((c, i) => element("option", {value: i}, c.name)));
    const stops = element("input", {type: "range", min: -6, max: 12, step: 0.5, value: 0, "aria-label": "Gain of the difference, in stops",
        oninput: () => { this.gain = 2 ** Number(stops.value); text.textContent = `×${number(this.gain, 3)}`; this.draw(); }});
    const text = element("output", {}, "×1");
    this.element = element("div", {class: "compare"},
        element("div", {class: "tools"}, element("h3", {class: "mono"}, pair.port), element("span", {class: "soft small"}, `against ${pair.against}`),
                element("label", {class: "field"}, "Plane", select),
                difference ? element("label", {class: "field"}, "Difference", stops, text) : null),
        element("div", {class: "triple"}, [reference, output, difference].filter(Boolean).map((f) => f.figure)), this.readout);
  }

  async load() {
    const all = (view) => Promise.all(view.planes.map((p) => numbers(p.data)));
    this.planes = [await all(this.pair.output)];
    if (this.pair.reference) {
      const found = await all(this.pair.reference), names = this.pair.reference.planes.map((p) => p.name);
      this.planes.push(this.pair.output.planes.map((p) => found[names.indexOf(p.name)]));
    }
    this.draw();
    this.element.dataset.ready = "true";
  }

  // The larger of the values shown decides how a plane that is no colour is scaled, so that both are scaled alike.
  top() {
    if (["R", "G", "B", "A", "RGB", "Y"].includes(this.choice.name)) return 1;
    let most = 0;
    for (const side of this.planes) for (const v of side[this.choice.planes[0]] ?? []) if (Number.isFinite(v) && v > most) most = v;
    return most > 0 ? most : 1;
  }

  paint(canvas, planes) {
    const {width, height} = this.pair.output, context = canvas.getContext("2d"), image = context.createImageData(width, height);
    const display = isDisplay(this.pair.output.color_space), top = this.top(), id = this.pair.output.planes[this.choice.planes[0]].data.kind === "u32";
    const byte = display ? (v) => Math.round(255 * Math.min(1, Math.max(0, v))) : (v) => srgbByte(v / top);
    const shown = this.choice.planes.map((p) => planes[p]), [r, g, b] = shown.length === 3 ? shown : [shown[0], shown[0], shown[0]];
    const over = this.choice.alpha >= 0 && this.pair.output.alpha !== "none" && planes[this.choice.alpha]
        ? overCheckerboard(this.pair.output, shown, planes[this.choice.alpha], display) : null;
    const color = over ? (i) => over(i, 1) : id ? (i) => idColor(r[i]) : (i) => [byte(r[i]), byte(g[i]), byte(b[i])];
    for (let i = 0; i < width * height; ++i) image.data.set([...color(i), 255], 4 * i);
    context.putImageData(image, 0, 0);
  }

  paintDifference() {
    const {width, height} = this.pair.output, context = this.difference.getContext("2d"), image = context.createImageData(width, height);
    const [mine, other] = this.planes, id = this.pair.output.planes[this.choice.planes[0]].data.kind === "u32";
    for (let i = 0; i < width * height; ++i) {
      let most = 0;
      for (const p of this.choice.planes) {
        const d = other[p] === undefined ? NaN : Math.abs(mine[p][i] - other[p][i]);
        most = Number.isNaN(d) || Number.isNaN(most) ? NaN : Math.max(most, id && d > 0 ? 1 : d);
      }
      image.data.set(Number.isNaN(most) ? [255, 0, 255, 255] : most === 0 ? [24, 24, 28, 255] : [...turbo(0.1 + 0.9 * Math.min(1, most * this.gain)), 255], 4 * i);
    }
    context.putImageData(image, 0, 0);
  }

  draw() {
    this.paint(this.output, this.planes[0]);
    if (!this.reference) return;
    this.paint(this.reference, this.planes[1]);
    this.paintDifference();
  }

  // Each of the two pictures shows the other one as long as the pointer is on it.
  swap(on) {
    if (!this.reference || this.planes.length < 2) return;
    this.paint(this.output, this.planes[on ? 1 : 0]);
    this.paint(this.reference, this.planes[on ? 0 : 1]);
    this.captions[0].textContent = on ? "Output (swapped)" : "Reference";
    this.captions[1].textContent = on ? "Reference (swapped)" : "Output";
  }

  point(event) {
    if (this.planes.length === 0) return;
    const {output} = this.pair, box = event.target.getBoundingClientRect();
    const clamp = (v, n) => Math.min(n - 1, Math.max(0, Math.floor(v)));
    const x = clamp((event.clientX - box.left) / box.width * output.width, output.width);
    const y = clamp((event.clientY - box.top) / box.height * output.height, output.height), i = y * output.width + x;
    const values = (side) => this.choice.planes.map((p) => (side?.[p] ? exact(side[p][i], output.planes[p].data.kind) : "–")).join(" ");
    this.readout.textContent = `x ${output.first[0] + x * output.step}, y ${output.first[1] + y * output.step} · output ${values(this.planes[0])}` +
                               (this.planes.length > 1 ? ` · reference ${values(this.planes[1])}` : "");
  }
}

export function compareView(pair) {
  const v = new CompareView(pair);
  return {element: v.element, load: () => v.load()};
}
