#include "runtime/app/sweep/markdown.h"

#include "runtime/app/files.h"
#include "runtime/app/sweep/analysis.h"
#include "runtime/app/sweep/plot.h"
#include "runtime/app/sweep/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

namespace fs = std::filesystem;

double milliseconds(std::chrono::nanoseconds t) {
  return std::chrono::duration<double, std::milli>(t).count();
}

constexpr std::string_view plot_style =
    "<style>svg{background:#fff}text{font-family:system-ui,'Segoe UI',Roboto,'Noto "
    "Sans',sans-serif;fill:#5f666f;font-size:12px}"
    ".grid{stroke:#e3e3df}.thin{stroke:#f0f0ee}.axis{stroke:#8c929b}.join{fill:none;stroke:currentColor;"
    "stroke-width:1.6;opacity:.45}"
    ".front{fill:none;stroke:#22698a;stroke-width:7;stroke-linejoin:round;opacity:.2}.dot{fill:currentColor;"
    "stroke:#fff;stroke-width:1.2}"
    ".ring{stroke:#1b1e22;stroke-width:2}.exact{fill:#fff;stroke:currentColor;stroke-width:1.6}"
    ".s0{color:#1f77a8}.s1{color:#d9722b}.s2{color:#3a9a5b}.s3{color:#b8475b}.s4{color:#7b5bb5}.s5{color:#"
    "8a6d4a}.s6{color:#c45aa6}"
    ".s7{color:#5d6c7b}.s8{color:#a89a1c}.s9{color:#1fa3a3}</style>\n";
constexpr const char* colors[] = {"#1f77a8", "#d9722b", "#3a9a5b", "#b8475b", "#7b5bb5",
                                  "#8a6d4a", "#c45aa6", "#5d6c7b", "#a89a1c", "#1fa3a3"};

// The text of a legend stands inside the picture, since a page in Markdown has no colours.
std::string legend(const Sweep& s) {
  std::string out;
  double y = 26;
  for (std::size_t k = 0; k < s.knobs.size(); ++k, y += 17)
    out += fmt::format(
        "<circle cx=\"726\" cy=\"{}\" r=\"4.5\" fill=\"{}\"/><text x=\"737\" y=\"{}\">{}</text>\n", y,
        colors[k % 10], y + 4, escaped(s.knobs[k].address));
  return out +
         fmt::format(
             "<path d=\"M716 {0}H734\" class=\"front\"/><text x=\"741\" y=\"{1}\">Pareto front</text>\n",
             y + 2, y + 6);
}

std::string standalone(const Sweep& s, std::string text) {
  const auto end = text.find('>') + 1;
  text.insert(text.find("<svg") + 4, " xmlns=\"http://www.w3.org/2000/svg\"");
  text.insert(text.find('>', end - 1) + 1, std::string("\n") + std::string(plot_style));
  text.insert(text.rfind("</svg>"), legend(s));
  return text;
}

std::string slopes(const Sweep& s) {
  std::string rows;
  for (const KnobFit& f : s.fits) {
    const SweepKnob& k = s.knobs[f.knob];
    if (!f.over_value) continue;
    const bool timed = f.over_time && f.over_time->r2 >= least_r2;
    rows += fmt::format("| `{}` | {} | {:+.2f} | {} | {} | {:.3f} |\n", k.address, fmt::join(k.values, ", "),
                        f.over_value->slope,
                        k.slope ? fmt::format("{:+.2f}: {}", *k.slope, theory_text(f, k)) : "",
                        timed ? fmt::format("{:+.2f}", f.over_time->slope) : "no line", f.over_value->r2);
  }
  if (rows.empty()) return "";
  return "| knob | values | error ~ value^ | theory | error ~ time^ | r² |\n| --- | --- | --- | --- | --- | "
         "--- |\n" +
         rows + "\n";
}

std::string buys(const Sweep& s) {
  if (s.steps.empty()) return "";
  std::string out = "| turn | time | error | halvings per ms |\n| --- | --- | --- | --- |\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(8, s.steps.size()); ++i) {
    const SweepStep& t = s.steps[i];
    out += fmt::format("| {} | {:+.1f} ms | × {:.3g} | {} |\n", name_of(s, s.points[t.point]), t.time_ms,
                       t.error_ratio,
                       std::isinf(t.halvings_per_ms) ? "free" : fmt::format("{:.3g}", t.halvings_per_ms));
  }
  return out + "\n";
}

// The most different ones: the worst, the graph as it is, the best on the front.
std::vector<std::size_t> telling(const Sweep& s) {
  const std::string& metric = s.options.metrics.front();
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < s.points.size(); ++i) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return s.points[a].error(metric) > s.points[b].error(metric);
  });
  std::vector<std::size_t> out{order.front()};
  for (const std::size_t i : {std::size_t{0}, order[order.size() / 4]})
    if (std::find(out.begin(), out.end(), i) == out.end()) out.push_back(i);
  return out;
}

std::string pictures(const Sweep& s, const fs::path& images, const std::string& name,
                     const std::string& link) {
  std::string head = "|", rule = "|", row = "|", errors = "|";
  for (const std::size_t i : telling(s)) {
    const SweepPoint& p = s.points[i];
    const fs::path from = fs::path(s.options.folder) / "pictures";
    if (!fs::is_regular_file(from / (p.key + ".error.png"))) return "";
    for (const char* kind : {"", ".error"})
      write_text(images / fmt::format("{}_{}{}.png", name, i, kind),
                 read_text(from / (p.key + kind + ".png")));
    head += fmt::format(" {}: {} {:.3g}, {:.1f} ms |", name_of(s, p), s.options.metrics.front(),
                        p.error(s.options.metrics.front()), milliseconds(median_of(p)));
    rule += " --- |";
    row += fmt::format(" ![picture]({}/{}_{}.png) |", link, name, i);
    errors += fmt::format(" ![error]({}/{}_{}.error.png) |", link, name, i);
  }
  return head + "\n" + rule + "\n" + row + "\n" + errors + "\n\n";
}

}  // namespace

std::string sweep_markdown(const Sweep& s, const fs::path& images, const std::string& name) {
  const fs::path folder = images.lexically_normal();
  const std::string link = folder.lexically_relative(folder.parent_path().parent_path()).generic_string();
  write_text(folder / (name + ".svg"), standalone(s, svg(error_plot(s))));
  std::string out = fmt::format(
      "`{}` of *{}*, {} settings, {} against {}. {} timed runs of each in turns on {}.\n\n", s.port, s.title,
      s.points.size(), s.options.metrics.front(), s.reference, s.options.repeats, s.machine);
  out += fmt::format("![{} against time]({}/{}.svg)\n\n", s.options.metrics.front(), link, name);
  return out + pictures(s, folder, name, link) + slopes(s) + buys(s);
}

}  // namespace frustum
