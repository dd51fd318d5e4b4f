#include "runtime/app/metrics/difference.h"

#include "runtime/buffers/mesh.h"
#include "runtime/buffers/numbers.h"
#include "runtime/core/diagnostic.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <unordered_map>

namespace frustum {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// The integers in the order of the floating-point numbers, both zeros at 0.
template <class R, class I>
I ordinal(R v) {
  const I bits = std::bit_cast<I>(v);
  return bits >= 0 ? bits : std::numeric_limits<I>::min() - bits;
}
template <class R, class I>
std::uint64_t ulps(R a, R b) {
  if (std::isinf(a) != std::isinf(b)) return UlpHistogram::infinite;
  const auto x = static_cast<std::uint64_t>(ordinal<R, I>(a)),
             y = static_cast<std::uint64_t>(ordinal<R, I>(b));
  return ordinal<R, I>(a) > ordinal<R, I>(b) ? x - y : y - x;
}

template <class T>
constexpr bool is_id = std::is_integral_v<T>;

template <class T>
bool same_bits(T a, T b) {
  if constexpr (is_id<T>)
    return a == b;
  else
    return std::bit_cast<std::array<std::byte, sizeof(T)>>(a) ==
           std::bit_cast<std::array<std::byte, sizeof(T)>>(b);
}

// a == b covers infinities, whose difference is NaN.
double distance(double a, double b) { return a == b ? 0 : std::abs(a - b); }

// One pass over pairs: `see` gives where the pair is as soon as it is the worst one.
class Tally {
 public:
  explicit Tally(Difference& d) : d_(d) {}

  template <class A, class B, class Place>
  void see(A a, B b, Place&& place) {
    ++d_.values;
    bool same = false;
    if constexpr (std::is_same_v<A, B>)
      same = same_bits(a, b);
    else
      same = static_cast<double>(a) == static_cast<double>(b);
    d_.differing += same ? 0 : 1;
    const auto x = static_cast<double>(a), y = static_cast<double>(b);
    if constexpr (is_id<A> || is_id<B>) {
      ++d_.ids;
      d_.wrong_ids += x == y ? 0 : 1;
      if (x != y) rank(0, x, y, place);
    } else {
      const bool nan = std::isnan(x) || std::isnan(y);
      if (!same || nan)
        number(a, b, nan, place);
      else
        d_.ulps.add(0);
      if (std::abs(y) > d_.largest && std::abs(y) < infinity) d_.largest = std::abs(y);
      ++numbers_;
    }
  }

  void finish() {
    d_.max = d_.nan != 0 ? nan_value : std::max(max_, 0.0);
    if (d_.nan != 0) squares_ = relative_ = nan_value;
    const auto n = static_cast<double>(std::max<std::uint64_t>(1, numbers_));
    d_.rmse = std::sqrt(squares_ / n);
    d_.mrse = relative_ / n;
    d_.psnr = d_.rmse == 0 ? infinity : -20 * std::log10(d_.rmse);
  }

 private:
  template <class A, class B, class Place>
  void number(A a, B b, bool nan, Place&& place) {
    const auto x = static_cast<double>(a), y = static_cast<double>(b);
    d_.nan += nan ? 1 : 0;
    const double e = nan ? infinity : distance(x, y);
    if (!nan) {
      squares_ += e * e;
      const double relative = e == 0 ? 0 : std::isinf(e) ? infinity : e / (std::abs(y) + 0.01);
      relative_ += relative * relative;
      max_ = std::max(max_, e);
      if constexpr (std::is_same_v<A, double> && std::is_same_v<B, double>)
        d_.ulps.add(ulps_between(a, b));
      else
        d_.ulps.add(ulps_between(static_cast<float>(a), static_cast<float>(b)));
    }
    rank(e, x, y, place);
  }

  template <class Place>
  void rank(double e, double x, double y, Place&& place) {
    if (e <= worst_) return;
    worst_ = e;
    d_.worst = place();
    d_.worst->a = x, d_.worst->b = y;
  }

  Difference& d_;
  std::uint64_t numbers_ = 0;
  double squares_ = 0, relative_ = 0, max_ = 0, worst_ = -1;
};

// Calls f with a null pointer of the type that the kind stores.
template <class F>
decltype(auto) with_type(PlaneKind kind, F&& f) {
  switch (kind) {
    case PlaneKind::f32: return f(static_cast<const float*>(nullptr));
    case PlaneKind::f64: return f(static_cast<const double*>(nullptr));
    case PlaneKind::u32: break;
  }
  return f(static_cast<const std::uint32_t*>(nullptr));
}
template <class F>
decltype(auto) with_type(NumberKind kind, F&& f) {
  switch (kind) {
    case NumberKind::f32: return f(static_cast<const float*>(nullptr));
    case NumberKind::f64: return f(static_cast<const double*>(nullptr));
    case NumberKind::i32: return f(static_cast<const std::int32_t*>(nullptr));
    case NumberKind::u32: break;
  }
  return f(static_cast<const std::uint32_t*>(nullptr));
}

// Calls see(plane of a, sample, y, x, value of a, value of b) for every pair, planes outermost.
template <class See>
void each_pair(const Raster& a, const Raster& b, const See& see) {
  const Frame& f = a.frame();
  if (f.window.empty()) return;
  const Tile ta = a.view(), tb = b.view();
  for (int p = 0; p < static_cast<int>(f.planes.size()); ++p) {
    const Plane& plane = f.planes[static_cast<std::size_t>(p)];
    const int q = *b.frame().find(plane.name);
    with_type(plane.kind, [&]<class A>(const A*) {
      with_type(b.frame().planes[static_cast<std::size_t>(q)].kind, [&]<class B>(const B*) {
        for (int s = 0; s < f.samples(); ++s)
          for (int y = f.window.y0; y < f.window.y1; ++y) {
            const A* ra = ta.row<A>(p, s, y);
            const B* rb = tb.row<B>(q, s, y);
            for (int i = 0; i < f.window.width(); ++i) see(p, s, y, f.window.x0 + i, ra[i], rb[i]);
          }
      });
    });
  }
}

std::string shown(const Rect& r) { return fmt::format("{}x{} at {},{}", r.width(), r.height(), r.x0, r.y0); }

// What only one side has, as a sentence; empty where both have the same names.
std::string unmatched(const std::vector<std::string>& a, const std::vector<std::string>& b,
                      const char* what) {
  const auto missing = [](const std::vector<std::string>& from, const std::vector<std::string>& in) {
    std::vector<std::string> out;
    for (const std::string& n : from)
      if (std::find(in.begin(), in.end(), n) == in.end()) out.push_back(n);
    return out;
  };
  // A name of the other side that is near is probably the same one, written wrong.
  const auto told = [&](std::string_view side, const std::vector<std::string>& only,
                        const std::vector<std::string>& other) {
    std::string out = fmt::format("only the {} has the {} {}", side, what, fmt::join(only, ", "));
    for (const std::string& n : only)
      if (const auto near = nearest_names(n, other); !near.empty())
        return fmt::format("{}; the other has '{}', near to '{}'", out, near.front(), n);
    return out;
  };
  const auto only_a = missing(a, b), only_b = missing(b, a);
  if (!only_a.empty()) return told("first", only_a, only_b);
  if (!only_b.empty()) return told("second", only_b, only_a);
  return {};
}

std::string mismatch(const Frame& a, const Frame& b) {
  if (a.window != b.window)
    return fmt::format("the windows differ: {} and {}", shown(a.window), shown(b.window));
  if (a.samples() != b.samples())
    return fmt::format("the samples a pixel differ: {} and {}", a.samples(), b.samples());
  std::vector<std::string> names_a, names_b;
  for (const Plane& p : a.planes) names_a.push_back(p.name);
  for (const Plane& p : b.planes) names_b.push_back(p.name);
  return unmatched(names_a, names_b, "planes");
}

// ----- meshes

std::string key_of(const Column& c) { return fmt::format("{} {}", name_of(c.domain()), c.name()); }

std::string component_name(const Column& c, int component) {
  return c.width() == 1 ? c.name() : fmt::format("{}.{}", c.name(), "xyzw"[component & 3]);
}

void compare_column(const Column& a, const Column& b, Tally& tally) {
  with_type(a.kind(), [&]<class A>(const A*) {
    with_type(b.kind(), [&]<class B>(const B*) {
      const A* va = static_cast<const A*>(a.data());
      const B* vb = static_cast<const B*>(b.data());
      const auto width = static_cast<std::size_t>(a.width());
      for (std::size_t i = 0; i < a.rows() * width; ++i)
        tally.see(va[i], vb[i], [&] {
          WorstValue w;
          w.plane = component_name(a, static_cast<int>(i % width)), w.row = i / width;
          return w;
        });
    });
  });
}

Difference compare_meshes(const Mesh& a, const Mesh& b) {
  Difference d;
  std::vector<std::string> names_a, names_b;
  for (const auto& c : a.columns) names_a.push_back(key_of(*c));
  for (const auto& c : b.columns) names_b.push_back(key_of(*c));
  if (a.vertices() != b.vertices() || a.faces() != b.faces())
    d.mismatch = fmt::format("the sizes differ: {} vertices, {} faces and {} vertices, {} faces",
                             a.vertices(), a.faces(), b.vertices(), b.faces());
  else
    d.mismatch = unmatched(names_a, names_b, "columns");
  Tally tally(d);
  for (std::size_t i = 0; d.mismatch.empty() && i < a.columns.size(); ++i) {
    const auto at = std::find(names_b.begin(), names_b.end(), names_a[i]);
    const Column& other = *b.columns[static_cast<std::size_t>(at - names_b.begin())];
    const Column& mine = *a.columns[i];
    if (mine.width() != other.width() || mine.rows() != other.rows())
      d.mismatch = fmt::format("the columns '{}' differ in shape: {}x{} and {}x{}", mine.name(), mine.rows(),
                               mine.width(), other.rows(), other.width());
    else
      compare_column(mine, other, tally);
  }
  tally.finish();
  return d;
}

// ----- tables

// Numbers, and what json_number() writes for those that JSON has none of.
std::optional<double> number_of(const Json& cell) {
  if (cell.is_number()) return cell.get<double>();
  if (cell == "nan") return nan_value;
  if (cell == "inf") return infinity;
  if (cell == "-inf") return -infinity;
  return std::nullopt;
}

// Where each column of `a` stands in `b`, which has the same names: the first of a name with the first, the second with
// the second.
std::vector<std::size_t> places_of(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  std::unordered_map<std::string_view, std::vector<std::size_t>> left;
  for (std::size_t i = b.size(); i-- > 0;) left[b[i]].push_back(i);
  std::vector<std::size_t> out;
  for (const std::string& name : a) {
    auto& places = left[name];
    out.push_back(places.back());
    if (places.size() > 1) places.pop_back();
  }
  return out;
}

std::string bin_name(std::size_t k) {
  if (k < 2) return std::to_string(k);
  if (k == 65) return "infinite";
  const std::uint64_t low = std::uint64_t{1} << (k - 1);
  return fmt::format("{}-{}", low, low + (low - 1));
}

}  // namespace

std::string WorstValue::place() const {
  if (row) return fmt::format("{} of row {}", plane, *row);
  return sample == 0 ? fmt::format("{} at {},{}", plane, x, y)
                     : fmt::format("{} at {},{} sample {}", plane, x, y, sample);
}

std::uint64_t ulps_between(float a, float b) { return ulps<float, std::int32_t>(a, b); }
std::uint64_t ulps_between(double a, double b) { return ulps<double, std::int64_t>(a, b); }

Difference compare(const Raster& a, const Raster& b) {
  Difference d;
  d.mismatch = mismatch(a.frame(), b.frame());
  if (!d.mismatch.empty()) return d;
  Tally tally(d);
  each_pair(a, b, [&](int plane, int sample, int y, int x, auto va, auto vb) {
    tally.see(va, vb, [&] {
      return WorstValue{a.frame().planes[static_cast<std::size_t>(plane)].name, x, y, sample, {}, 0, 0};
    });
  });
  tally.finish();
  return d;
}

Difference compare(const Buffer& a, const Buffer& b) {
  const BufferType& type = a.type();
  if (&type != &b.type()) {
    Difference d;
    d.mismatch = fmt::format("the kinds differ: {} and {}", type.name, b.type().name);
    return d;
  }
  if (type.is_pixels()) return compare(type.raster(a.data()), type.raster(b.data()));
  if (a.is<Mesh>()) return compare_meshes(*a.as<Mesh>(), *b.as<Mesh>());
  constexpr auto all = std::numeric_limits<std::size_t>::max();
  if (type.table != nullptr)
    if (const Json table = type.table(a.data(), 0, all); !table.is_null())
      return compare_tables(table, type.table(b.data(), 0, all));
  Difference d;
  d.values = d.ids = 1;
  d.differing = d.wrong_ids = a.digest() == b.digest() ? 0 : 1;
  d.psnr = infinity;
  return d;
}

Difference compare_tables(const Json& a, const Json& b) {
  Difference d;
  const auto& rows_a = a.at("rows");
  const auto& rows_b = b.at("rows");
  const auto names_a = a.at("columns").get<std::vector<std::string>>(),
             names_b = b.at("columns").get<std::vector<std::string>>();
  d.mismatch = unmatched(names_a, names_b, "columns");
  if (d.mismatch.empty() && names_a.size() != names_b.size())
    d.mismatch = fmt::format("the columns differ: {} and {}", names_a.size(), names_b.size());
  if (d.mismatch.empty() && rows_a.size() != rows_b.size())
    d.mismatch = fmt::format("the sizes differ: {} rows and {} rows", rows_a.size(), rows_b.size());
  if (!d.mismatch.empty()) return d;
  const std::vector<std::size_t> of_b = places_of(names_a, names_b);
  Tally tally(d);
  for (std::size_t r = 0; r < rows_a.size(); ++r)
    for (std::size_t c = 0; c < rows_a[r].size(); ++c) {
      const auto place = [&] {
        WorstValue w;
        w.plane = names_a[c], w.row = r;
        return w;
      };
      const Json &cell_a = rows_a[r][c], &cell_b = rows_b[r].at(of_b[c]);
      const auto x = number_of(cell_a), y = number_of(cell_b);
      if (x && y)
        tally.see(*x, *y, place);
      else
        tally.see(0u, cell_a == cell_b ? 0u : 1u, place);  // texts are ids
    }
  tally.finish();
  return d;
}

std::uint64_t count_beyond(const Raster& a, const Raster& b, double tolerance) {
  std::uint64_t count = 0;
  each_pair(a, b, [&]<class A, class B>(int, int, int, int, A va, B vb) {
    const double e = distance(static_cast<double>(va), static_cast<double>(vb));
    count += e <= (is_id<A> || is_id<B> ? 0 : tolerance) ? 0 : 1;
  });
  return count;
}

Json to_json(const Difference& d) {
  if (!d.mismatch.empty()) return {{"mismatch", d.mismatch}, {"identical", false}};
  Json histogram = Json::object();
  for (std::size_t k = 0; k < d.ulps.bins.size(); ++k)
    if (d.ulps.bins[k] != 0) histogram[bin_name(k)] = d.ulps.bins[k];
  Json out = {{"identical", d.identical()},
              {"values", d.values},
              {"differing", d.differing},
              {"nan", d.nan},
              {"ids", d.ids},
              {"wrong_ids", d.wrong_ids},
              {"rmse", json_number(d.rmse)},
              {"mrse", json_number(d.mrse)},
              {"max", json_number(d.max)},
              {"psnr", json_number(d.psnr)},
              {"ulps", {{"max", d.ulps.max}, {"histogram", histogram}}}};
  if (!d.worst) return out;
  const WorstValue& w = *d.worst;
  out["worst"] = {{"plane", w.plane}, {"a", json_number(w.a)}, {"b", json_number(w.b)}};
  if (w.row)
    out["worst"]["row"] = *w.row;
  else
    out["worst"].update({{"x", w.x}, {"y", w.y}, {"sample", w.sample}});
  return out;
}

}  // namespace frustum
