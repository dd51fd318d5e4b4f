#include "runtime/buffers/image.h"

#include "runtime/buffers/buffer_ops.h"
#include "runtime/buffers/numbers.h"
#include "runtime/buffers/pattern.h"
#include "runtime/core/health.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <nlohmann/json.hpp>

#include <type_traits>

namespace frustum {
namespace {

constexpr std::array kind_names{"f32", "f64", "u32"};
constexpr std::array alpha_names{"none", "straight", "premultiplied"};

// Calls body with the plane's type as a null pointer: body(static_cast<const float*>(nullptr)).
template <class Body>
decltype(auto) with_type(PlaneKind kind, Body&& body) {
  switch (kind) {
    case PlaneKind::f64: return body(static_cast<const double*>(nullptr));
    case PlaneKind::u32: return body(static_cast<const std::uint32_t*>(nullptr));
    case PlaneKind::f32: break;
  }
  return body(static_cast<const float*>(nullptr));
}

template <class T>
std::span<const T> row_of(const Tile& t, int plane, int sample, int y) {
  return {t.row<const T>(plane, sample, y), static_cast<std::size_t>(t.rect().width())};
}

int plane_count(const Raster& r) { return static_cast<int>(r.frame().planes.size()); }

// Bands of 64 rows in parallel, joined from the top: the first place is in the topmost band that has one.
Health raster_health(const Raster& r) {
  const Rect w = r.frame().window;
  std::vector<Health> bands(static_cast<std::size_t>((w.height() + 63) / 64));
  tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t i) {
    const int y = w.y0 + static_cast<int>(i) * 64;
    bands[i] = health_of(r.view({w.x0, y, w.x1, std::min(y + 64, w.y1)}));
  });
  Health sum;
  for (const Health& h : bands) sum.add(h);
  return sum;
}

void hash_plane(const Raster& r, int plane, Hasher& h) {
  const Tile t = r.view();
  with_type(r.frame().planes[static_cast<std::size_t>(plane)].kind, [&]<class T>(const T*) {
    for (int s = 0; s < t.samples(); ++s)
      for (int y = t.rect().y0; y < t.rect().y1; ++y) {
        const auto row = row_of<T>(t, plane, s, y);
        h.bytes(row.data(), row.size_bytes());
      }
  });
}

// Statistics of one plane; of an id plane those of the faces, with the samples that show none counted apart.
Json plane_summary(const Raster& r, int plane) {
  const Plane& p = r.frame().planes[static_cast<std::size_t>(plane)];
  const Tile t = r.view();
  Hasher h;
  hash_plane(r, plane, h);
  Json out = {
      {"name", p.name}, {"kind", kind_names[static_cast<std::size_t>(p.kind)]}, {"digest", to_hex(h.done())}};
  with_type(p.kind, [&]<class T>(const T*) {
    std::vector<T> values;
    values.reserve(static_cast<std::size_t>(t.rect().area()) * static_cast<std::size_t>(t.samples()));
    for (int s = 0; s < t.samples(); ++s)
      for (int y = t.rect().y0; y < t.rect().y1; ++y) {
        const auto row = row_of<T>(t, plane, s, y);
        values.insert(values.end(), row.begin(), row.end());
      }
    if constexpr (std::is_same_v<T, std::uint32_t>)
      if (p.name == "id") out["no_face"] = std::erase(values, no_face);
    out.update(to_json(measure(std::move(values))));
  });
  return out;
}

// Counts and ids are integers; where an id plane shows no face it is null.
Json json_value(const Tile& t, int plane, int sample, int x, int y) {
  const Plane& p = t.frame().planes[static_cast<std::size_t>(plane)];
  return with_type(p.kind, [&]<class T>(const T*) {
    const T value = t.row<const T>(plane, sample, y)[x - t.rect().x0];
    if constexpr (std::is_same_v<T, std::uint32_t>)
      return p.name == "id" && value == no_face ? Json(nullptr) : Json(value);
    else
      return json_number(value);
  });
}

void save_raster(const Raster& r, ArchiveWriter& w) {
  const Frame& f = r.frame();
  w.value(f.window.x0).value(f.window.y0).value(f.window.x1).value(f.window.y1);
  save_part(f.pattern, w);
  w.value(std::uint64_t{f.planes.size()});
  for (const Plane& p : f.planes) w.text(p.name).value(p.kind);
  w.text(f.color_space).value(f.alpha);
  const Tile t = r.view();
  for (int p = 0; p < plane_count(r); ++p)
    with_type(f.planes[static_cast<std::size_t>(p)].kind, [&]<class T>(const T*) {
      for (int s = 0; s < t.samples(); ++s)
        for (int y = t.rect().y0; y < t.rect().y1; ++y) {
          const auto row = row_of<T>(t, p, s, y);
          w.raw(row.data(), row.size_bytes());
        }
    });
}

Raster load_raster(ArchiveReader& r) {
  Frame f;
  for (int* side : {&f.window.x0, &f.window.y0, &f.window.x1, &f.window.y1}) *side = r.value<int>();
  f.pattern = load_part<SamplePattern>(r);
  for (std::size_t n = r.count(1); n > 0; --n) {
    std::string name = r.text();
    f.planes.push_back({std::move(name), r.choice(PlaneKind::u32)});
  }
  f.color_space = r.text();
  f.alpha = r.choice(Alpha::premultiplied);
  const std::size_t pixel = f.bytes_per_pixel();
  if (pixel != 0 && static_cast<std::uint64_t>(f.window.area()) > r.left() / pixel)
    throw ArchiveError("more pixels than bytes");
  Raster raster(std::move(f));
  const Tile t = raster.view();
  for (int p = 0; p < plane_count(raster); ++p)
    with_type(raster.frame().planes[static_cast<std::size_t>(p)].kind, [&]<class T>(const T*) {
      for (int s = 0; s < t.samples(); ++s)
        for (int y = t.rect().y0; y < t.rect().y1; ++y)
          r.raw(t.row<T>(p, s, y), static_cast<std::size_t>(t.rect().width()) * sizeof(T));
    });
  return raster;
}

template <class Kind>
struct Ops {
  static void save(const Kind& k, ArchiveWriter& w) { save_raster(k.raster, w); }
  static Kind load(ArchiveReader& r) { return Kind{load_raster(r)}; }
  static std::size_t bytes(const Kind& k) { return sizeof k + k.raster.bytes(); }
  static const Raster& raster(const Kind& k) { return k.raster; }
  // The frame lies in the storage that copies of a raster share, so its address stands for it.
  static void parts(const Kind& k, const std::function<void(const void*, std::size_t)>& visit) {
    visit(&k.raster.frame(), k.raster.bytes());
  }
  static Buffer from_raster(Raster r) { return std::make_shared<const Kind>(Kind{std::move(r)}); }

  static void hash(const Kind& k, Hasher& h) {
    const Frame& f = k.raster.frame();
    h.value(f.window.x0).value(f.window.y0).value(f.window.x1).value(f.window.y1);
    h.value(f.pattern != nullptr);
    if (f.pattern) h.value(Buffer(f.pattern).digest());
    h.text(f.color_space).value(f.alpha).value(f.planes.size());
    for (const Plane& p : f.planes) h.text(p.name).value(p.kind);
    for (int p = 0; p < plane_count(k.raster); ++p) hash_plane(k.raster, p, h);
  }
  static Health health(const Kind& k) { return raster_health(k.raster); }
  static Json summary(const Kind& k) {
    const Frame& f = k.raster.frame();
    Json planes = Json::array();
    for (int p = 0; p < plane_count(k.raster); ++p) planes.push_back(plane_summary(k.raster, p));
    return {{"window", {f.window.x0, f.window.y0, f.window.x1, f.window.y1}},
            {"width", f.window.width()},
            {"height", f.window.height()},
            {"samples", f.samples()},
            {"color_space", f.color_space},
            {"alpha", alpha_names[static_cast<std::size_t>(f.alpha)]},
            {"planes", std::move(planes)}};
  }
  // One row a sample, pixels from the top left.
  static Json table(const Kind& k, std::size_t first, std::size_t count) {
    const Tile t = k.raster.view();
    const Rect w = t.rect();
    const bool sampled = t.samples() > 1;
    Json names = {"x", "y"};
    if (sampled) names.push_back("sample");
    for (const Plane& p : k.raster.frame().planes) names.push_back(p.name);
    const auto samples = static_cast<std::size_t>(t.samples()), width = static_cast<std::size_t>(w.width());
    const std::size_t total = static_cast<std::size_t>(w.area()) * samples;
    return json_table(std::move(names), total, first, count, [&](std::size_t i) {
      const int sample = static_cast<int>(i % samples), x = w.x0 + static_cast<int>(i / samples % width);
      const int y = w.y0 + static_cast<int>(i / samples / width);
      Json row = {x, y};
      if (sampled) row.push_back(sample);
      for (int p = 0; p < plane_count(k.raster); ++p) row.push_back(json_value(t, p, sample, x, y));
      return row;
    });
  }
};

}  // namespace

template <>
const BufferType& buffer_type<Image>() {
  static const BufferType type = make_buffer_type<Image, Ops<Image>>(
      "image", "Named planes of numbers over pixels: colours or attributes.", "#d9a441");
  return type;
}
template <>
const BufferType& buffer_type<Depth>() {
  static const BufferType type =
      make_buffer_type<Depth, Ops<Depth>>("depth", "The depth of what is seen at each sample.", "#7d8ca3");
  return type;
}
template <>
const BufferType& buffer_type<Visibility>() {
  static const BufferType type = make_buffer_type<Visibility, Ops<Visibility>>(
      "visibility", "Which face is seen at each sample, and how deep.", "#8d6fc4");
  return type;
}

}  // namespace frustum
