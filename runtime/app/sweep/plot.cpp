#include "runtime/app/sweep/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

// "0.02", "3e-6": as short as it is clear.
std::string tick_text(double v) {
  if (v >= 1e-3 && v < 1e5) return fmt::format("{:g}", v);
  const int exponent = static_cast<int>(std::floor(std::log10(v) + 1e-9));
  const double digit = v / std::pow(10, exponent);
  return fmt::format("{:g}e{}", std::round(digit), exponent);
}

// One axis: logarithms of values, with room at both ends, to pixels.
struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  double from = 0, to = 1;  // pixels
  void see(double v) {
    if (v > 0 && std::isfinite(v)) low = std::min(low, std::log10(v)), high = std::max(high, std::log10(v));
  }
  void close(double room) {
    if (low > high) low = 0, high = 1;
    const double middle = (low + high) / 2, half = std::max((high - low) / 2, 0.15);
    low = middle - half * (1 + room), high = middle + half * (1 + room);
  }
  double at_log(double l) const { return from + (l - low) / (high - low) * (to - from); }
  double at(double v) const { return at_log(std::log10(v)); }
};

struct Tick {
  double value;
  bool labelled;
};
// Decades; between them 2 and 5 where there is room, then every digit as a thin line.
std::vector<Tick> ticks(const Axis& a) {
  std::vector<Tick> out;
  const double decades = a.high - a.low;
  for (int k = static_cast<int>(std::floor(a.low)); k <= static_cast<int>(std::ceil(a.high)); ++k)
    for (int digit = 1; digit < 10; ++digit) {
      const double v = digit * std::pow(10, k), l = std::log10(v);
      if (l < a.low || l > a.high) continue;
      const bool half = (digit == 2 || digit == 5) && decades < 2.2;
      const bool whole = digit == 1 && (decades < 9 || k % 2 == 0);
      if (whole || half || decades < 4) out.push_back({v, whole || half});
    }
  return out;
}

class Drawing {
 public:
  explicit Drawing(const Plot& p) : p_(p) {
    x_.from = left, x_.to = p.width - 16;
    y_.from = p.height - bottom(), y_.to = 14;
    for (const PlotSeries& s : p.series)
      for (const PlotPoint& q : s.points) see(q);
    for (const PlotPoint& q : p.front) see(q);
    x_.close(0.07), y_.close(0.09);
  }

  std::string text() {
    out_ = fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                       p_.width, p_.height, escaped(p_.title));
    axes();
    front();
    lines();
    for (const PlotSeries& s : p_.series) series(s);
    return out_ + "</svg>\n";
  }

 private:
  static constexpr int left = 66;
  int bottom() const { return 44; }
  bool has_categories() const { return !p_.categories.empty(); }

  void see(const PlotPoint& q) {
    if (!has_categories()) x_.see(q.x);
    y_.see(q.y);
  }
  double px(const PlotPoint& q) const {
    if (!has_categories()) return x_.at(q.x);
    return x_.from + (q.x + 0.5) / static_cast<double>(p_.categories.size()) * (x_.to - x_.from);
  }
  double py(const PlotPoint& q) const { return q.y > 0 && std::isfinite(q.y) ? y_.at(q.y) : y_.from; }

  void axes() {
    for (const Tick& t : ticks(y_)) {
      out_ += fmt::format("<line class=\"{}\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                          t.labelled ? "grid" : "grid thin", x_.from, x_.to, y_.at(t.value), y_.at(t.value));
      if (t.labelled)
        out_ += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                            left - 8, y_.at(t.value) + 4, tick_text(t.value));
    }
    for (std::size_t i = 0; i < p_.categories.size(); ++i)
      out_ += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                          px({static_cast<double>(i), 1, {}, 0, false}), p_.height - 26,
                          escaped(p_.categories[i]));
    if (!has_categories())
      for (const Tick& t : ticks(x_)) {
        out_ +=
            fmt::format("<line class=\"{}\" y1=\"{}\" y2=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\"/>",
                        t.labelled ? "grid" : "grid thin", y_.from, y_.to, x_.at(t.value), x_.at(t.value));
        if (t.labelled)
          out_ += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                              x_.at(t.value), p_.height - 26, tick_text(t.value));
      }
    out_ += fmt::format("<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2}\" y2=\"{2}\"/>\n", x_.from,
                        x_.to, y_.from);
    out_ += fmt::format("<text class=\"label\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", x_.to,
                        p_.height - 8, escaped(p_.x_label));
    out_ += fmt::format(
        "<text class=\"label\" transform=\"translate(14 {}) rotate(-90)\" text-anchor=\"end\">{}</text>\n",
        y_.to, escaped(p_.y_label));
  }

  // To the right of a point nothing cheaper is better: a staircase.
  void front() {
    std::string d;
    for (std::size_t i = 0; i < p_.front.size(); ++i) {
      if (i == 0)
        d = fmt::format("M{:.1f} {:.1f}V{:.1f}", px(p_.front[0]), y_.to, py(p_.front[0]));
      else
        d += fmt::format("H{:.1f}V{:.1f}", px(p_.front[i]), py(p_.front[i]));
    }
    if (!d.empty()) out_ += fmt::format("<path class=\"front\" d=\"{}H{}\"/>\n", d, x_.to);
  }

  void lines() {
    for (const PlotLine& l : p_.lines) {
      double x0 = x_.low, x1 = x_.high;
      const auto y = [&](double x) { return l.slope * x + l.intercept; };
      // Cut to the height of the plot.
      if (l.slope != 0) {
        const double a = (y_.low - l.intercept) / l.slope, b = (y_.high - l.intercept) / l.slope;
        x0 = std::max(x0, std::min(a, b)), x1 = std::min(x1, std::max(a, b));
      }
      if (x0 < x1)
        out_ += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n",
                            l.dashed ? "theory" : "fit", x_.at_log(x0), y_.at_log(y(x0)), x_.at_log(x1),
                            y_.at_log(y(x1)));
    }
  }

  void series(const PlotSeries& s) {
    out_ += fmt::format("<g class=\"s{}\">", s.color % 10);
    std::string path;
    for (const PlotPoint& q : s.points)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px(q), py(q));
    if (s.joined && s.points.size() > 1) out_ += fmt::format("<path class=\"join\" d=\"{}\"/>", path);
    for (const PlotPoint& q : s.points)
      out_ += fmt::format(
          "<circle class=\"{}\" data-point=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" "
          "r=\"{}\"><title>{}</title></circle>",
          q.ring    ? "dot ring"
          : q.y > 0 ? "dot"
                    : "dot exact",
          q.index, px(q), py(q), q.ring ? 6 : 4.5, escaped(q.title));
    out_ += "</g>\n";
  }

  const Plot& p_;
  Axis x_, y_;
  std::string out_;
};

}  // namespace

std::string svg(const Plot& p) { return Drawing(p).text(); }

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

}  // namespace frustum
