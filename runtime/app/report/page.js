// The report of one run, put together from its parts.
import {anchor, bytes, duration, element, number, ordinal} from "./dom.js";
import {familyColor} from "./color.js";
import {dataTable, facts, pairs, plain, sortableTable, statisticsTable} from "./tables.js";
import {graphView} from "./graph_view.js";
import {pictureView} from "./picture_view.js";
import {shapeView} from "./shape_view.js";

const plural = (n, one, many = `${one}s`) => `${number(n)} ${n === 1 ? one : many}`;

function section(id, title, about, ...content) {
  return element("section", {id, "aria-labelledby": `${id}-title`},
                 element("div", {class: "head"}, element("h2", {id: `${id}-title`}, title), about ? element("span", {class: "soft"}, about) : null), content);
}

function themeButton() {
  const next = {auto: "light", light: "dark", dark: "auto"};
  const button = element("button", {class: "quiet", "aria-label": "Colours of the page", onclick: () => set(next[button.dataset.now])});
  const set = (theme) => {
    button.dataset.now = theme;
    button.textContent = {auto: "◐ Auto", light: "○ Light", dark: "● Dark"}[theme];
    if (theme === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
    document.dispatchEvent(new Event("themechange"));
  };
  set("auto");
  return button;
}

function header(data) {
  const tile = (value, label) => element("div", {}, element("div", {class: "value"}, value), element("div", {class: "label"}, label));
  const warnings = data.diagnostics.length;
  return element("header", {},
                 element("h1", {}, data.title),
                 element("p", {class: "where"}, data.file, data.file ? " · " : "", `frustum ${data.version}, build ${data.build}`),
                 element("div", {class: "tiles"},
                         tile(duration(data.run.ms), "whole run"),
                         tile(bytes(data.run.peak_bytes), "buffers at most"),
                         tile(number(data.nodes.length), data.nodes.length === 1 ? "node ran" : "nodes ran"),
                         tile(number(data.buffers.length), data.buffers.length === 1 ? "buffer shown" : "buffers shown"),
                         tile(number(warnings), warnings === 1 ? "warning" : "warnings"),
                         tile(data.culprit ? "not finite" : "all finite", "numeric health")));
}

function healthSection(data) {
  // The first NaN has a notice of its own, with a link to its node.
  const notes = data.diagnostics.filter((d) => !(data.culprit && d.code === "not_finite_result")).map((d) => element("div", {class: d.severity === "error" ? "notice bad" : "notice"},
      element("div", {class: "code"}, d.code, d.pointer ? ` · ${d.pointer}` : ""), element("div", {}, d.message)));
  if (data.culprit)
    notes.unshift(element("div", {class: "notice bad"}, element("div", {class: "code"}, "not finite"),
        element("div", {}, element("a", {href: `#${anchor("node", data.culprit.node)}`}, `${data.culprit.node}.${data.culprit.port}`),
                ` made the first NaN or infinity: ${data.culprit.where}.`, data.culprit.inputs ? ` Its inputs there: ${data.culprit.inputs}.` : "")));
  if (notes.length === 0) notes.push(element("p", {class: "well"}, "No warnings, and every value of every buffer is finite."));
  return section("health", "Diagnostics", null, notes);
}

function costs(data) {
  const cost = (n) => (n.ms ?? 0) + (n.pixels_ms ?? 0), most = Math.max(1e-9, ...data.nodes.map(cost)), sum = data.nodes.reduce((s, n) => s + cost(n), 0) || 1;
  const dot = (n) => element("i", {class: "dot", style: `background:${familyColor(n.family)}`});
  return sortableTable([
    {name: "Node", class: "name", key: (n) => n.id, cell: (n) => [dot(n), element("a", {href: `#${anchor("node", n.id)}`}, n.id)]},
    {name: "Type", key: (n) => n.type, cell: (n) => element("span", {class: "soft"}, n.type)},
    {name: "", class: "meter", cell: (n) => element("i", {style: `width:${100 * cost(n) / most}%`})},
    {name: "Time", number: true, key: cost, cell: (n) => duration(cost(n))},
    {name: "Share", number: true, key: cost, cell: (n) => `${(100 * cost(n) / sum).toFixed(1)} %`},
    {name: "Bytes", number: true, key: (n) => n.bytes ?? 0, cell: (n) => (n.bytes ? bytes(n.bytes) : n.pixel ? "streams" : "")},
  ], data.nodes, 3);
}

function planSection(data) {
  const passes = data.plan.passes.map((p, i) => element("div", {}, element("h3", {}, data.plan.passes.length > 1 ? `Pass ${i + 1}` : "One pass over tiles"),
      element("p", {class: "soft small", style: "margin:.15rem 0 .5rem"}, `${plural(p.nodes.length, "node")} fused: `, p.nodes.join(" → ")),
      pairs({...(p.ms !== undefined ? {time: duration(p.ms)} : {}), ...(p.counters?.tile_edge ? {"tile edge": `${p.counters.tile_edge} px`} : {}),
             ...(p.counters?.tile_bytes ? {"tile memory": bytes(p.counters.tile_bytes)} : {}),
             "made whole": p.whole.length > 0 ? p.whole.map((w) => `${w.port} (${w.why.replaceAll("_", " ")})`).join(", ") : "nothing"})));
  const skipped = data.plan.skipped.length > 0 ? element("p", {class: "soft small"}, `Not asked for, so not run: ${data.plan.skipped.join(", ")}.`) : null;
  const about = `${plural(data.plan.steps, "step")}, ${plural(data.plan.passes.length, "pass", "passes")} over tiles, ${bytes(data.run.peak_bytes)} of buffers at most`;
  return section("plan", "Plan", about, element("div", {class: "card", style: "padding:1rem 1.1rem;display:grid;gap:1.1rem"},
      passes.length > 0 ? element("div", {class: "columns"}, passes) : element("p", {class: "soft"}, "No node of this run works on pixels."), skipped));
}

function parameters(data) {
  const entries = Object.entries(data.params);
  if (entries.length === 0) return null;
  const value = ([, p]) => element("span", {class: "mono"}, plain(p.value));
  return section("parameters", "Parameters", null, element("div", {class: "card"}, sortableTable(
      [{name: "Parameter", class: "name", cell: ([name]) => name}, {name: "Value", cell: value}, {name: "", cell: ([, p]) => (p.set ? element("span", {class: "tag"}, "set for this run") : "")}], entries)));
}

function nodeDetails(n, shown) {
  const links = n.inputs.filter((i) => i.links.length > 0);
  const port = (p) => {
    const name = `${n.id}.${p.name}`;
    return element("span", {}, element("i", {class: "dot", style: `background:${p.color}`}), shown.has(name) ? element("a", {href: `#${anchor("buffer", name)}`}, p.name) : p.name,
                   element("span", {class: "soft"}, `\u2002${p.kind}`));
  };
  const counters = Object.entries(n.counters ?? {});
  return element("details", {id: anchor("node", n.id)},
      element("summary", {}, element("i", {class: "dot", style: `background:${familyColor(n.family)}`}), element("strong", {}, n.id), element("span", {class: "soft"}, n.type),
              element("span", {class: "soft small", style: "margin-left:auto"}, duration((n.ms ?? 0) + (n.pixels_ms ?? 0)))),
      element("div", {class: "inside"}, element("p", {class: "soft"}, n.doc),
              links.length > 0 ? element("div", {}, element("h3", {}, "Inputs"), pairs(Object.fromEntries(links.map((i) => [i.name, i.links.join(", ")])))) : null,
              element("div", {}, element("h3", {}, "Outputs"), element("div", {class: "chips small"}, n.outputs.map(port))),
              Object.keys(n.params).length > 0 ? element("div", {}, element("h3", {}, "Parameters"), pairs(n.params)) : null,
              counters.length > 0 ? element("div", {}, element("h3", {}, "Work"), pairs(Object.fromEntries(counters))) : null,
              n.pixel ? element("p", {class: "soft small"}, `Prepared in ${duration(n.ms ?? 0)}; filled ${number(n.pixels ?? 0)} pixels in ${duration(n.pixels_ms ?? 0)} on all threads together.`) : null));
}

// Statistics of whatever the kind calls its parts.
function partsOf(summary) {
  if (summary.planes) return summary.planes;
  if (summary.components) return summary.components;
  if (summary.channels) return summary.channels;
  const columns = (summary.columns ?? []).flatMap((c) => c.components
      ? c.components.map((p) => ({...p, label: c.components.length > 1 ? `${c.name}.${p.name}` : c.name, kind: `${c.kind} / ${c.domain}`})) : [c]);
  return columns.filter((c) => c.count !== undefined);
}

function factsOf(b) {
  const facts = {};
  for (const [k, v] of Object.entries(b.summary))
    if (!["planes", "components", "channels", "columns", "rows"].includes(k) || (k === "rows" && typeof v === "number")) facts[k.replaceAll("_", " ")] = v;
  return {...facts, bytes: bytes(b.bytes), digest: b.digest};
}

function bufferCard(b) {
  const view = b.view?.type === "picture" ? pictureView(b.view, b.summary) : b.view ? shapeView(b.view) : null;
  const h = b.health, odd = h.nan + h.positive_infinity + h.negative_infinity;
  const parts = partsOf(b.summary);
  const notes = [];
  if (b.view?.step > 1)
    notes.push(`Thinned to every ${ordinal(b.view.step)} pixel of every ${ordinal(b.view.step)} row; each shown value is one of the buffer's own. Statistics are of all.`);
  if (b.view?.samples > 1) notes.push(`The most central of ${b.view.samples} samples a pixel is shown.`);
  const card = element("details", {class: "card buffer", id: anchor("buffer", b.port), open: true},
      element("summary", {}, element("i", {class: "dot", style: `background:${b.color}`}), element("strong", {}, b.port), b.names.map((n) => element("span", {class: "tag"}, n)),
              element("span", {class: "soft"}, b.kind), element("span", {class: "soft small", style: "margin-left:auto"}, bytes(b.bytes))),
      element("div", {class: "inside"},
              odd > 0 ? element("div", {class: "notice bad"}, `${plural(odd, "value")} of ${number(h.values)} not finite (${number(h.nan)} NaN, ${number(h.positive_infinity)} +∞, ${number(h.negative_infinity)} −∞); the first: ${h.first}.`) : null,
              view?.element, notes.map((n) => element("p", {class: "soft small"}, n)),
              parts.length > 0 ? element("div", {}, element("h3", {style: "margin-bottom:.3rem"}, "Statistics"), statisticsTable(parts)) : null,
              b.table && !parts.length ? dataTable(b.table) : null,
              element("div", {}, element("h3", {style: "margin-bottom:.3rem"}, "Facts"), facts(factsOf(b))),
              b.table && parts.length > 0 ? values(b) : null));
  return {card, view};
}

// The rows of a large buffer, made when they are asked for.
function values(b) {
  const box = element("details", {class: "card", ontoggle: () => { if (box.open && !inside.hasChildNodes()) inside.append(...dataTable(b.table).filter(Boolean)); }},
                      element("summary", {}, element("span", {}, "Values"), element("span", {class: "soft small"}, `${number(b.table.total)} rows`)));
  const inside = element("div", {class: "inside"});
  box.append(inside);
  return box;
}

// Pictures are decoded when they come near the window, and all of them before printing.
function loadWhenNear(views) {
  const loads = new Map(views.map(({card, view}) => [card, view.load]));
  const load = (card) => { const f = loads.get(card); loads.delete(card); f?.(); };
  const watch = new IntersectionObserver((entries) => { for (const e of entries) if (e.isIntersecting) load(e.target), watch.unobserve(e.target); }, {rootMargin: "600px"});
  for (const {card} of views) watch.observe(card);
  addEventListener("beforeprint", () => { for (const card of [...loads.keys()]) load(card); });
}

// A link to a node or buffer opens what it leads to.
function openTarget() {
  const target = document.getElementById(location.hash.slice(1));
  if (target instanceof HTMLDetailsElement) target.open = true, target.scrollIntoView();
}

export function showReport(root, data) {
  const cards = data.buffers.map(bufferCard), shown = new Set(data.buffers.map((b) => b.port));
  const sections = [["graph", "Graph"], ["buffers", "Buffers"], ["costs", "Time and memory"], ["health", "Diagnostics"], ["plan", "Plan"], ["parameters", "Parameters"], ["nodes", "Nodes"]]
      .filter(([id]) => id !== "parameters" || Object.keys(data.params).length > 0);
  const streams = data.nodes.some((n) => n.pixels_ms);
  root.replaceChildren(
      element("nav", {class: "bar", "aria-label": "Sections"}, element("div", {}, element("span", {class: "mark"}, "frustum"),
              element("div", {class: "links"}, sections.map(([id, title]) => element("a", {href: `#${id}`}, title))), themeButton())),
      element("main", {}, header(data),
              section("graph", "Graph", `${plural(data.nodes.length, "node")}, ${plural(data.edges.length, "link")}; a node leads to its section`, graphView(data.nodes, data.edges)),
              section("buffers", "Buffers", plural(data.buffers.length, "buffer"), cards.map((c) => c.card)),
              section("costs", "Time and memory", streams ? "nodes that stream by tiles: time of all threads together" : null, element("div", {class: "card"}, costs(data))),
              healthSection(data), planSection(data), parameters(data),
              section("nodes", "Nodes", null, element("div", {class: "card list"}, data.nodes.map((n) => nodeDetails(n, shown))))));
  loadWhenNear(cards.filter((c) => c.view));
  addEventListener("hashchange", openTarget);
  if (location.hash) openTarget();
}
