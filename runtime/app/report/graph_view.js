// The graph drawn: nodes by family, edges by the kind of their buffer, time and bytes on each node.
import {anchor, bytes, duration, element} from "./dom.js";
import {familyColor} from "./color.js";
import {layoutGraph} from "./layout.js";

const width = 140, headHeight = 66, portStep = 11;

const heightOf = (n) => Math.max(headHeight, 20 + portStep * Math.max(n.inputs.length, n.outputs.length));
const portY = (count, index, height) => height / 2 + (index - (count - 1) / 2) * portStep;
const costOf = (n) => (n.ms ?? 0) + (n.pixels_ms ?? 0);

// Smooth through the points, level at both ends.
function curve(points) {
  let d = `M${points[0].x},${points[0].y}`;
  for (let i = 1; i < points.length; ++i) {
    const a = points[i - 1], b = points[i], bend = Math.max(18, (b.x - a.x) / 2);
    d += `C${a.x + bend},${a.y} ${b.x - bend},${b.y} ${b.x},${b.y}`;
  }
  return d;
}

function edgeOf(e, from, to, layout, route) {
  const a = layout.nodes.get(e.from), b = layout.nodes.get(e.to);
  const out = from.outputs.findIndex((p) => p.name === e.port), into = to.inputs.findIndex((p) => p.name === e.input);
  const start = {x: a.x + width, y: a.y + portY(from.outputs.length, out, heightOf(from))};
  const end = {x: b.x, y: b.y + portY(to.inputs.length, into, heightOf(to))};
  return element("path", {class: e.streams ? "edge streams" : "edge", d: curve([start, ...route, end]), stroke: e.color,
                          "data-from": e.from, "data-to": e.to},
                 element("title", {}, `${e.from}.${e.port} → ${e.to}.${e.input} (${e.kind})`));
}

function ports(list, x, height) {
  return list.map((p, i) => element("circle", {cx: x, cy: portY(list.length, i, height), r: 3.2, fill: p.color ?? "var(--faint)"},
                                    element("title", {}, p.kind ? `${p.name}: ${p.kind}` : p.name)));
}

const short = (text, most) => (text.length > most ? `${text.slice(0, most - 1)}…` : text);

function nodeOf(n, at, most, inputColors) {
  const h = heightOf(n), cost = costOf(n), top = (h - headHeight) / 2;
  const label = `${n.id}, ${n.type}, ${duration(cost)}`;
  const inputs = n.inputs.map((p) => ({...p, color: inputColors.get(`${n.id}.${p.name}`)}));
  return element(
      "a", {svg: true, class: "node", href: `#${anchor("node", n.id)}`, "data-id": n.id, "aria-label": label,
            transform: `translate(${at.x},${at.y})`},
      element("title", {}, `${n.id} · ${n.type}\n${n.doc}`),
      element("rect", {class: "body", width, height: h, rx: 7}),
      element("rect", {x: 0, y: 7, width: 3.5, height: h - 14, rx: 1.75, fill: familyColor(n.family)}),
      element("text", {class: "id", x: 13, y: top + 21}, short(n.id, 15)),
      element("text", {class: "type", x: 13, y: top + 36}, short(n.type, 21)),
      element("text", {class: "cost", x: 13, y: top + 51},
              [duration(cost), n.bytes ? bytes(n.bytes) : null].filter(Boolean).join(" · ")),
      element("rect", {class: "cold", x: 13, y: top + 57, width: width - 26, height: 2.5, rx: 1.25}),
      element("rect", {class: "heat", x: 13, y: top + 57, width: Math.max(1, (width - 26) * cost / most), height: 2.5, rx: 1.25}),
      ports(inputs, 0, h), ports(n.outputs, width, h));
}

// Lights what feeds a node and what it feeds.
function highlight(svg, id) {
  const edges = [...svg.querySelectorAll(".edge")];
  const lit = new Set([id]);
  const walk = (key, other) => {
    const frontier = [id], seen = new Set(frontier);
    while (frontier.length > 0) {
      const at = frontier.pop();
      for (const e of edges)
        if (e.dataset[key] === at) {
          e.classList.add("lit");
          const next = e.dataset[other];
          lit.add(next);
          if (!seen.has(next)) seen.add(next), frontier.push(next);
        }
    }
  };
  for (const e of svg.querySelectorAll(".lit")) e.classList.remove("lit");
  svg.classList.toggle("dim", id !== null);
  if (id === null) return;
  walk("from", "to");
  walk("to", "from");
  for (const n of svg.querySelectorAll(".node")) n.classList.toggle("lit", lit.has(n.dataset.id));
}

// A card with the drawing; a node is a link to its section.
export function graphView(nodes, edges) {
  const layout = layoutGraph(nodes.map((n) => ({id: n.id, height: heightOf(n)})), edges, {width, gapX: 42, gapY: 16});
  const byId = new Map(nodes.map((n) => [n.id, n]));
  const most = Math.max(1e-9, ...nodes.map(costOf));
  const inputColors = new Map(edges.map((e) => [`${e.to}.${e.input}`, e.color]));
  const w = layout.width + 12, h = layout.height + 12;
  const svg = element("svg", {viewBox: `-6 -6 ${w} ${h}`, width: w, height: h, role: "group", "aria-label": "The graph"},
                      element("g", {}, edges.map((e, i) => edgeOf(e, byId.get(e.from), byId.get(e.to), layout, layout.routes[i]))),
                      element("g", {}, nodes.map((n) => nodeOf(n, layout.nodes.get(n.id), most, inputColors))));
  for (const n of svg.querySelectorAll(".node")) {
    for (const on of ["mouseenter", "focus"]) n.addEventListener(on, () => highlight(svg, n.dataset.id));
    for (const off of ["mouseleave", "blur"]) n.addEventListener(off, () => highlight(svg, null));
  }
  const canvas = element("div", {class: "canvas", tabindex: 0, "aria-label": "The graph, scrollable"}, svg);
  const fit = element("button", {"aria-pressed": "false", onclick: () => setFit(fit.getAttribute("aria-pressed") !== "true")}, "Fit to width");
  const setFit = (on) => {
    fit.setAttribute("aria-pressed", on);
    svg.style.width = on ? "100%" : `${w}px`;
    svg.style.height = on ? "auto" : `${h}px`;
  };
  const kinds = new Map(edges.map((e) => [e.kind, e.color]));
  const legend = element("div", {class: "chips"},
                         [...kinds].map(([kind, color]) => element("span", {}, element("i", {class: "swatch", style: `color:${color}`}), kind)),
                         element("span", {}, "dashed: streams by tiles"));
  const card = element("div", {class: "card graph"}, canvas, element("div", {class: "tools"}, fit, legend));
  // The whole at a glance where half its size is enough for that; a longer graph scrolls at full size.
  requestAnimationFrame(() => setFit(w <= 2.05 * canvas.clientWidth && w > canvas.clientWidth - 40));
  return card;
}
