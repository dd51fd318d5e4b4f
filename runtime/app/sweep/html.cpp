// The page of a sweep: one file, readable without scripts; a script only links points, rows and pictures.
#include "runtime/app/metrics/metrics.h"
#include "runtime/app/sweep/analysis.h"
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

constexpr std::string_view style = R"css(
:root{color-scheme:light dark;--ground:#f7f7f5;--surface:#fff;--sunken:#f1f1ee;--ink:#1b1e22;--soft:#5f666f;--faint:#8c929b;--line:#e3e3df;--grid:#ececea;--accent:#22698a;
--c0:#1f77a8;--c1:#d9722b;--c2:#3a9a5b;--c3:#b8475b;--c4:#7b5bb5;--c5:#8a6d4a;--c6:#c45aa6;--c7:#5d6c7b;--c8:#a89a1c;--c9:#1fa3a3;
--shadow:0 1px 2px rgb(20 25 30/5%),0 6px 20px rgb(20 25 30/4%);
--text:system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue","Noto Sans",sans-serif;--mono:ui-monospace,"SF Mono",Menlo,Consolas,"DejaVu Sans Mono",monospace}
@media(prefers-color-scheme:dark){:root{--ground:#111316;--surface:#181b1f;--sunken:#131619;--ink:#e7e9ec;--soft:#a2a9b2;--faint:#757c86;--line:#2a2e34;--grid:#24282d;--accent:#7fc4e2;
--c0:#5cb3e0;--c1:#f0975a;--c2:#67c587;--c3:#e77b8c;--c4:#a98ae0;--c5:#c3a27a;--c6:#e58cc9;--c7:#9fb0c0;--c8:#d6c84a;--c9:#56cfcf;--shadow:0 1px 2px rgb(0 0 0/30%)}}
*{box-sizing:border-box}body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.5 var(--text);font-variant-numeric:tabular-nums}
main{max-width:1180px;margin:0 auto;padding:2.5rem 1.5rem 5rem;display:grid;gap:2.75rem}main>*{min-width:0}
h1,h2,h3,p{margin:0;text-wrap:pretty}h1{font-size:1.8rem;line-height:1.2;font-weight:650;letter-spacing:-.015em}h2{font-size:1.15rem;font-weight:620;margin-bottom:.35rem}
h3{font-size:.92rem;font-weight:620;overflow-wrap:anywhere}code{font-family:var(--mono);font-size:.86em}.soft{color:var(--soft)}.small{font-size:.84rem}
.where{color:var(--soft);font-size:.88rem;margin-top:.35rem;overflow-wrap:anywhere}.answer{font-size:1.12rem;line-height:1.55;margin-top:1.2rem;max-width:62rem}.answer b{font-weight:650}
.card{background:var(--surface);border:1px solid var(--line);border-radius:12px;box-shadow:var(--shadow);padding:1.1rem 1.2rem}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(9.5rem,1fr));gap:1px;margin-top:1.4rem;background:var(--line);border:1px solid var(--line);border-radius:10px;overflow:hidden}
.tiles>div{background:var(--surface);padding:.8rem 1rem}.tiles .value{font-size:1.25rem;font-weight:600;letter-spacing:-.015em}.tiles .label{color:var(--soft);font-size:.8rem}
.stage{display:grid;grid-template-columns:minmax(0,1fr) 292px;gap:1.2rem;align-items:start}@media(max-width:900px){.stage{grid-template-columns:1fr}}
.legend{display:flex;flex-wrap:wrap;gap:.3rem 1.1rem;font-size:.84rem;color:var(--soft);margin:.5rem 0 0}.legend i{display:inline-block;width:.7rem;height:.7rem;border-radius:50%;margin-right:.4rem;vertical-align:-1px}
.legend i.step{width:1.2rem;height:0;border-radius:0;border-top:3px solid var(--accent);vertical-align:4px;opacity:.55}
.look{position:sticky;top:1rem}.look img{width:100%;display:block;border-radius:6px;background:#000;image-rendering:auto}.look figure{margin:0 0 .7rem}.look figcaption{font-size:.8rem;color:var(--soft);margin-top:.25rem}.look dl{display:grid;grid-template-columns:auto 1fr;gap:.1rem .8rem;margin:.2rem 0 0;font-size:.86rem}.look dt{color:var(--soft)}.look dd{margin:0;text-align:right}
.plot{width:100%;height:auto;display:block;overflow:visible}.plot text{font-family:var(--text)}.plot .tick{font-size:11.5px;fill:var(--soft)}.plot .label{font-size:12px;fill:var(--soft)}
.plot .grid{stroke:var(--line);stroke-width:1}.plot .thin{stroke:var(--grid)}.plot .axis{stroke:var(--faint)}.plot .join{fill:none;stroke:currentColor;stroke-width:1.6;opacity:.45}
.plot .front{fill:none;stroke:var(--accent);stroke-width:7;stroke-linejoin:round;opacity:.2}.plot .dot{fill:currentColor;stroke:var(--surface);stroke-width:1.2;cursor:pointer}.plot .ring{stroke:var(--ink);stroke-width:2}
.plot .exact{fill:var(--surface);stroke:currentColor;stroke-width:1.6}.plot .dot:hover,.plot .dot.on{stroke:var(--ink);stroke-width:2.4}.plot .fit{stroke:currentColor;stroke-width:1.6;opacity:.9}.plot .theory{stroke:var(--faint);stroke-width:1.6;stroke-dasharray:5 4}
.s0{color:var(--c0)}.s1{color:var(--c1)}.s2{color:var(--c2)}.s3{color:var(--c3)}.s4{color:var(--c4)}.s5{color:var(--c5)}.s6{color:var(--c6)}.s7{color:var(--c7)}.s8{color:var(--c8)}.s9{color:var(--c9)}
.knobs{display:grid;grid-template-columns:repeat(auto-fill,minmax(330px,1fr));gap:1rem;margin-top:.9rem}.knobs .card{padding:.95rem 1rem .7rem}.knobs p{font-size:.83rem;color:var(--soft);margin-top:.15rem}.slopes{display:flex;gap:1.1rem;margin:.35rem 0 .3rem;font-size:.85rem;color:var(--soft);flex-wrap:wrap}.slopes b{color:var(--ink);font-weight:620}.good{color:var(--c2)!important}.off{color:var(--c1)!important}
table{border-collapse:collapse;width:100%;font-size:.87rem}th{text-align:right;font-weight:560;color:var(--soft);padding:.35rem .6rem;border-bottom:1px solid var(--line);white-space:nowrap}td{text-align:right;padding:.32rem .6rem;border-bottom:1px solid var(--grid);white-space:nowrap}
th:first-child,td:first-child{text-align:left;white-space:normal}tbody tr:hover,tr.on{background:var(--sunken)}tr[data-point]{cursor:pointer}.scroll{overflow-x:auto}
.bar{display:inline-block;height:.55rem;border-radius:3px;background:currentColor;opacity:.75;vertical-align:1px}
.wall{display:grid;grid-template-columns:repeat(auto-fill,minmax(210px,1fr));gap:.9rem;margin-top:.9rem}.wall figure{margin:0;background:var(--surface);border:1px solid var(--line);border-radius:9px;overflow:hidden}.wall .pair{display:grid;grid-template-columns:1fr 1fr;gap:1px;background:var(--line)}.wall img{width:100%;display:block;background:#000}.wall figcaption{padding:.45rem .65rem .5rem;font-size:.8rem;line-height:1.4;overflow-wrap:anywhere}
.wall .front{border-color:var(--accent)}ul{margin:.3rem 0 0;padding-left:1.1rem}li{margin:.15rem 0}@media print{.look{position:static}}
)css";

constexpr std::string_view script = R"js(
"use strict";
const looks=JSON.parse(document.getElementById("points").textContent),look=document.getElementById("look");
function show(i){document.querySelectorAll(".on").forEach(e=>e.classList.remove("on"));document.querySelectorAll('[data-point="'+i+'"]').forEach(e=>e.classList.add("on"));
const f=document.getElementById("figure"+i),p=looks[i];look.querySelector("h3").textContent=p.name;const dl=look.querySelector("dl");dl.textContent="";
for(const [k,v] of p.facts){const a=document.createElement("dt"),b=document.createElement("dd");a.textContent=k;b.textContent=v;dl.append(a,b)}
if(f){const s=f.querySelectorAll("img"),t=look.querySelectorAll("img");t.forEach((e,k)=>{if(s[k])e.src=s[k].src})}}
document.querySelectorAll("[data-point]").forEach(e=>{const i=e.dataset.point;e.addEventListener("mouseenter",()=>show(i));e.addEventListener("click",()=>show(i))});
)js";

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
  explicit Page(const Sweep& s) : s_(s), metric_(s.options.metrics.front()) {}

  std::string text() {
    std::string out = fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n<meta name=\"generator\" "
        "content=\"frustum\">\n<meta "
        "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
        "script-src "
        "'unsafe-inline'; img-src data:\">\n<title>{} - what accuracy "
        "costs</title>\n<style>{}</style>\n</head>\n<body><main>\n",
        escaped(s_.title), style);
    out += header() + main_plot() + knobs() + buys() + wall() + table() + method();
    return out + fmt::format(
                     "</main>\n<script type=\"application/json\" "
                     "id=\"points\">{}</script>\n<script>{}</script>\n</body></html>\n",
                     points_json(), script);
  }

 private:
  double error(const SweepPoint& p) const { return p.error(metric_); }
  static double time(const SweepPoint& p) { return milliseconds(median_of(p)); }
  // "samples 64" where the whole address is longer than it is clear.
  std::string short_name(const SweepPoint& p) const {
    return p.knob ? fmt::format("{} = {}", s_.knobs[*p.knob].address, p.values[*p.knob]) : name_of(s_, p);
  }
  std::string title_of(const SweepPoint& p) const {
    return fmt::format("{}\n{} {}, {} (min {}, mad {})", short_name(p), metric_, error_text(error(p)),
                       ms_text(time(p)), ms_text(milliseconds(min_of(p))),
                       ms_text(milliseconds(deviation_of(p))));
  }
  PlotPoint plotted(std::size_t i, double x, double y) const {
    return {x, y, title_of(s_.points[i]), i, !s_.options.grid && i == 0};
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
        tile(ms_text(s_.total_s * 1000), "for the whole sweep"));
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
    if (s_.steps.empty()) return out + " No single turn of a knob comes nearer to the reference.";
    const SweepStep& first = s_.steps.front();
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

  Plot frame() const {
    Plot plot;
    plot.x_label = "time of a run, ms (median)";
    plot.y_label = metric_ + " against the reference";
    plot.title = "Error against time, both logarithmic";
    for (std::size_t i = 0; i < s_.points.size(); ++i)
      if (s_.points[i].pareto) plot.front.push_back(plotted(i, time(s_.points[i]), error(s_.points[i])));
    std::sort(plot.front.begin(), plot.front.end(),
              [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    return plot;
  }

  std::string main_plot() const {
    Plot plot = frame();
    std::string legend;
    for (std::size_t k = 0; k < s_.knobs.size() && !s_.options.grid; ++k) {
      PlotSeries series{s_.knobs[k].address, k, {}};
      for (const std::string& v : s_.knobs[k].values)
        for (std::size_t i = 0; i < s_.points.size(); ++i)
          if ((s_.points[i].knob == k && s_.points[i].values[k] == v) || (i == 0 && s_.knobs[k].current == v))
            series.points.push_back(plotted(i, time(s_.points[i]), error(s_.points[i])));
      for (PlotPoint& p : series.points) p.ring = false;
      legend +=
          fmt::format("<span class=\"s{}\"><i style=\"background:currentColor\"></i></span><span>{}</span>",
                      k % 10, escaped(series.name));
      plot.series.push_back(std::move(series));
    }
    PlotSeries base{"as it is", 7, {}};
    for (std::size_t i = 0; i < s_.points.size(); ++i)
      if (s_.options.grid || i == 0)
        base.points.push_back(plotted(i, time(s_.points[i]), error(s_.points[i])));
    if (s_.options.grid)
      for (PlotPoint& p : base.points) plot.series.push_back({"", 0, {p}});
    else
      plot.series.push_back(std::move(base));
    legend += "<span><i class=\"step\"></i>Pareto front</span>";
    if (!s_.options.grid) legend += "<span>ringed: the graph as it is</span>";
    return fmt::format(
        "<section><h2>Error against time</h2><p class=\"soft small\">Down is nearer to the reference, left "
        "is faster. Beyond the front nothing is at once faster and better.</p>"
        "<div class=\"stage\" style=\"margin-top:.9rem\"><div class=\"card\">{}<div "
        "class=\"legend\">{}</div></div>{}</div></section>\n",
        svg(plot), legend, look());
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
      const bool near = knob.slope && std::abs(fit.over_value->slope - *knob.slope) <= 0.15;
      out += fmt::format("<span>error ~ value<sup><b class=\"{}\">{:+.2f}</b></sup></span>",
                         knob.slope ? near ? "good" : "off" : "", fit.over_value->slope);
      if (knob.slope) out += fmt::format("<span>theory {:+.2f}</span>", *knob.slope);
    }
    if (fit.over_time)
      out += fmt::format("<span>error ~ time<sup><b>{:+.2f}</b></sup></span>", fit.over_time->slope);
    if (fit.over_work)
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
        if (p.knob != fit.knob || p.values[fit.knob] != knob.values[v] || !p.own_error) continue;
        if (numbers && *p.own_error == 0) continue;
        series.points.push_back(
            plotted(i, numbers ? *number_of_setting(knob.values[v]) : static_cast<double>(v), *p.own_error));
        series.points.back().title = fmt::format("{}\nown error {}", short_name(p), error_text(*p.own_error));
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
      if (p.knob == fit.knob && p.own_error && *p.own_error > 0)
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
    head += "<th>own error</th><th>min</th><th>median</th><th>mad</th><th>work</th><th>front</th>";
    for (std::size_t i = 0; i < s_.points.size(); ++i) {
      const SweepPoint& p = s_.points[i];
      rows += fmt::format("<tr data-point=\"{}\"><td>{}</td>", i, escaped(short_name(p)));
      for (const std::string& m : s_.options.metrics)
        rows += fmt::format("<td>{}</td>", error_text(p.error(m)));
      rows += fmt::format("<td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.5g}</td><td>{}</td></tr>\n",
                          p.own_error ? error_text(*p.own_error) : "", ms_text(milliseconds(min_of(p))),
                          ms_text(time(p)), ms_text(milliseconds(deviation_of(p))),
                          static_cast<double>(p.work), p.pareto ? "●" : "");
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
        "<li>{:.1f} s of {:.1f} s were spent in runs. {}; frustum {} ({}).</li></ul></section>\n",
        s_.options.repeats, s_.runs_s, s_.total_s, escaped(s_.machine), version, build_id());
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

  const Sweep& s_;
  const std::string metric_;
};

}  // namespace

std::string sweep_html(const Sweep& s) { return Page(s).text(); }

}  // namespace frustum
