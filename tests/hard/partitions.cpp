// Trees that many planes divide, eyes other than the camera's, and faces that cross almost nowhere.
#include "nodes/kernels/depth_sort.h"
#include "nodes/kernels/space_partition.h"
#include "nodes/visibility/paint.h"
#include "tests/hard/exact_rays.h"
#include "tests/hard/stages.h"
#include "tests/hard/visible.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec3;

// The pieces of each face with their places in an order, the last painted last.
class PaintedOrder {
 public:
  PaintedOrder(const bsp::Tree& tree, std::span<const kernels::ScreenFace> faces)
      : tree_(tree), faces_(faces), of_(faces.size()) {}

  void add(const bsp::Node& n) {
    for (std::uint32_t k = 0; k < n.pieces; ++k) {
      const kernels::Piece& p = tree_.pieces[n.first_piece + k];
      of_[p.face].emplace_back(&p, next_++);
    }
  }
  // Which face is seen of those a ray meets: the one whose piece is painted last.
  std::uint32_t seen(const std::vector<Hit>& hits) const {
    std::size_t last = 0;
    std::uint32_t face = kernels::no_face;
    for (const Hit& h : hits) {
      std::size_t pieces = 0;
      for (const auto& [piece, when] : of_[h.face]) {
        const auto holds = [&](const kernels::Cut& c) {
          return kernels::on_side(c, faces_[h.face].depth, faces_, h.at);
        };
        if (!std::all_of(piece->cuts.begin(), piece->cuts.end(), holds)) continue;
        ++pieces;
        if (face == kernels::no_face || when > last) last = when, face = h.face;
      }
      if (pieces != 1) return kernels::no_face;  // a gap or an overlap: wrong whatever is seen
    }
    return face;
  }

 private:
  const bsp::Tree& tree_;
  std::span<const kernels::ScreenFace> faces_;
  std::vector<std::vector<std::pair<const kernels::Piece*, std::size_t>>> of_;
  std::size_t next_ = 0;
};

std::vector<ExactFace> exact_faces(const DoubleTriangles& mesh) {
  std::vector<ExactFace> out;
  for (const glm::uvec3& f : mesh.face)
    out.emplace_back(
        std::array{dvec3(mesh.position[f.x]), dvec3(mesh.position[f.y]), dvec3(mesh.position[f.z])});
  return out;
}

// ----- BSP-02

// A ball of 20 * 4^level triangles around (256, 256) px, 200 px and 0.4 of the depth in radius.
std::vector<std::array<vec3, 3>> ball(int level) {
  constexpr std::array<std::array<int, 3>, 20> face{
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  const double g = (1 + std::sqrt(5.0)) / 2;
  const std::array<dvec3, 12> corner{dvec3{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                     {0, -1, g},      {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                     {g, 0, -1},      {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<dvec3, 3>> fine;
  for (const auto& f : face)
    fine.push_back({corner[static_cast<std::size_t>(f[0])], corner[static_cast<std::size_t>(f[1])],
                    corner[static_cast<std::size_t>(f[2])]});
  for (; level > 0; --level) {
    std::vector<std::array<dvec3, 3>> finer;
    for (const auto& [a, b, c] : fine) {
      const dvec3 ab = a + b, bc = b + c, ca = c + a;
      finer.insert(finer.end(), {{a * 2.0, ab, ca}, {ab, b * 2.0, bc}, {ca, bc, c * 2.0}, {ab, bc, ca}});
    }
    fine = std::move(finer);
  }
  std::vector<std::array<vec3, 3>> out;
  for (const auto& t : fine) {
    auto& placed = out.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const dvec3 n = t[k] / std::sqrt(t[k].x * t[k].x + t[k].y * t[k].y + t[k].z * t[k].z);
      placed[k] = vec3(on_grid(256 + 200 * n.x), on_grid(256 + 200 * n.y),
                       std::floor((0.5 + 0.4 * n.z) * 0x1p20) * 0x1p-20);
    }
  }
  return out;
}

// A triangle through the ball, in whose plane it is cut.
std::array<vec3, 3> cutter(stability::Random& random) {
  for (;;) {
    std::array<vec3, 3> p;
    for (vec3& q : p)
      q = vec3(on_grid(random.uniform(100, 412)), on_grid(random.uniform(100, 412)),
               std::floor(random.uniform(0.2, 0.8) * 0x1p20) * 0x1p-20);
    const vec3 a = p[1] - p[0], b = p[2] - p[0];
    if (std::fabs(a.x * b.y - a.y * b.x) > 2000) return p;
  }
}

double area_of(const std::vector<vec3>& outline) {
  double twice = 0;
  for (std::size_t k = 2; k < outline.size(); ++k) {
    const dvec3 a(outline[k - 1] - outline[0]), b(outline[k] - outline[0]);
    twice += a.x * b.y - a.y * b.x;
  }
  return std::fabs(twice) / 2;
}

// The textbook: the corners of a piece are those that cuts made, in float.
std::vector<std::vector<vec3>> textbook_pieces(const std::array<vec3, 3>& face,
                                               const std::vector<std::array<vec3, 3>>& cutters) {
  std::vector<std::vector<vec3>> pieces{{face[0], face[1], face[2]}};
  for (const auto& c : cutters) {
    const vec3 ab = c[1] - c[0], ac = c[2] - c[0];
    const vec3 n(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
    const float d = -(n.x * c[0].x + n.y * c[0].y + n.z * c[0].z);
    const auto side = [&](const vec3& p) { return n.x * p.x + n.y * p.y + n.z * p.z + d; };
    std::vector<std::vector<vec3>> next;
    for (const auto& piece : pieces) {
      std::array<std::vector<vec3>, 2> half;
      for (std::size_t k = 0; k < piece.size(); ++k) {
        const vec3 &p = piece[k], &q = piece[(k + 1) % piece.size()];
        const float a = side(p), b = side(q);
        if (a >= 0) half[0].push_back(p);
        if (a <= 0) half[1].push_back(p);
        if (a * b < 0)
          for (auto& h : half) h.push_back(p + (q - p) * (a / (a - b)));
      }
      for (auto& h : half)
        if (h.size() > 2) next.push_back(std::move(h));
    }
    pieces = std::move(next);
  }
  return pieces;
}

// The planes of faces first..end cut face f: pieces as visibility.bsp makes them.
std::vector<kernels::Piece> pieces_of(std::uint32_t f, std::uint32_t first,
                                      std::span<const kernels::ScreenFace> faces) {
  std::vector<kernels::Piece> pieces{kernels::whole_piece(f, faces[f], {0, 0, 512, 512})};
  const kernels::FaceDepth& own = faces[f].depth;
  for (std::uint32_t c = first; c < faces.size(); ++c) {
    const kernels::FaceDepth& plane = faces[c].depth;
    std::vector<kernels::Piece> next;
    for (kernels::Piece& p : pieces) {
      if (kernels::side_of(p, own, c, plane, own.level + plane.slope_error()) != kernels::Side::across) {
        next.push_back(std::move(p));
        continue;
      }
      auto halves = kernels::split(p, kernels::Cut::Kind::plane, c, faces);
      next.push_back(std::move(halves.low)), next.push_back(std::move(halves.high));
    }
    pieces = std::move(next);
  }
  return pieces;
}

// Whether each of a face's samples, in the middle of a pixel, lies in one piece.
bool shared_out(const std::vector<kernels::Piece>& pieces, std::span<const kernels::ScreenFace> faces,
                const dvec2& low, const dvec2& high) {
  for (double y = std::floor(low.y) + 0.5; y < high.y; ++y)
    for (double x = std::floor(low.x) + 0.5; x < high.x; ++x) {
      const auto of_piece = [&](const kernels::Piece& p) {
        return std::all_of(p.cuts.begin(), p.cuts.end(), [&](const kernels::Cut& c) {
          return kernels::on_side(c, faces[p.face].depth, faces, {x, y});
        });
      };
      if (std::count_if(pieces.begin(), pieces.end(), of_piece) != 1) return false;
    }
  return true;
}

// A ball whose tree begins with some cutters: seen from eyes all around and inside, its order is right.
void require_valid_order(Trial& t) {
  DoubleTriangles mesh;
  for (int k = 0; k < 12; ++k) {
    const auto c = cutter(t.random);
    mesh.add(dvec3(c[0]), dvec3(c[1]), dvec3(c[2]));
  }
  for (const auto& f : ball(1)) mesh.add(dvec3(f[0]), dvec3(f[1]), dvec3(f[2]));
  const auto faces = kernels::screen_faces(mesh.mesh(), 1.0);
  const auto exact = exact_faces(mesh);
  const bsp::Tree tree = bsp::build(faces, {0, 0, 512, 512}, {bsp::Splitter::first});
  t.require(tree.splits > 100, "the cutters cut");
  const auto anywhere = [&](double reach, double deep) {
    return dvec3(t.random.uniform(256 - reach, 256 + reach), t.random.uniform(256 - reach, 256 + reach),
                 t.random.uniform(0.5 - deep, 0.5 + deep));
  };
  for (std::size_t n = t.samples(6, 100); n-- > 0;) {
    const dvec3 eye = n % 2 == 0 ? anywhere(150, 0.3) : anywhere(2000, 4);
    PaintedOrder order(tree, faces);
    bsp::traverse(tree, faces, dvec4(eye, 1), false, [&](const bsp::Node& node) { order.add(node); });
    for (int k = 0; k < 20; ++k) {
      const auto hits = hits_of(exact, eye, anywhere(150, 0.3) - eye);
      if (!hits || hits->empty()) continue;
      t.require(order.seen(*hits) == hits->front().face, "the order is right for every eye",
                {eye.x, eye.y, eye.z, static_cast<double>(hits->front().face)});
    }
  }
}

void thousands_of_splits(Trial& t) {
  const auto sphere = ball(t.full() ? 4 : 1);
  std::vector<std::array<vec3, 3>> cutters;
  for (std::size_t n = t.samples(60, 400); n-- > 0;) cutters.push_back(cutter(t.random));
  ScreenTriangles mesh;
  const auto add = [&](const std::array<vec3, 3>& p) {
    mesh.add({p[0], 1}, {p[1], 1}, {p[2], 1}, static_cast<std::uint32_t>(mesh.face.size()));
  };
  for (const auto& f : sphere) add(f);
  for (const auto& c : cutters) add(c);
  const auto faces = kernels::screen_faces(mesh.mesh(), 1.0F);
  double whole = 0, textbook = 0, ours = 0;
  std::size_t splits = 0;
  for (std::uint32_t f = 0; f < sphere.size(); ++f) {
    if (!faces[f].drawn) continue;
    const auto& c = faces[f].corner;
    whole += 0.5 * 0x1p-16 * static_cast<double>(std::llabs(kernels::twice_area(c[0], c[1], c[2])));
    for (const auto& piece : textbook_pieces(sphere[f], cutters)) textbook += area_of(piece);
    const auto pieces = pieces_of(f, static_cast<std::uint32_t>(sphere.size()), faces);
    splits += pieces.size() - 1;
    for (const kernels::Piece& p : pieces) {
      double twice = 0;
      for (std::size_t k = 2; k < p.outline.size(); ++k) {
        const dvec2 a = p.outline[k - 1] - p.outline[0], b = p.outline[k] - p.outline[0];
        twice += a.x * b.y - a.y * b.x;
      }
      ours += std::fabs(twice) / 2;
    }
    const auto [left, right] = std::minmax({sphere[f][0].x, sphere[f][1].x, sphere[f][2].x});
    const auto [top, bottom] = std::minmax({sphere[f][0].y, sphere[f][1].y, sphere[f][2].y});
    if (!t.full() || f % 64 == 0)
      t.require(
          shared_out(pieces, faces, {left, top}, {std::min(right, left + 8), std::min(bottom, top + 8)}),
          "every sample in one piece", {static_cast<double>(f)});
  }
  t.measure(std::fabs(textbook - whole) / whole, std::fabs(ours - whole) / whole,
            {static_cast<double>(splits), whole});
  t.require(splits > 1000, "thousands of splits", {static_cast<double>(splits)});
  require_valid_order(t);
}

// ----- BSP-05

constexpr double far_away = 1e7;  // the depth around which the scene stands; an ulp of it in float is 1

DoubleTriangles distant_scene(stability::Random& random, int count) {
  DoubleTriangles mesh;
  while (count > 0) {
    std::array<dvec3, 3> p;
    for (dvec3& q : p)
      q = {on_grid(random.uniform(0, 48)), on_grid(random.uniform(0, 48)),
           far_away + std::floor(random.uniform(-24, 24))};
    const dvec3 a = p[1] - p[0], b = p[2] - p[0];
    if (std::fabs(a.x * b.y - a.y * b.x) < 200) continue;
    mesh.add(p[0], p[1], p[2]), --count;
  }
  return mesh;
}

// Before the plane (negative) or behind it, by n p + d in float.
float textbook_eye_side(const DoubleTriangles& mesh, std::uint32_t face, const dvec3& eye) {
  const auto at = [&](glm::length_t k) { return vec3(mesh.position[mesh.face[face][k]]); };
  const vec3 p = at(0), ab = at(1) - p, ac = at(2) - p, e(eye);
  const vec3 n(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x);
  const float d = -(n.x * p.x + n.y * p.y + n.z * p.z);
  return (n.x * e.x + n.y * e.y + n.z * e.z + d) * (n.z > 0 ? 1.0F : -1.0F);
}

// bsp::traverse, back to front, with another answer to where the eye stands.
template <class Side>
void walk(const bsp::Tree& tree, std::uint32_t node, const Side& eye_side, PaintedOrder& order) {
  if (node == bsp::no_node) return;
  const bsp::Node& n = tree.nodes[node];
  const bool low_last = eye_side(n) <= 0;
  walk(tree, low_last ? n.high : n.low, eye_side, order);
  order.add(n);
  walk(tree, low_last ? n.low : n.high, eye_side, order);
}

void eye_on_a_plane(Trial& t) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const DoubleTriangles mesh = distant_scene(t.random, 16);
  const auto faces = kernels::screen_faces(mesh.mesh(), 1.0);
  const auto exact = exact_faces(mesh);
  const bsp::Tree tree = bsp::build(faces, {0, 0, 48, 48}, {bsp::Splitter::first});
  const auto by_float = [&](const dvec3& eye, PaintedOrder& order) {
    walk(
        tree, 0, [&](const bsp::Node& n) { return textbook_eye_side(mesh, n.of, eye); }, order);
  };
  const auto by_tree = [&](const dvec3& eye, PaintedOrder& order) {
    bsp::traverse(tree, faces, dvec4(eye, 1), false, [&](const bsp::Node& n) { order.add(n); });
  };
  for (std::size_t n = t.samples(32, 300); n-- > 0;) {
    const glm::uvec3& f = mesh.face[n % mesh.face.size()];
    const dvec3 p(mesh.position[f.x]), q(mesh.position[f.y]), r(mesh.position[f.z]);
    // Quarters of sides on the grid are exact: the eye is in the plane.
    const double u = 0.25 * static_cast<double>(t.random.below(7)) - 0.25,
                 v = 0.25 * static_cast<double>(t.random.below(7)) - 0.25;
    const dvec3 on = p + (q - p) * u + (r - p) * v;
    for (const double z : {on.z, std::nextafter(on.z, inf), std::nextafter(on.z, -inf), on.z + 1, on.z - 1}) {
      const dvec3 eye(on.x, on.y, z);
      PaintedOrder naive(tree, faces), ours(tree, faces);
      by_float(eye, naive), by_tree(eye, ours);
      for (int k = 0; k < 30; ++k) {
        const double depth = t.random.uniform(-24, 24), y = t.random.uniform(0, 48);
        const dvec3 to(t.random.uniform(0, 48), y, far_away + depth);
        const auto hits = hits_of(exact, eye, to - eye);
        if (!hits || hits->empty()) continue;
        t.tally(naive.seen(*hits) != hits->front().face, ours.seen(*hits) != hits->front().face,
                {eye.x, eye.y, eye.z, to.x, to.y, to.z});
      }
    }
  }
  const dvec3 eye(24, 24, far_away);
  t.price(
      [&] {
        PaintedOrder order(tree, faces);
        by_float(eye, order);
        keep(order);
      },
      [&] {
        PaintedOrder order(tree, faces);
        by_tree(eye, order);
        keep(order);
      });
}

// ----- DST-04

struct Quads {
  std::array<std::array<dvec3, 4>, 2> corner;
};

// Two steep quads over most of the picture that cross at up to 1e-6 rad.
Quads crossing_quads(stability::Random& random) {
  const double a = random.uniform(4, 10), b = random.uniform(4, 10), turn = random.uniform(0, 6.28);
  const double apart = 1e-6 * std::sqrt(1 + a * a + b * b);  // no angle between the normals is larger
  const double middle = random.uniform(-8, 8);
  Quads out;
  for (std::size_t k = 0; k < 2; ++k) {
    constexpr std::array<std::array<double, 2>, 4> rim{{{2, 2}, {46, 3}, {45, 46}, {3, 45}}};
    for (std::size_t i = 0; i < 4; ++i) {
      const double x = on_grid(rim[i][0]), y = on_grid(rim[i][1]);
      const double along = (x - 24) * std::cos(turn) + (y - 24) * std::sin(turn) - middle;
      out.corner[k][i] = {x, y, 100 + a * x + b * y + (k == 0 ? 0.5 : -0.5) * apart * along};
    }
  }
  return out;
}

// Which quad is nearer, 0 or 1, at each pixel's middle, from the planes of their first three corners; `unsure`
// within 1 px of the line, no_face outside of them.
std::vector<std::uint32_t> nearer_quads(const Quads& quads, int edge) {
  std::array<std::array<Rational, 3>, 2> plane;  // z = [0] + [1] x + [2] y
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& c = quads.corner[k];
    const ExactFace f({c[0], c[1], c[2]});
    plane[k][1] = -f.normal[0] / f.normal[2], plane[k][2] = -f.normal[1] / f.normal[2];
    plane[k][0] = f.p[0][2] - plane[k][1] * f.p[0][0] - plane[k][2] * f.p[0][1];
  }
  std::array<double, 3> d;  // the difference: rounded once, which moves the line by 2^-50 of its distance
  for (std::size_t i = 0; i < 3; ++i) d[i] = Rational(plane[0][i] - plane[1][i]).get_d();
  std::vector<std::uint32_t> out;
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      const double off = (d[0] + d[1] * (x + 0.5) + d[2] * (y + 0.5)) / std::hypot(d[1], d[2]);
      const bool inside = x >= 3 && x < 45 && y >= 3 && y < 45;  // of the rims, by a pixel or more
      out.push_back(!inside || std::fabs(off) <= 1 ? unsure : off < 0 ? 0U : 1U);
    }
  return out;
}

std::size_t wrong_quads(const std::vector<std::uint32_t>& quad, const std::vector<std::uint32_t>& nearer) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < nearer.size(); ++i) n += nearer[i] != unsure && quad[i] != nearer[i];
  return n;
}

// What visibility.depth_sort and visibility.paint do in double: quad and depth of each pixel.
struct DoublePicture {
  std::vector<std::uint32_t> quad;
  std::vector<double> z;
};

DoublePicture blank(int edge) {
  const auto size = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
  return {std::vector<std::uint32_t>(size), std::vector<double>(size)};
}

void name_quads(DoublePicture& picture) {
  for (auto& id : picture.quad)
    if (id != kernels::no_face) id /= 2;
}

DoublePicture sorted_quads(const DoubleTriangles& mesh, int edge) {
  const kernels::PixelRect window{0, 0, edge, edge};
  const auto faces = kernels::screen_faces(mesh.mesh(), 1.0);
  const depth_sort::Watch watch;
  std::vector<kernels::OrderedPiece> order;
  std::vector<kernels::Cut> cuts;
  depth_sort::Sorter(faces, window, watch).run([&](const kernels::Piece& p) {
    order.push_back(
        {p.face, static_cast<std::uint32_t>(cuts.size()), static_cast<std::uint32_t>(p.cuts.size())});
    cuts.insert(cuts.end(), p.cuts.begin(), p.cuts.end());
  });
  const PiecePainter<double> painter(mesh.mesh(), kernels::centre_sample(), window,
                                     kernels::DepthOrder::standard, {order, cuts, false}, order.size(), {});
  DoublePicture out = blank(edge);
  painter.fill(window, {out.quad.data(), edge, 0}, {out.z.data(), edge, 0});
  name_quads(out);
  return out;
}

DoublePicture filled_quads(const DoubleTriangles& mesh, int edge) {
  const kernels::PixelRect window{0, 0, edge, edge};
  const kernels::SamplePositions pattern = kernels::centre_sample();
  const auto bins = kernels::bin_triangles(mesh.mesh(), pattern, window);
  DoublePicture out = blank(edge);
  kernels::fill_triangles<double>({mesh.mesh(), pattern, &bins}, window, {out.quad.data(), edge, 0},
                                  {out.z.data(), edge, 0});
  name_quads(out);
  return out;
}

std::vector<std::uint32_t> textbook_quads(const Quads& quads, int edge) {
  std::vector<Polygon> polygons;
  for (std::uint32_t k = 0; k < 2; ++k) {
    Polygon p{{}, k};
    for (const dvec3& c : quads.corner[k]) p.corner.emplace_back(c);
    polygons.push_back(std::move(p));
  }
  return painted(textbook_tree(std::move(polygons)), edge, edge).id;
}

void small_angles(Trial& t) {
  constexpr int edge = 48;
  for (std::size_t n = t.samples(40, 1000); n-- > 0;) {
    const Quads quads = crossing_quads(t.random);
    DoubleTriangles mesh;
    for (const auto& c : quads.corner) mesh.add(c[0], c[1], c[2]), mesh.add(c[0], c[2], c[3]);
    const auto nearer = nearer_quads(quads, edge);
    const DoublePicture got = sorted_quads(mesh, edge), want = filled_quads(mesh, edge);
    t.measure(static_cast<double>(wrong_quads(textbook_quads(quads, edge), nearer)),
              static_cast<double>(wrong_quads(got.quad, nearer)),
              {quads.corner[0][0].z, quads.corner[0][1].z, quads.corner[0][2].z});
    t.require(got.quad == want.quad && got.z == want.z, "the bits of the depth buffer",
              {quads.corner[0][0].z, quads.corner[0][1].z, quads.corner[0][2].z});
  }
}

}  // namespace

std::vector<HardCase> partitions() {
  return {
      {"BSP-02", "a ball cut by 60 planes (--full: 5120 faces, 400 planes)",
       "pieces with the corners that cuts made, float", "kernels::split, bsp::build, bsp::traverse",
       "areas in whole numbers; rays in rationals",
       "areas of pieces add up to 1e-12; every sample in one piece; the order right for every eye",
       "relative error of the area", 1e-12, thousands_of_splits},
      {"BSP-05", "an eye in the plane of a face at depth 1e7, and an ulp of double and of float beside it",
       "the sign of n p + d in float", "bsp::traverse, double", "rays in rationals",
       "what rays from the eye see", "wrong rays", 0, eye_on_a_plane},
      {"DST-04", "two steep quads that cross at up to 1e-6 rad", "cut by the plane of the other, float",
       "depth_sort::Sorter, PiecePainter, double", "the planes in rationals; depth buffer",
       "ids equal but for 1 px beside the line; the bits of the depth buffer", "wrong px", 0, small_angles},
  };
}

}  // namespace frustum::hard
