#include "tests/hard/visible.h"

#include "nodes/kernels/scan_lines.h"
#include "nodes/visibility/paint.h"
#include "runtime/app/stability/trial.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace frustum::hard {
namespace {

__extension__ using Wide = __int128;

Picture blank(int width, int height) {
  const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  return {width, height, std::vector<std::uint32_t>(size, kernels::no_face), std::vector<float>(size, 1)};
}

void name_sources(Picture& picture, const kernels::ScreenMesh<float>& mesh) {
  if (mesh.origin.empty()) return;
  for (auto& id : picture.id)
    if (id != kernels::no_face) id = mesh.origin[id];
}

// Pieces as visibility.paint is handed them.
struct Pieces {
  std::vector<kernels::OrderedPiece> pieces;
  std::vector<kernels::Cut> cuts;
  void add(const kernels::Piece& p) {
    pieces.push_back(
        {p.face, static_cast<std::uint32_t>(cuts.size()), static_cast<std::uint32_t>(p.cuts.size())});
    cuts.insert(cuts.end(), p.cuts.begin(), p.cuts.end());
  }
};

Picture paint(const kernels::ScreenMesh<float>& mesh, const Pieces& order, int width, int height) {
  Picture out = blank(width, height);
  const kernels::PixelRect window{0, 0, width, height};
  const PiecePainter<float> painter(mesh, kernels::centre_sample(), window, kernels::DepthOrder::standard,
                                    {order.pieces, order.cuts, false}, order.pieces.size(), {});
  painter.fill(window, {out.id.data(), width, 0}, {out.z.data(), width, 0});
  name_sources(out, mesh);
  return out;
}

// Whether a ray meets a face, and how far away: depth = over / under in units of 2^-20, under > 0.
struct Meeting {
  int inside = -1;  // -1 outside, 0 on a side, 1 inside
  Wide over = 0, under = 1;
};

Meeting meet(const std::array<glm::vec4, 3>& p, std::int64_t x, std::int64_t y) {
  std::array<std::int64_t, 3> px, py, pz;
  for (std::size_t k = 0; k < 3; ++k) {
    px[k] = static_cast<std::int64_t>(p[k].x * 256);
    py[k] = static_cast<std::int64_t>(p[k].y * 256);
    pz[k] = static_cast<std::int64_t>(p[k].z * 0x1p20F);
  }
  const auto turn = [&](std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by, std::int64_t cx,
                        std::int64_t cy) { return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax); };
  const std::int64_t whole = turn(px[0], py[0], px[1], py[1], px[2], py[2]), sign = whole > 0 ? 1 : -1;
  Meeting m{1, 0, Wide{whole} * sign};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const std::int64_t part = sign * turn(x, y, px[i], py[i], px[j], py[j]);
    m.inside = part < 0 ? -1 : std::min(m.inside, part == 0 ? 0 : 1);
    if (part < 0) break;
    m.over += Wide{part} * pz[k];
  }
  return m;
}

// a - b in units of 2^-20 depth, less than `limit`.
bool nearer_by(const Meeting& a, const Meeting& b, std::int64_t limit) {
  return a.over * b.under - b.over * a.under < Wide{limit} * a.under * b.under;
}

}  // namespace

Picture by_scanline(const kernels::ScreenMesh<float>& mesh, int width, int height) {
  Picture out = blank(width, height);
  const kernels::PixelRect window{0, 0, width, height};
  const scanline::Scanner<float> scanner(mesh, kernels::centre_sample(), window,
                                         kernels::DepthOrder::standard, {});
  scanner.fill(window, {out.id.data(), width, 0}, {out.z.data(), width, 0});
  name_sources(out, mesh);
  return out;
}

Picture by_tree(const kernels::ScreenMesh<float>& mesh, int width, int height, const bsp::Options& options,
                bsp::Tree* tree) {
  const auto faces = kernels::screen_faces(mesh, 1.0F);
  bsp::Tree built = bsp::build(faces, {0, 0, width, height}, options);
  Pieces order;
  bsp::traverse(built, faces, {0, 0, -1, 0}, false, [&](const bsp::Node& n) {
    for (std::uint32_t k = 0; k < n.pieces; ++k) order.add(built.pieces[n.first_piece + k]);
  });
  if (tree != nullptr) *tree = std::move(built);
  return paint(mesh, order, width, height);
}

Picture by_depth_sort(const kernels::ScreenMesh<float>& mesh, int width, int height,
                      depth_sort::Counts* counts, std::vector<std::uint32_t>* sources) {
  const auto faces = kernels::screen_faces(mesh, 1.0F);
  const depth_sort::Watch watch;
  depth_sort::Sorter sorter(faces, {0, 0, width, height}, watch);
  Pieces order;
  const auto found = sorter.run([&](const kernels::Piece& p) {
    order.add(p);
    if (sources != nullptr) sources->push_back(mesh.origin[p.face]);
  });
  if (counts != nullptr) *counts = found;
  return paint(mesh, order, width, height);
}

std::size_t pixels_apart(const Picture& a, const Picture& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.id.size(); ++i) n += a.id[i] != b.id[i];
  return n;
}

bool same_bits(const Picture& a, const Picture& b) {
  return a.id == b.id && std::equal(a.z.begin(), a.z.end(), b.z.begin(), [](float x, float y) {
           return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
         });
}

void add_random_face(ScreenTriangles& mesh, stability::Random& random, int width, int height,
                     std::uint32_t source) {
  for (;;) {
    std::array<glm::vec4, 3> p;
    const double cx = random.uniform(0, width), cy = random.uniform(0, height);
    for (auto& q : p)
      q = {static_cast<float>(std::floor((cx + random.uniform(-24, 24)) * 256) / 256),
           static_cast<float>(std::floor((cy + random.uniform(-24, 24)) * 256) / 256),
           static_cast<float>(std::floor(random.uniform(0, 0x1p20)) * 0x1p-20), 1};
    const auto side = [&](std::size_t i, std::size_t j) {
      return std::hypot(p[i].x - p[j].x, p[i].y - p[j].y);
    };
    const float twice_area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    const float longest = std::max({side(0, 1), side(1, 2), side(2, 0)});
    if (longest > 64 || std::fabs(twice_area) < longest) continue;
    return mesh.add(p[0], p[1], p[2], source);
  }
}

std::vector<std::uint32_t> seen_by_rays(const ScreenTriangles& mesh, int width, int height) {
  constexpr std::int64_t gap = 1 << 6;  // 2^-14
  std::vector<std::uint32_t> out;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::vector<std::pair<Meeting, std::uint32_t>> met;
      for (std::size_t f = 0; f < mesh.face.size(); ++f) {
        const glm::uvec3& c = mesh.face[f];
        const Meeting m = meet({mesh.position[c.x], mesh.position[c.y], mesh.position[c.z]},
                               256 * std::int64_t{x} + 128, 256 * std::int64_t{y} + 128);
        if (m.inside >= 0) met.emplace_back(m, mesh.origin[f]);
      }
      const auto nearest = std::min_element(met.begin(), met.end(), [](const auto& a, const auto& b) {
        return nearer_by(a.first, b.first, 0);
      });
      std::uint32_t id = nearest == met.end() ? kernels::no_face : nearest->second;
      for (const auto& [m, source] : met)
        if (nearer_by(m, nearest->first, gap) && (m.inside == 0 || source != nearest->second)) id = unsure;
      out.push_back(id);
    }
  return out;
}

std::size_t wrong_pixels(const Picture& picture, const std::vector<std::uint32_t>& rays) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) n += rays[i] != unsure && picture.id[i] != rays[i];
  return n;
}

std::vector<Polygon> polygons_of(const ScreenTriangles& mesh) {
  std::vector<Polygon> out;
  for (std::size_t f = 0; f < mesh.face.size(); ++f) {
    Polygon p{{}, mesh.origin[f]};
    for (glm::length_t k = 0; k < 3; ++k) p.corner.emplace_back(mesh.position[mesh.face[f][k]]);
    out.push_back(std::move(p));
  }
  return out;
}

std::vector<Polygon> textbook_tree(std::vector<Polygon> polygons) {
  if (polygons.empty()) return {};
  const std::vector<glm::vec3>& c = polygons.front().corner;
  const glm::vec3 ab = c[1] - c[0], ac = c[2] - c[0];
  const glm::vec3 n(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
  const float d = -(n.x * c[0].x + n.y * c[0].y + n.z * c[0].z);
  const auto side = [&](const glm::vec3& p) { return n.x * p.x + n.y * p.y + n.z * p.z + d; };
  std::vector<Polygon> front, back, on{polygons.front()};
  for (std::size_t i = 1; i < polygons.size(); ++i) {
    Polygon before{{}, polygons[i].source}, behind = before;
    const auto& corner = polygons[i].corner;
    bool above = false, below = false;
    for (std::size_t k = 0; k < corner.size(); ++k) {
      const glm::vec3 &p = corner[k], &q = corner[(k + 1) % corner.size()];
      const float a = side(p), b = side(q);
      above = above || a > 0, below = below || a < 0;
      if (a >= 0) before.corner.push_back(p);
      if (a <= 0) behind.corner.push_back(p);
      if (a * b >= 0) continue;
      const glm::vec3 cut = p + (q - p) * (a / (a - b));
      before.corner.push_back(cut), behind.corner.push_back(cut);
    }
    if (!above && !below) on.push_back(polygons[i]);
    if (above && before.corner.size() > 2) front.push_back(std::move(before));
    if (below && behind.corner.size() > 2) back.push_back(std::move(behind));
  }
  if (n.z > 0) std::swap(front, back);  // the camera is on the side of -z
  std::vector<Polygon> order = textbook_tree(std::move(back));
  order.insert(order.end(), on.begin(), on.end());
  const auto nearest = textbook_tree(std::move(front));
  order.insert(order.end(), nearest.begin(), nearest.end());
  return order;
}

Picture painted(const std::vector<Polygon>& polygons, int width, int height) {
  Picture out = blank(width, height);
  for (const Polygon& p : polygons) {
    ScreenTriangles fan;
    const auto at = [&](std::size_t k) { return glm::vec4(p.corner[k], 1); };
    for (std::size_t k = 2; k < p.corner.size(); ++k) fan.add(at(0), at(k - 1), at(k), p.source);
    const Picture one = filled(fan.mesh(), width, height);
    for (std::size_t i = 0; i < one.id.size(); ++i)
      if (one.id[i] != kernels::no_face) out.id[i] = one.id[i], out.z[i] = one.z[i];
  }
  return out;
}

}  // namespace frustum::hard
