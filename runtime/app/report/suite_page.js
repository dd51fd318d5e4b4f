// The page of `frustum test --html`: what was asked of every case, how it went, and the pictures that differ.
import {bytes, duration, element, number} from "./dom.js";
import {compareView} from "./compare_view.js";

const worst = ["crash", "timeout", "fail", "flaky", "waived", "skip", "pass"];
const against = new Set(["crash", "timeout", "fail"]);
const rank = (c) => worst.indexOf(c.result);
const plural = (n, what) => `${number(n)} ${what}${n === 1 ? "" : "s"}`;

function command(label, text) {
  const button = element("button", {class: "copy", onclick: async () => {
    try {
      await navigator.clipboard.writeText(text);
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(code);
      button.textContent = "Selected";
    }
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  }}, "Copy");
  const code = element("code", {}, text);
  return element("div", {class: "command"}, element("span", {class: "soft small"}, label), code, button);
}

function outcomes(list) {
  if (list.length === 0) return null;
  const row = (o) => element("tr", {class: o.held ? null : "broken"}, element("td", {}, element("span", {class: `mark ${o.held ? "pass" : "fail"}`}, o.held ? "✓" : "✗")),
                             element("td", {class: "mono"}, o.port), element("td", {}, o.check),
                             element("td", {class: "mono"}, o.measured), element("td", {class: "mono soft"}, o.bound));
  const sorted = [...list].sort((a, b) => a.held - b.held);
  return element("div", {class: "scroll"}, element("table", {class: "outcomes"},
      element("thead", {}, element("tr", {}, ["", "Port", "Check", "Measured", "Expected"].map((h) => element("th", {}, h)))),
      element("tbody", {}, sorted.map(row))));
}

function counters(c) {
  const pairs = [...(c.peak_bytes > 0 ? [["Peak", bytes(c.peak_bytes)]] : []), ["Attempts", c.attempts], ...Object.entries(c.counters).map(([k, v]) => [k.replaceAll("_", " "), number(v)])];
  return element("dl", {class: "facts"}, pairs.map(([k, v]) => element("div", {}, element("dt", {}, k), element("dd", {}, v))));
}

// What stands under a case once it is opened; pictures are decoded then.
function details(c) {
  const views = c.pictures.map((p) => compareView(p));
  const box = element("div", {class: "details"},
      c.failures.map((f) => element("p", {class: "notice bad"}, f)), c.notes.map((n) => element("p", {class: "notice"}, n)),
      views.map((v) => v.element), outcomes(c.outcomes),
      c.said ? element("div", {}, element("h3", {}, "What it wrote"), element("pre", {class: "said"}, c.said)) : null,
      counters(c), element("div", {class: "commands"}, command("Run it alone", c.rerun),
                           c.outcomes.some((o) => o.check === "golden" || o.port && !o.held) ? command("Accept what it gives", c.accept) : null));
  views.forEach((v) => v.load());
  return box;
}

function caseElement(c) {
  const head = element("summary", {}, element("span", {class: `verdict ${c.result}`}, c.result), element("span", {class: "id"}, c.id),
                       element("span", {class: "soft small suite"}, c.suite), element("span", {class: "soft small end"}, `${plural(c.checks, "check")} · ${duration(c.ms)}`));
  const box = element("details", {class: "case", id: `case-${encodeURIComponent(`${c.suite}:${c.id}`)}`, "data-result": c.result}, head);
  box.addEventListener("toggle", () => { if (box.open && !box.querySelector(".details")) box.append(details(c)); });
  return box;
}

function tile(value, label) { return element("div", {}, element("div", {class: "value"}, value), element("div", {class: "label"}, label)); }

// Rows are made when they come into sight, so that ten thousand cases open as fast as ten.
function caseList(cases) {
  const list = element("div", {class: "card cases"}), more = element("button", {class: "quiet more"}, "Show more");
  let shown = [], next = 0;
  const grow = () => {
    const end = Math.min(shown.length, next + 200);
    for (; next < end; ++next) list.insertBefore(caseElement(shown[next]), more);
    more.hidden = next >= shown.length;
    more.textContent = `Show more (${number(shown.length - next)} left)`;
  };
  more.addEventListener("click", grow);
  const show = (wanted) => {
    list.replaceChildren(more);
    shown = cases.filter(wanted), next = 0;
    grow();
    if (shown.length === 0) list.prepend(element("p", {class: "soft empty"}, "No case matches."));
  };
  return {list, show};
}

function filters(data, show) {
  const pressed = new Set(), text = element("input", {type: "search", placeholder: "Filter by id, suite or tag", "aria-label": "Filter"});
  const update = () => {
    const words = text.value.toLowerCase().split(/\s+/).filter(Boolean);
    show((c) => (pressed.size === 0 || pressed.has(c.result)) &&
                words.every((w) => `${c.suite} ${c.id} ${c.tags.join(" ")}`.toLowerCase().includes(w)));
  };
  text.addEventListener("input", update);
  const buttons = worst.filter((v) => data.counts[v] > 0).map((v) => element("button", {"aria-pressed": false, onclick: (e) => {
    if (!pressed.delete(v)) pressed.add(v);
    e.target.setAttribute("aria-pressed", pressed.has(v));
    update();
  }}, `${v} ${number(data.counts[v])}`));
  update();
  return element("div", {class: "tools filters"}, text, buttons);
}

function showSuite(root, data) {
  const cases = [...data.cases].sort((a, b) => rank(a) - rank(b)), bad = cases.filter((c) => against.has(c.result)).length;
  const {list, show} = caseList(cases);
  root.append(element("main", {class: "suite"},
      element("header", {}, element("h1", {}, bad === 0 ? "Every case holds" : `${plural(bad, "case")} of ${number(cases.length)} ${bad === 1 ? "does" : "do"} not hold`),
              element("p", {class: "where"}, `${data.suites.join(", ")} · frustum ${data.version} · ${data.date}`),
              element("div", {class: "tiles"}, tile(number(cases.length), "cases"),
                      worst.filter((v) => data.counts[v] > 0).map((v) => tile(number(data.counts[v]), v)),
                      tile(number(cases.reduce((n, c) => n + c.checks, 0)), "checks"), tile(duration(data.ms), "took"))),
      element("section", {}, filters(data, show), list)));
  for (const first of [...list.querySelectorAll("details")].slice(0, 3)) if (against.has(first.dataset.result)) first.open = true;
}
