#include "nodes/check/statistics.h"

#include "nodes/check.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/numbers.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  std::variant<Ref<Image>, Ref<Depth>, Ref<Visibility>> image;
};
struct Params {};
struct Outputs {
  Ref<Table> table;
};

// All samples of a plane, in the order sample, row, column.
template <class T>
std::vector<T> values_of(const Raster& r, int plane) {
  const Frame& f = r.frame();
  std::vector<T> all;
  all.reserve(static_cast<std::size_t>(f.window.area()) * static_cast<std::size_t>(f.samples()));
  for (int s = 0; s < f.samples(); ++s)
    for (int y = f.window.y0; y < f.window.y1; ++y) {
      const T* row = r.view().row<const T>(plane, s, y);
      all.insert(all.end(), row, row + f.window.width());
    }
  return all;
}

struct Measured {
  Statistics numbers;
  double deviation = 0;
};

template <class T>
Measured measure_plane(const Raster& r, int plane) {
  std::vector<T> values = values_of<T>(r, plane);
  Measured m{measure(values), 0};
  Deviation deviation(m.numbers.mean);
  for (const T v : values) deviation.add(static_cast<double>(v));
  m.deviation = deviation.value();
  return m;
}

Measured measure_plane(const Raster& r, int plane) {
  switch (r.frame().planes[static_cast<std::size_t>(plane)].kind) {
    case PlaneKind::f64: return measure_plane<double>(r, plane);
    case PlaneKind::u32: return measure_plane<std::uint32_t>(r, plane);
    case PlaneKind::f32: break;
  }
  return measure_plane<float>(r, plane);
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  auto table = std::make_shared<Table>();
  std::vector<std::string> names{"min", "max", "mean", "deviation"};
  for (const double q : Statistics::quantiles) names.push_back(fmt::format("p{:g}", 100 * q));
  for (const char* name : {"finite", "nan", "inf", "-inf"}) names.emplace_back(name);
  table->columns.push_back({.name = "plane"});
  for (const std::string& name : names) table->columns.push_back({.name = name});

  const Raster& r = std::visit([](const auto& image) -> const Raster& { return image->raster; }, in.image);
  for (int p = 0; p < static_cast<int>(r.frame().planes.size()); ++p) {
    ctx.poll();
    const auto [n, deviation] = measure_plane(r, p);
    std::vector<double> row{n.min, n.max, n.mean, deviation};
    row.insert(row.end(), n.percentiles.begin(), n.percentiles.end());
    for (const std::uint64_t count : {n.count, n.nan, n.positive_infinity, n.negative_infinity})
      row.push_back(static_cast<double>(count));
    table->columns[0].texts.push_back(r.frame().planes[static_cast<std::size_t>(p)].name);
    for (std::size_t i = 0; i < row.size(); ++i) table->columns[i + 1].numbers.push_back(row[i]);
  }
  return {table};
}

}  // namespace

NodeType nodes::check_statistics() {
  return node("check.statistics", run)
      .doc(
          "Measures every plane of pixels: least, largest, mean, deviation, percentiles, and what is not "
          "finite.")
      .cite("Chan, Golub & LeVeque 1983, Algorithms for computing the sample variance, doi:10.2307/2683386")
      .input("image", &Inputs::image,
             "Colours, attributes, depths or what is seen; all samples of a plane count alike.")
      .output("table", &Outputs::table,
              "A row for each plane; numbers are of its finite values, 0 where there is none.");
}

}  // namespace frustum
