#include "runtime/app/report/buffers.h"

#include "runtime/buffers/camera.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/surface.h"
#include "runtime/graph/pixel_run.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <unordered_map>

namespace frustum::report {
namespace {

constexpr std::size_t table_rows = 100;
constexpr std::size_t most_faces = 24'000;  // of a preview: what a canvas strokes in some 30 ms

// The central sample of each pixel: one value that the run really made, where an average would be none.
Raster central(const Raster& raster) {
  if (raster.frame().samples() == 1) return raster;
  const Raster picked(sink_frame(raster.frame(), raster.frame().window));
  pick_central_samples(raster.view(), picked.view());
  return picked;
}

// The least step such that every step-th pixel of every step-th row, of all planes, are at most `most` values.
int thinning(const Frame& f, std::uint64_t most) {
  const auto values = [&](std::int64_t step) {
    const auto columns = (f.window.width() + step - 1) / step, rows = (f.window.height() + step - 1) / step;
    return static_cast<std::uint64_t>(columns * rows) * f.planes.size();
  };
  int step = 1;
  while (values(step) > most && step < std::max(f.window.width(), f.window.height())) ++step;
  return step;
}

template <class T>
Json thinned_plane(const Raster& r, int plane, int step, Blobs& blobs) {
  const Tile t = r.view();
  std::vector<T> values;
  for (int y = t.rect().y0 + step / 2; y < t.rect().y1; y += step)
    for (int x = step / 2; x < t.rect().width(); x += step) values.push_back(t.row<T>(plane, 0, y)[x]);
  return blobs.add(std::span<const T>(values));
}

Json picture(const Raster& full, Blobs& blobs, std::uint64_t most_values) {
  const Raster r = central(full);
  const Frame& f = r.frame();
  const int step = thinning(f, most_values), half = step / 2;
  Json planes = Json::array();
  for (int p = 0; p < static_cast<int>(f.planes.size()); ++p) {
    const Plane& plane = f.planes[static_cast<std::size_t>(p)];
    Json data = plane.kind == PlaneKind::f32   ? thinned_plane<float>(r, p, step, blobs)
                : plane.kind == PlaneKind::f64 ? thinned_plane<double>(r, p, step, blobs)
                                               : thinned_plane<std::uint32_t>(r, p, step, blobs);
    planes.push_back({{"name", plane.name}, {"data", std::move(data)}});
  }
  return {{"type", "picture"},
          {"window", {f.window.x0, f.window.y0, f.window.x1, f.window.y1}},
          {"step", step},
          {"first", {f.window.x0 + half, f.window.y0 + half}},
          {"width", (f.window.width() - half + step - 1) / step},
          {"height", (f.window.height() - half + step - 1) / step},
          {"samples", full.frame().samples()},
          {"color_space", f.color_space},
          {"alpha", std::array{"none", "straight", "premultiplied"}[static_cast<std::size_t>(f.alpha)]},
          {"planes", std::move(planes)}};
}

// Points that faces or lines name, each once, in order of first use, as x y z with y up.
class Points {
 public:
  Points(const Column& position, bool y_down) : position_(position), y_down_(y_down) {}
  std::uint32_t index(std::uint32_t vertex) {
    const auto [at, fresh] = known_.try_emplace(vertex, static_cast<std::uint32_t>(known_.size()));
    if (fresh) add(vertex);
    return at->second;
  }
  std::span<const float> values() const { return values_; }

 private:
  // A point in clip space lies where the divide puts it.
  void add(std::uint32_t v) {
    const double w = position_.space() == Space::clip ? position_.number(v, 3) : 1;
    const double down = y_down_ ? -1 : 1;
    values_.push_back(static_cast<float>(position_.number(v, 0) / w));
    values_.push_back(static_cast<float>(position_.number(v, 1) / w * down));
    values_.push_back(static_cast<float>(position_.number(v, 2) / w));
  }
  const Column& position_;
  bool y_down_;
  std::unordered_map<std::uint32_t, std::uint32_t> known_;
  std::vector<float> values_;
};

bool seen_by_camera(Space s) { return s == Space::clip || s == Space::ndc || s == Space::screen; }

// Rows of the picture count downwards, and so does y before it, by the conventions of Vulkan.
bool y_is_down(const Mesh& m) {
  if (m.space() == Space::screen) return true;
  return seen_by_camera(m.space()) && clip_space(m.camera.get()).y_down;
}

Json faces(const Mesh& m, Blobs& blobs) {
  if (m.find("position") == nullptr || m.faces() == 0) return {};
  const auto triangles = m.triangles();
  const std::size_t step = (triangles.size() + most_faces - 1) / most_faces;
  Points points(m.at("position"), y_is_down(m));
  std::vector<std::uint32_t> indices;
  for (std::size_t f = 0; f < triangles.size(); f += step)
    for (const std::uint32_t v : {triangles[f].x, triangles[f].y, triangles[f].z})
      indices.push_back(points.index(v));
  return {{"type", "faces"},
          {"space", name_of(m.space())},
          {"flat", seen_by_camera(m.space())},
          {"shown", indices.size() / 3},
          {"total", triangles.size()},
          {"positions", blobs.add(points.values())},
          {"indices", blobs.add(std::span<const std::uint32_t>(indices))}};
}

// The control net: rows and columns of every patch.
Json control_net(const Surface& s, Blobs& blobs) {
  if (s.patches.empty()) return {};
  std::vector<float> positions;
  for (const glm::dvec3& p : s.points)
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(p[k]));
  std::vector<std::uint32_t> ends;
  const std::size_t step = (s.patches.size() * 24 + most_faces - 1) / most_faces;
  for (std::size_t p = 0; p < s.patches.size(); p += step)
    for (std::size_t i = 0; i < 16; ++i) {
      if (i % 4 != 3) ends.insert(ends.end(), {s.patches[p][i], s.patches[p][i + 1]});
      if (i < 12) ends.insert(ends.end(), {s.patches[p][i], s.patches[p][i + 4]});
    }
  return {{"type", "lines"},
          {"space", name_of(s.space)},
          {"flat", false},
          {"shown", ends.size() / 2},
          {"total", s.patches.size() * 24},
          {"positions", blobs.add(std::span<const float>(positions))},
          {"indices", blobs.add(std::span<const std::uint32_t>(ends))}};
}

Json view_of(const Buffer& b, Blobs& blobs, std::uint64_t most_values) {
  if (b.type().is_pixels()) {
    const Raster& r = b.type().raster(b.data());
    return r.frame().window.empty() || r.frame().planes.empty() ? Json() : picture(r, blobs, most_values);
  }
  if (const auto mesh = b.as<Mesh>()) return faces(*mesh, blobs);
  if (const auto surface = b.as<Surface>()) return control_net(*surface, blobs);
  return {};
}

}  // namespace

Json describe_buffer(const Buffer& b, Blobs& blobs, std::uint64_t most_values) {
  const Health h = b.health();
  Json out = {{"kind", b.type().name},
              {"about", b.type().doc},
              {"color", b.type().color},
              {"bytes", b.bytes()},
              {"digest", to_hex(b.digest())},
              {"health",
               {{"values", h.values},
                {"nan", h.nan},
                {"positive_infinity", h.positive_infinity},
                {"negative_infinity", h.negative_infinity},
                {"first", h.first}}},
              {"summary", b.type().summary(b.data())}};
  if (b.type().table != nullptr && !b.type().is_pixels())
    out["table"] = b.type().table(b.data(), 0, table_rows);
  if (Json view = view_of(b, blobs, most_values); !view.is_null()) out["view"] = std::move(view);
  return out;
}

}  // namespace frustum::report
