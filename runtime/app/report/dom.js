// Elements and numbers. Every text becomes a text node, never markup.

const svgNames = new Set(["svg", "g", "path", "rect", "circle", "text", "title", "line"]);

// element("a", {href: "#x", class: "y", onclick: f}, "text", child, [more]): attributes that are null are left out.
export function element(name, attributes = {}, ...children) {
  const svg = svgNames.has(name) || attributes.svg;
  const e = svg ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "svg" || value === null || value === undefined || value === false) continue;
    if (key.startsWith("on")) e.addEventListener(key.slice(2), value);
    else e.setAttribute(key, value === true ? "" : value);
  }
  e.append(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  return e;
}

// An id for a fragment link, made of any text.
export function anchor(kind, name) { return `${kind}-${encodeURIComponent(name)}`; }

// A measured number in at most `digits` significant digits; what JSON cannot hold arrives as "nan", "inf", "-inf".
export function number(v, digits = 6) {
  if (typeof v !== "number") return String(v);
  if (Number.isNaN(v)) return "NaN";
  if (!Number.isFinite(v)) return v > 0 ? "∞" : "−∞";
  if (Number.isInteger(v) && Math.abs(v) < 1e9) return v.toLocaleString("en").replaceAll(",", "\u2009").replace("-", "−");
  const size = Math.abs(v);
  const text = size !== 0 && (size < 1e-4 || size >= 1e7) ? v.toExponential(digits - 1) : v.toPrecision(digits);
  return text.replace(/(\.\d*?)0+(e|$)/, "$1$2").replace(/\.(e|$)/, "$1").replaceAll("-", "−");
}

// All digits of a float, as few as name it: what a probe shows.
export function exact(v, kind) {
  if (kind !== "f32" || !Number.isFinite(v)) return Number.isInteger(v) ? String(v) : number(v, 17);
  for (let digits = 1; digits < 10; ++digits) {
    const text = v.toPrecision(digits);
    if (Math.fround(Number(text)) === v) return String(Number(text));
  }
  return String(v);
}

export function bytes(n) {
  const units = ["B", "KiB", "MiB", "GiB", "TiB"];
  let u = 0;
  while (n >= 1024 && u < units.length - 1) n /= 1024, ++u;
  return `${u === 0 ? n : n.toPrecision(n >= 1000 ? 4 : 3)} ${units[u]}`;
}

export function duration(ms) {
  if (ms >= 60000) return `${Math.floor(ms / 60000)} min ${Math.round(ms / 1000) % 60} s`;
  if (ms >= 1000) return `${(ms / 1000).toPrecision(3)} s`;
  if (ms >= 1) return `${ms.toPrecision(3)} ms`;
  return `${Math.max(0, ms * 1000).toPrecision(ms * 1000 >= 100 ? 3 : 2)} µs`;
}

export function ordinal(n) {
  const last = n % 100 >= 11 && n % 100 <= 13 ? 0 : n % 10;
  return `${n}${["th", "st", "nd", "rd"][last] ?? "th"}`;
}
