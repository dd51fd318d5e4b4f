// Tables: plain rows, rows that sort by a column, statistics, and name-value pairs of any JSON.
import {element, number} from "./dom.js";

// columns: [{name, number: bool, cell: (row) => child, key: (row) => sortable}]; sorted by `by` descending where it is given.
export function sortableTable(columns, rows, by = null) {
  const body = element("tbody");
  let current = by, down = true;
  const heads = columns.map((c, i) => element("th", {class: c.number ? "number" : null, scope: "col"},
      c.key ? element("button", {onclick: () => sort(i)}, c.name) : c.name));
  const fill = (list) => body.replaceChildren(...list.map((row) => element("tr", {},
      columns.map((c) => element("td", {class: [c.number ? "number" : "", c.class ?? ""].join(" ").trim() || null}, c.cell(row))))));
  const apply = () => {
    heads.forEach((h, i) => i === current ? h.setAttribute("aria-sort", down ? "descending" : "ascending") : h.removeAttribute("aria-sort"));
    if (current === null) return fill(rows);
    const key = columns[current].key, sign = down ? -1 : 1;
    fill([...rows].sort((a, b) => sign * (key(a) < key(b) ? -1 : key(a) > key(b) ? 1 : 0)));
  };
  const sort = (i) => {
    down = i === current ? !down : columns[i].number === true;
    current = i;
    apply();
  };
  apply();
  return element("div", {class: "scroll", tabindex: 0}, element("table", {}, element("thead", {}, element("tr", {}, heads)), body));
}

// {"columns", "rows", "total"} as buffers give it.
export function dataTable({columns, rows, total}) {
  const numeric = columns.map((_, i) => rows.length > 0 && rows.every((r) => r[i] === null || typeof r[i] === "number" || /^-?(nan|inf)$/.test(r[i])));
  const table = sortableTable(columns.map((name, i) => ({name, number: numeric[i], cell: (r) => (r[i] === null ? "" : number(r[i]))})), rows);
  const more = total > rows.length ? element("p", {class: "soft small"}, `The first ${number(rows.length)} of ${number(total)} rows.`) : null;
  table.style.maxHeight = "26rem";
  return [table, more];
}

// Planes or components with "min", "max", "mean", "percentiles", counts of the unusual; a part without numbers shows none.
export function statisticsTable(parts) {
  const cell = (path) => (p) => {
    const v = path.reduce((o, k) => o?.[k], p);
    return v === undefined ? "" : number(v, 5);
  };
  const odd = (p) => ["nan", "positive_infinity", "negative_infinity", "denormal", "no_face"]
      .filter((k) => p[k] > 0).map((k) => `${number(p[k])} ${k.replaceAll("_", " ")}`).join(", ");
  return sortableTable([{name: "Name", class: "name", cell: (p) => p.label ?? p.name}, {name: "Type", cell: (p) => p.kind ?? ""},
                        {name: "Count", number: true, cell: cell(["count"])}, {name: "Min", number: true, cell: cell(["min"])},
                        {name: "Median", number: true, cell: cell(["percentiles", "50"])}, {name: "Mean", number: true, cell: cell(["mean"])},
                        {name: "Max", number: true, cell: cell(["max"])}, {name: "Unusual", cell: odd}], parts);
}

// Any JSON value in one line.
export function plain(value) {
  if (typeof value === "number") return number(value);
  if (Array.isArray(value)) return `[${value.map(plain).join(", ")}]`;
  if (value !== null && typeof value === "object") return `{${Object.entries(value).map(([k, v]) => `${k}: ${plain(v)}`).join(", ")}}`;
  return String(value);
}

export function pairs(object) {
  return element("dl", {class: "pairs"}, Object.entries(object).map(([k, v]) => [element("dt", {}, k), element("dd", {}, plain(v))]));
}

// The same in as few lines as the window allows.
export function facts(object) {
  return element("dl", {class: "facts"}, Object.entries(object).map(([k, v]) =>
      element("div", {}, element("dt", {}, k), element("dd", {}, plain(v)))));
}
