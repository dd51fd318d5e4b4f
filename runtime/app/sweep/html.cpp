// The page of a sweep: one file, readable without scripts; a script only links points, rows and pictures.
#include "runtime/app/metrics/metrics.h"
#include "runtime/app/sweep/analysis.h"
#include "runtime/app/sweep/page.h"
#include "runtime/app/sweep/pictures.h"
#include "runtime/app/sweep/plot.h"
#include "runtime/app/sweep/report.h"
#include "runtime/core/version.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace frustum {
namespace {

double milliseconds(std::chrono::nanoseconds t) {
  return std::chrono::duration<double, std::milli>(t).count();
}

std::string ms_text(double ms) {
  return std::abs(ms) >= 1000  ? fmt::format("{:.2f} s", ms / 1000)
         : std::abs(ms) >= 100 ? fmt::format("{:.0f} ms", ms)
                               : fmt::format("{:.3g} ms", ms);
}
std::string error_text(double e) { return e == 0 ? "0" : fmt::format("{:.3g}", e); }

class Page {
 public:
  explicit Page(Sweep& s) : s_(s), metric_(s.options.metrics.front()) {}

  std::string text() {
    std::string out = fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n<meta name=\"generator\" "
        "content=\"frustum\">\n<meta "
        "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
        "script-src "
        "'unsafe-inline'; img-src data:\">\n<title>{} - what accuracy "
        "costs</title>\n<style>{}</style>\n</head>\n<body><main>\n",
        escaped(s_.title), page_style);
    const auto began = std::chrono::steady_clock::now();
    const std::string body = main_plot() + knobs() + buys() + wall() + table(), points = points_json();
    const double more = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    s_.costs.report += more, s_.costs.total += more;
    out += header() + body + method();
    return out + fmt::format(
                     "</main>\n<script type=\"application/json\" "
                     "id=\"points\">{}</script>\n<script>{}</script>\n</body></html>\n",
                     points, page_script);
  }

 private:
  double error(const SweepPoint& p) const { return p.error(metric_); }
  static double time(const SweepPoint& p) { return milliseconds(median_of(p)); }
  // "samples 64" where the whole address is longer than it is clear.
  std::string short_name(const SweepPoint& p) const {
    return p.knob ? fmt::format("{} = {}", s_.knobs[*p.knob].address, p.values[*p.knob]) : name_of(s_, p);
  }
  // ----- the answer

  std::string header() const {
    const auto [fast, slow] =
        std::minmax_element(s_.points.begin(), s_.points.end(),
                            [](const SweepPoint& a, const SweepPoint& b) { return time(a) < time(b); });
    const auto front =
        std::count_if(s_.points.begin(), s_.points.end(), [](const SweepPoint& p) { return p.pareto; });
    return fmt::format(
        "<header><h1>{}: what accuracy costs</h1><p class=\"where\"><code>{}</code> · port <code>{}</code> · "
        "{} against {}</p>"
        "<p class=\"answer\">{}</p><div class=\"tiles\">{}{}{}{}{}</div></header>\n",
        escaped(s_.title), escaped(s_.options.graph), escaped(s_.port), metric_, escaped(s_.reference),
        answer(), tile(std::to_string(s_.points.size()), "settings measured"),
        tile(std::to_string(front), "on the Pareto front"),
        tile(ms_text(time(*fast)) + " – " + ms_text(time(*slow)), "fastest and slowest"),
        tile(std::to_string(s_.options.repeats), "timed runs of each, in turns"),
        tile(ms_text(s_.costs.total * 1000),
             s_.costs.runs() > 0 ? fmt::format("for the whole sweep, {:.1f} % of it measuring overhead",
                                               100 * s_.costs.overhead())
                                 : "for this page: nothing was run anew"));
  }
  static std::string tile(const std::string& value, const std::string& label) {
    return fmt::format("<div><div class=\"value\">{}</div><div class=\"label\">{}</div></div>", value, label);
  }

  std::string answer() const {
    if (s_.options.grid || s_.points.empty()) {
      const auto best =
          std::min_element(s_.points.begin(), s_.points.end(),
                           [&](const SweepPoint& a, const SweepPoint& b) { return error(a) < error(b); });
      return best == s_.points.end()
                 ? ""
                 : fmt::format("The nearest setting to the reference is <b>{}</b>: {} {} in {}.",
                               escaped(short_name(*best)), metric_, error_text(error(*best)),
                               ms_text(time(*best)));
    }
    const SweepPoint& now = s_.points.front();
    std::string out = fmt::format("As it is, the graph takes <b>{}</b> and is off by <b>{} {}</b>.",
                                  ms_text(time(now)), metric_, error_text(error(now)));
    const bool exact_there = std::any_of(s_.points.begin(), s_.points.end(), [&](const SweepPoint& p) {
      return error(p) == 0 && error(now) > 0;
    });
    if (s_.steps.empty())
      return out + (exact_there ? " Nothing but the reference itself is nearer to it."
                                : " No single turn of a knob comes nearer to the reference.");
    // Of what is nearly free, the first that is worth a change.
    const auto worth = std::find_if(s_.steps.begin(), s_.steps.end(),
                                    [](const SweepStep& t) { return t.error_ratio <= 0.9; });
    const SweepStep& first = worth == s_.steps.end() ? s_.steps.front() : *worth;
    out += fmt::format(" The best buy is <b>{}</b>: the error becomes {:.2g} times what it was for {}.",
                       escaped(short_name(s_.points[first.point])), first.error_ratio,
                       first.time_ms > 0 ? ms_text(first.time_ms) + " more" : "no more time");
    const auto saved = [&](const SweepPoint& p) { return time(now) - time(p); };
    const SweepPoint* save = nullptr;
    for (const SweepPoint& p : s_.points)
      if (saved(p) > 0.1 * time(now) && error(p) <= 1.05 * error(now) &&
          (save == nullptr || saved(p) > saved(*save)))
        save = &p;
    if (save != nullptr)
      out += fmt::format(" <b>{}</b> saves {} and costs no more than 5 % of error.",
                         escaped(short_name(*save)), ms_text(saved(*save)));
    return out;
  }

  // ----- error against time

  std::string main_plot() const {
    std::string legend;
    for (std::size_t k = 0; k < s_.knobs.size() && !s_.options.grid; ++k)
      legend += fmt::format("<span><i class=\"s{}\" style=\"background:currentColor\"></i>{}</span>", k % 10,
                            escaped(s_.knobs[k].address));
    for (std::size_t v = 0; s_.options.grid && v < s_.knobs.front().values.size(); ++v)
      legend += fmt::format("<span><i class=\"s{}\" style=\"background:currentColor\"></i>{} = {}</span>",
                            v % 10, escaped(s_.knobs.front().address), escaped(s_.knobs.front().values[v]));
    legend += "<span><i class=\"step\"></i>Pareto front</span>";
    if (!s_.options.grid) legend += "<span>ringed: the graph as it is</span>";
    if (std::any_of(s_.points.begin(), s_.points.end(), [&](const SweepPoint& p) { return error(p) == 0; }))
      legend += "<span>hollow, on the lower rim: no error at all</span>";
    return fmt::format(
        "<section><h2>Error against time</h2><p class=\"soft small\">Down is nearer to the reference, left "
        "is faster. Beyond the front nothing is at once faster and better.</p>"
        "<div class=\"stage\" style=\"margin-top:.9rem\"><div class=\"card\">{}<div "
        "class=\"legend\">{}</div></div>{}</div></section>\n",
        svg(error_plot(s_)), legend, look());
  }

  std::string look() const {
    if (picture(s_.points.front().key).empty()) return "";
    return fmt::format(
        "<aside class=\"card look\" id=\"look\"><h3>{}</h3><figure><img alt=\"the picture\" "
        "src=\"{}\"><figcaption>the picture</figcaption></figure>"
        "<figure><img alt=\"its error\" src=\"{}\"><figcaption>where it differs (root scale, white is its "
        "largest error)</figcaption></figure><dl>{}</dl></aside>",
        escaped(short_name(s_.points.front())), picture(s_.points.front().key),
        picture(s_.points.front().key + ".error"), facts_html(s_.points.front()));
  }
  std::string facts_html(const SweepPoint& p) const {
    std::string out;
    for (const auto& [k, v] : facts(p)) out += fmt::format("<dt>{}</dt><dd>{}</dd>", escaped(k), escaped(v));
    return out;
  }
  std::vector<std::pair<std::string, std::string>> facts(const SweepPoint& p) const {
    std::vector<std::pair<std::string, std::string>> out;
    for (const std::string& m : s_.options.metrics) out.emplace_back(m, error_text(p.error(m)));
    out.emplace_back("median", ms_text(time(p)));
    out.emplace_back("min", ms_text(milliseconds(min_of(p))));
    out.emplace_back("deviation", ms_text(milliseconds(deviation_of(p))));
    out.emplace_back("work", fmt::format("{:.4g}", static_cast<double>(p.work)));
    return out;
  }
  std::string picture(const std::string& name) const {
    return data_uri(std::filesystem::path(s_.options.folder) / "pictures" / (name + ".png"));
  }

  // ----- one plot a knob

  std::string knobs() const {
    std::string cards;
    for (const KnobFit& fit : s_.fits) cards += knob_card(fit);
    if (cards.empty()) return "";
    return "<section><h2>Each knob alone</h2><p class=\"soft small\">The error that a knob makes by itself: "
           "against the same graph with only this knob at its most exact value. "
           "Fitted slopes stand beside those that theory expects; the fit leaves out values within a factor "
           "of 4 of the most exact one, whose own error shows there.</p><div class=\"knobs\">" +
           cards + "</div></section>\n";
  }

  std::string knob_card(const KnobFit& fit) const {
    const SweepKnob& knob = s_.knobs[fit.knob];
    std::string out = fmt::format("<div class=\"card s{}\"><h3 style=\"color:var(--ink)\">{}</h3>",
                                  fit.knob % 10, escaped(knob.address));
    if (!knob.basis.empty()) out += fmt::format("<p>{}</p>", escaped(knob.basis));
    if (fit.without_effect)
      return out +
             "<div class=\"slopes\"><span>No effect on this port: every value gives the "
             "same.</span></div></div>\n";
    out += slopes(fit, knob);
    return out + svg(knob_plot(fit, knob)) + "</div>\n";
  }

  static std::string slopes(const KnobFit& fit, const SweepKnob& knob) {
    std::string out = "<div class=\"slopes\">";
    if (fit.over_value) {
      const auto agrees = agrees_with_theory(fit, knob);
      out += fmt::format("<span>error ~ value<sup><b class=\"{}\">{:+.2f}</b></sup></span>",
                         agrees ? *agrees ? "good" : "off" : "", fit.over_value->slope);
      if (agrees)
        out += fmt::format("<span>theory {:+.2f}: {} {}</span>", *knob.slope, *agrees ? "within" : "outside",
                           slope_tolerance);
    }
    if (fit.over_time && fit.over_time->r2 >= least_r2)
      out += fmt::format("<span>error ~ time<sup><b>{:+.2f}</b></sup></span>", fit.over_time->slope);
    if (fit.over_work && fit.over_work->r2 >= least_r2)
      out += fmt::format("<span>~ work<sup><b>{:+.2f}</b></sup></span>", fit.over_work->slope);
    return out + "</div>";
  }

  Plot knob_plot(const KnobFit& fit, const SweepKnob& knob) const {
    Plot plot;
    plot.width = 420, plot.height = 250;
    plot.title = "Error of " + knob.address + " alone";
    plot.y_label = metric_;
    const bool numbers = std::all_of(knob.values.begin(), knob.values.end(), [](const std::string& v) {
      return number_of_setting(v).value_or(0) > 0;
    });
    plot.x_label = numbers ? knob.address.substr(knob.address.rfind(':') + 1) : "";
    if (!numbers) plot.categories = knob.values;
    PlotSeries series{knob.address, fit.knob, {}};
    for (std::size_t v = 0; v < knob.values.size(); ++v)
      for (std::size_t i = 0; i < s_.points.size(); ++i) {
        const SweepPoint& p = s_.points[i];
        const auto own = p.own_error(fit.knob);
        if (!own || p.values[fit.knob] != knob.values[v] || (numbers && *own == 0)) continue;
        series.points.push_back(
            {numbers ? *number_of_setting(knob.values[v]) : static_cast<double>(v), *own,
             fmt::format("{} = {}\nown error {}", knob.address, knob.values[v], error_text(*own)), i,
             !p.knob});
      }
    if (numbers && fit.over_value) {
      plot.lines.push_back({fit.over_value->slope, fit.over_value->intercept, false});
      if (knob.slope) plot.lines.push_back({*knob.slope, theory_intercept(fit, knob), true});
    }
    plot.series.push_back(std::move(series));
    return plot;
  }

  // The line of the expected slope through the middle of the fitted points.
  double theory_intercept(const KnobFit& fit, const SweepKnob& knob) const {
    double x = 0;
    int n = 0;
    for (const SweepPoint& p : s_.points)
      if (const auto own = p.own_error(fit.knob); own && *own > 0 && number_of_setting(p.values[fit.knob]))
        x += std::log10(*number_of_setting(p.values[fit.knob])), ++n;
    x /= std::max(1, n);
    return fit.over_value->intercept + (fit.over_value->slope - *knob.slope) * x;
  }

  // ----- the best buys

  std::string buys() const {
    if (s_.steps.empty()) return "";
    double most = 0;
    for (const SweepStep& t : s_.steps)
      if (std::isfinite(t.halvings_per_ms)) most = std::max(most, t.halvings_per_ms);
    std::string rows;
    for (std::size_t i = 0; i < s_.steps.size(); ++i) {
      const SweepStep& t = s_.steps[i];
      const SweepPoint& p = s_.points[t.point];
      const bool free = std::isinf(t.halvings_per_ms);
      rows += fmt::format(
          "<tr data-point=\"{}\"><td>{}</td><td>{}</td><td>&times; {:.3g}</td><td>{}</td><td "
          "style=\"text-align:left;width:26%\"><span class=\"bar s{}\" "
          "style=\"width:{:.1f}%\"></span></td></tr>\n",
          t.point, escaped(name_of(s_, p)), (t.time_ms > 0 ? "+" : "") + ms_text(t.time_ms), t.error_ratio,
          free ? "free" : fmt::format("{:.3g}", t.halvings_per_ms), *p.knob % 10,
          free ? 100 : 100 * t.halvings_per_ms / std::max(most, 1e-300));
    }
    return "<section><h2>What buys most accuracy per millisecond</h2><p class=\"soft small\">From the graph "
           "as it is, one turn of one knob; only turns that come nearer to the reference, the best buy "
           "first.</p>"
           "<div class=\"card scroll\" "
           "style=\"margin-top:.9rem\"><table><thead><tr><th>turn</th><th>time</th><th>error</"
           "th><th>halvings per ms</th><th></th></tr></thead><tbody>" +
           rows + "</tbody></table></div></section>\n";
  }

  // ----- pictures

  std::string wall() const {
    std::string figures;
    for (std::size_t i = 0; i < s_.points.size(); ++i) {
      const SweepPoint& p = s_.points[i];
      const std::string image = picture(p.key), map = picture(p.key + ".error");
      if (image.empty()) continue;
      figures += fmt::format(
          "<figure id=\"figure{0}\" data-point=\"{0}\"{1}><div class=\"pair\"><img alt=\"\" loading=\"lazy\" "
          "src=\"{2}\"><img alt=\"error\" loading=\"lazy\" src=\"{3}\"></div><figcaption>{4}<br><span "
          "class=\"soft\">{5} {6} · {7}</span></figcaption></figure>\n",
          i, p.pareto ? " class=\"front\"" : "", image, map, escaped(short_name(p)), metric_,
          error_text(error(p)), ms_text(time(p)));
    }
    if (figures.empty()) return "";
    return "<section><h2>Pictures and where they are wrong</h2><p class=\"soft small\">Beside each picture "
           "its distance from the reference: black is none, white the largest of that picture, on a root "
           "scale. Framed in colour: on the front.</p><div class=\"wall\">" +
           figures + "</div></section>\n";
  }

  // ----- everything

  std::string table() const {
    std::string head = "<th>setting</th>", rows;
    for (const std::string& m : s_.options.metrics) head += "<th>" + m + "</th>";
    if (!s_.options.grid) head += "<th>own error</th>";
    head += "<th>min</th><th>median</th><th>mad</th><th>work</th><th>front</th>";
    for (std::size_t i = 0; i < s_.points.size(); ++i) {
      const SweepPoint& p = s_.points[i];
      rows += fmt::format("<tr data-point=\"{}\"><td>{}</td>", i, escaped(short_name(p)));
      for (const std::string& m : s_.options.metrics)
        rows += fmt::format("<td>{}</td>", error_text(p.error(m)));
      if (!s_.options.grid)
        rows += fmt::format("<td>{}</td>", p.own_error() ? error_text(*p.own_error()) : "");
      rows += fmt::format("<td>{}</td><td>{}</td><td>{}</td><td>{:.5g}</td><td>{}</td></tr>\n",
                          ms_text(milliseconds(min_of(p))), ms_text(time(p)),
                          ms_text(milliseconds(deviation_of(p))), static_cast<double>(p.work),
                          p.pareto ? "●" : "");
    }
    return "<section><h2>Every setting</h2><div class=\"card scroll\" "
           "style=\"margin-top:.6rem\"><table><thead><tr>" +
           head + "</tr></thead><tbody>" + rows + "</tbody></table></div></section>\n";
  }

  std::string method() const {
    return fmt::format(
        "<section class=\"soft small\"><h2 style=\"color:var(--ink)\">How this was measured</h2><ul>"
        "<li>{} timed runs of each setting, in turns through all settings, after one run that is not timed "
        "and gives error and counters. Median, min and median absolute deviation.</li>"
        "<li>Timed: from the plan to the finished buffer, without a cache and with nobody listening. Not "
        "timed: reading and checking the graph, and its <code>io</code> nodes, whose files are read "
        "once.</li>"
        "<li>Work is counted, not timed: vertices, triangles and samples that all nodes went through; it is "
        "the same on every machine. Times are of one machine and drift by some percent.</li>"
        "<li>Where the time of the sweep went: {}. The overhead is the share in which no graph ran.</li>"
        "<li>{}; frustum {} ({}).</li></ul></section>\n",
        s_.options.repeats, costs_text(s_.costs), escaped(s_.machine), version, build_id());
  }

  std::string points_json() const {
    std::string out = "[";
    for (const SweepPoint& p : s_.points) {
      out += fmt::format("{}{{\"name\":{},\"facts\":[", out.size() > 1 ? "," : "", quoted(short_name(p)));
      bool first = true;
      for (const auto& [k, v] : facts(p))
        out += fmt::format("{}[{},{}]", std::exchange(first, false) ? "" : ",", quoted(k), quoted(v));
      out += "]}";
    }
    return out + "]";
  }
  // JSON text that may stand inside a script element.
  static std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') out += '\\';
      if (c == '<')
        out += "\\u003c";
      else if (static_cast<unsigned char>(c) < 0x20)
        out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
      else
        out += c;
    }
    return out + "\"";
  }

  Sweep& s_;
  const std::string metric_;
};

}  // namespace

std::string sweep_html(Sweep& s) { return Page(s).text(); }

}  // namespace frustum
