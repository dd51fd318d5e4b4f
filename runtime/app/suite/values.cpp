#include "runtime/app/suite/values.h"

#include "runtime/buffers/mesh.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

NumberKind kind_of(PlaneKind k) {
  return k == PlaneKind::f32 ? NumberKind::f32 : k == PlaneKind::f64 ? NumberKind::f64 : NumberKind::u32;
}

template <class T>
void append_row(const Tile& tile, int plane, int sample, int y, std::vector<double>& out) {
  const T* row = tile.row<T>(plane, sample, y);
  out.insert(out.end(), row, row + tile.rect().width());
}

Values values_of(const Mesh& mesh) {
  Values v;
  for (const auto& c : mesh.columns) {
    Series& s = v.series.emplace_back(Series{c->name(), c->kind(), c->width(), {}});
    s.values.reserve(c->rows() * static_cast<std::size_t>(c->width()));
    for (std::size_t row = 0; row < c->rows(); ++row)
      for (int k = 0; k < c->width(); ++k) s.values.push_back(c->number(row, k));
  }
  return v;
}

// What json_number wrote for a number that JSON cannot hold.
std::optional<double> number_in(const Json& cell) {
  if (cell.is_number()) return cell.get<double>();
  if (cell == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (cell == "inf") return std::numeric_limits<double>::infinity();
  if (cell == "-inf") return -std::numeric_limits<double>::infinity();
  return std::nullopt;
}

Values values_of_table(const Json& table) {
  Values v;
  const Json& columns = table.at("columns");
  for (std::size_t c = 0; c < columns.size(); ++c) {
    Series s{columns[c].get<std::string>(), NumberKind::f64, 1, {}};
    bool numbers = true;  // a column of texts is left out, cells beyond the end of a short one are null
    for (const Json& row : table.at("rows"))
      if (const auto number = number_in(row.at(c)))
        s.values.push_back(*number);
      else
        numbers &= row.at(c).is_null();
    if (numbers && !s.values.empty()) v.series.push_back(std::move(s));
  }
  return v;
}

// Bits of a real number in an order in which neighbours differ by one.
template <class Real, class Bits>
Bits ordered(double value) {
  const auto bits = std::bit_cast<Bits>(static_cast<Real>(value));
  constexpr Bits sign = Bits{1} << (sizeof(Bits) * 8 - 1);
  return (bits & sign) != 0 ? sign - (bits & ~sign) : sign + bits;
}

template <class Real, class Bits>
double steps(double a, double b) {
  const Bits x = ordered<Real, Bits>(a), y = ordered<Real, Bits>(b);
  return static_cast<double>(x > y ? x - y : y - x);
}

}  // namespace

const Series* Values::find(std::string_view name) const {
  if (name.empty()) return series.empty() ? nullptr : &series.front();
  const auto found =
      std::find_if(series.begin(), series.end(), [&](const Series& s) { return s.name == name; });
  return found != series.end() ? &*found : nullptr;
}

std::vector<std::string> Values::names() const {
  std::vector<std::string> out;
  for (const Series& s : series) out.push_back(s.name);
  return out;
}

std::string Values::place(const Series& s, std::size_t value) const {
  if (!window) return fmt::format("{}, row {}", s.name, value / static_cast<std::size_t>(s.width));
  const auto width = static_cast<std::size_t>(window->width()),
             height = static_cast<std::size_t>(window->height());
  const std::string sample = samples > 1 ? fmt::format(" sample {}", value / (width * height)) : "";
  return fmt::format("{} at {},{}{}", s.name, window->x0 + static_cast<int>(value % width),
                     window->y0 + static_cast<int>(value / width % height), sample);
}

Values values_of(const Raster& raster) {
  const Frame& f = raster.frame();
  Values v{.series = {}, .window = f.window, .samples = f.samples()};
  const Tile tile = raster.view();
  for (std::size_t p = 0; p < f.planes.size(); ++p) {
    if (!tile.has(static_cast<int>(p))) continue;  // nobody reads it, so that it has no numbers
    Series& s = v.series.emplace_back(Series{f.planes[p].name, kind_of(f.planes[p].kind), 1, {}});
    s.values.reserve(static_cast<std::size_t>(f.window.area()) * static_cast<std::size_t>(f.samples()));
    for (int sample = 0; sample < f.samples(); ++sample)
      for (int y = f.window.y0; y < f.window.y1; ++y) switch (f.planes[p].kind) {
          case PlaneKind::f32: append_row<float>(tile, static_cast<int>(p), sample, y, s.values); break;
          case PlaneKind::f64: append_row<double>(tile, static_cast<int>(p), sample, y, s.values); break;
          case PlaneKind::u32:
            append_row<std::uint32_t>(tile, static_cast<int>(p), sample, y, s.values);
            break;
        }
  }
  return v;
}

Values values_of(const Buffer& buffer) {
  if (buffer.type().is_pixels()) return values_of(buffer.type().raster(buffer.data()));
  if (const auto mesh = buffer.as<Mesh>()) return values_of(*mesh);
  if (buffer.type().table == nullptr)
    throw NodeError("no_numbers",
                    fmt::format("a buffer of kind {} has no numbers to look at", buffer.type().name));
  return values_of_table(buffer.type().table(buffer.data(), 0, std::numeric_limits<std::size_t>::max()));
}

double steps_between(double a, double b, NumberKind kind) {
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::infinity();
  switch (kind) {
    case NumberKind::f32: return steps<float, std::uint32_t>(a, b);
    case NumberKind::f64: return steps<double, std::uint64_t>(a, b);
    case NumberKind::i32:
    case NumberKind::u32: break;
  }
  return std::abs(a - b);
}

bool close(double a, double b, const Closeness& c, NumberKind kind) {
  if (std::isnan(a) || std::isnan(b)) return false;
  if (a == b) return true;
  const double distance = std::abs(a - b);
  if (std::isinf(distance)) return false;
  return (c.abs && distance <= *c.abs) || (c.rel && distance <= *c.rel * std::abs(b)) ||
         (c.ulp && steps_between(a, b, kind) <= *c.ulp);
}

}  // namespace frustum
