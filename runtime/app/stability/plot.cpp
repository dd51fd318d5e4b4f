#include "runtime/app/stability/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace frustum::stability {
namespace {

constexpr double width = 720, height = 340, left = 70, right = 20, top = 40, bottom = 50;
constexpr double least_decade = -2, most_decade = 9;

struct Axes {
  double x0, x1;
  double x(double v) const { return left + (v - x0) / (x1 - x0) * (width - left - right); }
  double y(double error) const {
    const double decade = std::clamp(std::log10(std::max(error, 1e-300)), least_decade, most_decade);
    return height - bottom - (decade - least_decade) / (most_decade - least_decade) * (height - top - bottom);
  }
};

std::string text_at(double x, double y, const std::string& anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, text);
}

std::string grid(const Axes& axes) {
  std::string out;
  for (int decade = static_cast<int>(least_decade); decade <= static_cast<int>(most_decade); decade += 1) {
    const double y = axes.y(std::pow(10.0, decade));
    out += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#ddd\"/>\n", left, y, width - right);
    if (decade % 3 == 0)
      out += text_at(left - 8, y + 4, "end", decade == 0 ? "1" : fmt::format("1e{}", decade));
  }
  for (double v = std::ceil(axes.x0 / 40) * 40; v <= axes.x1; v += 40) {
    out +=
        fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"#ddd\"/>\n", axes.x(v), top, height - bottom);
    out += text_at(axes.x(v), height - bottom + 18, "middle", fmt::format("2^{:.0f}", v));
  }
  return out;
}

}  // namespace

std::string svg_text(const Plot& plot) {
  Axes axes{1e300, -1e300};
  for (const Series& s : plot.series)
    for (const auto& [x, error] : s.points) axes.x0 = std::min(axes.x0, x), axes.x1 = std::max(axes.x1, x);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" "
      "font-size=\"13\" fill=\"#222\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#fff\"/>\n",
      width, height);
  out += grid(axes);
  out += text_at(left, 22, "start", "<tspan font-weight=\"bold\">" + plot.title + "</tspan>");
  out += text_at((left + width - right) / 2, height - 12, "middle", plot.x_label);
  out +=
      fmt::format("<text transform=\"translate(18 {:.0f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                  (top + height - bottom) / 2, plot.y_label);
  if (plot.bound > 0)
    out +=
        fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#222\" stroke-dasharray=\"6 4\"/>\n", left,
                    axes.y(plot.bound), width - right) +
        text_at(width - right - 4, axes.y(plot.bound) - 6, "end", fmt::format("the bound, {:g}", plot.bound));
  double legend = left + 12;
  for (const Series& s : plot.series) {
    std::string path;
    for (const auto& [x, error] : s.points)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", axes.x(x), axes.y(error));
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", path, s.color);
    out += fmt::format("<path d=\"M{:.0f} 58h24\" stroke=\"{}\" stroke-width=\"3\"/>\n", legend, s.color);
    out += text_at(legend + 30, 62, "start", s.name);
    legend += 60 + 7.5 * static_cast<double>(s.name.size());
  }
  return out + "</svg>\n";
}

}  // namespace frustum::stability
