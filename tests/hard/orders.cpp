// BSP trees and the depth sort: orders in which faces are painted.
#include "tests/hard/exact.h"
#include "tests/hard/stages.h"
#include "tests/hard/visible.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::vec3, glm::vec4;
constexpr int edge = 48;  // px

void shuffle(ScreenTriangles& mesh, stability::Random& random) {
  for (std::size_t i = mesh.face.size(); i-- > 1;) {
    const std::size_t j = random.below(i + 1);
    std::swap(mesh.face[i], mesh.face[j]), std::swap(mesh.origin[i], mesh.origin[j]);
  }
}

Picture by_textbook_tree(const ScreenTriangles& mesh) {
  return painted(textbook_tree(polygons_of(mesh)), edge, edge);
}

void sliver_pieces(Trial& t) {
  for (std::size_t n = t.samples(100, 5000); n-- > 0;) {
    ScreenTriangles mesh;
    for (const std::uint32_t source : {0U, 1U}) add_random_face(mesh, t.random, edge, edge, source);
    // The first lies in z = 0, the second crosses it by 1e-12; the third shows what its pieces' planes do.
    const auto off = static_cast<float>(1e-12 * t.random.uniform(0.1, 1));
    for (std::size_t k = 0; k < 3; ++k) mesh.position[k].z = 0;
    mesh.position[3].z = off, mesh.position[4].z = off, mesh.position[5].z = -off;
    add_random_face(mesh, t.random, edge, edge, 2);
    for (std::size_t k = 6; k < 9; ++k)
      mesh.position[k].z = static_cast<float>(2 * (static_cast<double>(k) - 7)) * off;
    bsp::Tree tree;
    const Picture want = filled(mesh.mesh(), edge, edge);
    const Picture got = by_tree(mesh.mesh(), edge, edge, {bsp::Splitter::first}, &tree);
    t.measure(static_cast<double>(pixels_apart(by_textbook_tree(mesh), want)),
              static_cast<double>(pixels_apart(got, want)), {off, mesh.position[3].x, mesh.position[3].y});
    // A piece has no plane: what divides is the plane of a whole face.
    for (const bsp::Node& node : tree.nodes)
      t.require(node.kind == kernels::Cut::Kind::plane && node.of < mesh.face.size(), "planes of faces only");
    // One face alone, cut by the others: its pieces share out its samples.
    const auto faces = kernels::screen_faces(mesh.mesh(), 1.0F);
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      double area = 0;
      for (const kernels::Piece& p : tree.pieces) {
        if (p.face != f) continue;
        for (std::size_t k = 2; k < p.outline.size(); ++k) {
          const auto a = p.outline[k - 1] - p.outline[0], b = p.outline[k] - p.outline[0];
          area += (a.x * b.y - a.y * b.x) / 2;
        }
      }
      kernels::DepthSpan x, y;
      for (const auto& c : faces[f].corner) x.add(kernels::to_px(c).x), y.add(kernels::to_px(c).y);
      if (x.least < 0 || y.least < 0 || x.greatest > edge || y.greatest > edge) continue;
      const double whole = 0.5 * 0x1p-16 *
                           static_cast<double>(std::llabs(kernels::twice_area(
                               faces[f].corner[0], faces[f].corner[1], faces[f].corner[2])));
      t.require(std::fabs(area - whole) <= 1e-12 * whole, "pieces have the area of their face",
                {area, whole});
    }
  }
}

void coincident_faces(Trial& t) {
  for (std::size_t n = t.samples(20, 500); n-- > 0;) {
    ScreenTriangles mesh;
    add_random_face(mesh, t.random, edge, edge, 0);
    const auto p = mesh.position;
    for (std::uint32_t k = 1; k < 20; ++k)  // ten as they are, ten turned over
      k % 2 == 0 ? mesh.add(p[0], p[1], p[2], k) : mesh.add(p[0], p[2], p[1], k);
    for (std::uint32_t k = 20; k < 24; ++k) add_random_face(mesh, t.random, edge, edge, k);
    const Picture want = filled(mesh.mesh(), edge, edge);
    for (int round = 0; round < 3; ++round) {
      shuffle(mesh, t.random);
      bsp::Tree tree, again;
      const Picture got = by_tree(mesh.mesh(), edge, edge, {bsp::Splitter::first}, &tree);
      by_tree(mesh.mesh(), edge, edge, {bsp::Splitter::first}, &again);
      t.tally(pixels_apart(by_textbook_tree(mesh), want) > 0, !same_bits(got, want),
              {p[0].x, p[0].y, p[0].z});
      t.require(tree.depth <= mesh.face.size(), "no deeper than faces");
      t.require(
          tree.nodes.size() == again.nodes.size() &&
              std::equal(tree.pieces.begin(), tree.pieces.end(), again.pieces.begin(), again.pieces.end(),
                         [](const auto& a, const auto& b) { return a.face == b.face && a.cuts == b.cuts; }),
          "one tree");
    }
  }
}

void tree_and_rays(Trial& t) {
  ScreenTriangles mesh;
  for (std::size_t n = t.samples(60, 1000); n-- > 0;) {
    mesh = {};
    for (std::uint32_t f = 0; f < 8; ++f) add_random_face(mesh, t.random, edge, edge, f);
    const Picture want = filled(mesh.mesh(), edge, edge);
    const auto rays = seen_by_rays(mesh, edge, edge);
    const auto splitter = static_cast<bsp::Splitter>(n % 3);
    const Picture got = by_tree(mesh.mesh(), edge, edge, {splitter});
    t.measure(static_cast<double>(wrong_pixels(by_textbook_tree(mesh), rays)),
              static_cast<double>(wrong_pixels(got, rays)), {mesh.position[0].x, mesh.position[0].y});
    t.require(same_bits(got, want), "the bits of the depth buffer", {mesh.position[0].x, mesh.position[0].y});
  }
  t.price([&] { keep(by_textbook_tree(mesh).id[0]); }, [&] { keep(by_tree(mesh.mesh(), edge, edge).id[0]); });
}

// A face with its plane z = a x + b y + c multiplied out, in float: what the textbook's tests ask.
struct FlatFace {
  std::array<vec3, 3> p;
  std::uint32_t source;
  float a, b, c, least, greatest;

  static FlatFace make(const std::array<vec3, 3>& p, std::uint32_t source) {
    const vec3 e = p[1] - p[0], f = p[2] - p[0];
    const float area = e.x * f.y - e.y * f.x;
    const float a = (e.z * f.y - e.y * f.z) / area, b = (e.x * f.z - e.z * f.x) / area;
    return {p,
            source,
            a,
            b,
            p[0].z - a * p[0].x - b * p[0].y,
            std::min({p[0].z, p[1].z, p[2].z}),
            std::max({p[0].z, p[1].z, p[2].z})};
  }
  // Whether all of `q` is at or behind this plane, or at or before it.
  bool all_behind(const FlatFace& q) const {
    return std::all_of(q.p.begin(), q.p.end(), [&](const vec3& r) { return r.z >= a * r.x + b * r.y + c; });
  }
  bool all_before(const FlatFace& q) const {
    return std::all_of(q.p.begin(), q.p.end(), [&](const vec3& r) { return r.z <= a * r.x + b * r.y + c; });
  }
};

// Whether a line along a side of one divides them.
bool divided(const FlatFace& f, const FlatFace& g) {
  for (std::size_t k = 0; k < 3; ++k) {
    const vec3 &a = f.p[k], &b = f.p[(k + 1) % 3];
    const auto side = [&](const vec3& r) { return (b.x - a.x) * (r.y - a.y) - (b.y - a.y) * (r.x - a.x); };
    const float own = side(f.p[(k + 2) % 3]);
    if (std::all_of(g.p.begin(), g.p.end(), [&](const vec3& r) { return side(r) * own <= 0; })) return true;
  }
  return false;
}

bool may_hide(const FlatFace& p, const FlatFace& q) {
  return !divided(p, q) && !divided(q, p) && !q.all_behind(p) && !p.all_before(q);
}

std::vector<FlatFace> flat_faces(const ScreenTriangles& mesh) {
  std::vector<FlatFace> out;
  for (const Polygon& p : polygons_of(mesh))
    out.push_back(FlatFace::make({p.corner[0], p.corner[1], p.corner[2]}, p.source));
  return out;
}

// The five tests and the exchange, as they are told without marks: whether it ends within `limit` exchanges.
bool exchanges_end(std::vector<FlatFace> list, int limit) {
  std::stable_sort(list.begin(), list.end(),
                   [](const FlatFace& a, const FlatFace& b) { return a.greatest > b.greatest; });
  while (!list.empty()) {
    const auto hidden = std::find_if(list.begin() + 1, list.end(), [&](const FlatFace& q) {
      return q.greatest > list.front().least && may_hide(list.front(), q);
    });
    if (hidden == list.end())
      list.erase(list.begin());
    else if (limit-- == 0)
      return false;
    else
      std::swap(list.front(), *hidden);
  }
  return true;
}

// Thin triangles around a ring, each before the last and behind the next.
ScreenTriangles pinwheel(int blades, double turn) {
  ScreenTriangles mesh;
  const auto at = [&](double k, double across) {
    const double angle = turn + 6.283185307179586 * k / blades;
    return glm::dvec2(24 + (18 + across) * std::cos(angle), 24 + (18 + across) * std::sin(angle));
  };
  for (int k = 0; k < blades; ++k) {
    const glm::dvec2 from = at(k, 0), to = at(k + 1, 0), along = to - from;
    const glm::dvec2 wide = glm::dvec2(-along.y, along.x) * 0.12;
    const glm::dvec2 a = from - along * 0.3 - wide, b = from - along * 0.3 + wide, c = to + along * 0.4;
    const auto corner = [](const glm::dvec2& p, float z) {
      return vec4(std::floor(p.x * 256) / 256, std::floor(p.y * 256) / 256, z, 1);
    };
    mesh.add(corner(a, 0.25F), corner(b, 0.25F), corner(c, 0.75F), static_cast<std::uint32_t>(k));
  }
  return mesh;
}

void circles(Trial& t) {
  for (std::size_t n = t.samples(40, 2000); n-- > 0;) {
    const double turn = t.random.uniform(0, 6);
    for (const int blades : {3, 5}) {
      const ScreenTriangles mesh = pinwheel(blades, turn);
      depth_sort::Counts counts;
      const Picture got = by_depth_sort(mesh.mesh(), edge, edge, &counts),
                    want = filled(mesh.mesh(), edge, edge);
      t.tally(!exchanges_end(flat_faces(mesh), 10000), !same_bits(got, want),
              {turn, static_cast<double>(blades)});
      t.require(counts.splits > 0, "the circle is cut", {turn, static_cast<double>(blades)});
      t.require(wrong_pixels(got, seen_by_rays(mesh, edge, edge)) == 0, "rays see the same", {turn});
    }
  }
}

void broken_keys(Trial& t) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  std::array<std::uint32_t, 6> order{0, 1, 2, 3, 4, 5};
  const std::array<float, 6> depth{0.1F, nan, 0.5F, 0.3F, nan, 0.7F};
  std::vector<std::uint32_t> first;
  do {
    ScreenTriangles mesh;
    std::vector<float> keys;
    for (const std::uint32_t k : order) {
      mesh.add({0, 0, depth[k], 1}, {40, 0, depth[k], 1}, {0, 40, depth[k], 1}, k);
      keys.push_back(depth[k]);
    }
    std::vector<std::uint32_t> sources;
    by_depth_sort(mesh.mesh(), edge, edge, nullptr, &sources);
    if (first.empty()) first = sources;
    // The textbook: insertion by `farther`, which no NaN is.
    for (std::size_t i = 1; i < keys.size(); ++i)
      for (std::size_t j = i; j > 0 && keys[j] > keys[j - 1]; --j) std::swap(keys[j], keys[j - 1]);
    std::erase_if(keys, [](float z) { return std::isnan(z); });
    t.tally(!std::is_sorted(keys.rbegin(), keys.rend()), sources != first,
            {static_cast<double>(order[0]), static_cast<double>(order[1])});
  } while (std::next_permutation(order.begin(), order.end()));
  t.require(first == std::vector<std::uint32_t>{5, 2, 3, 0},
            "farthest first, and what has no depth is not drawn");
}

// Both of a pair's plane tests fail either way round: the textbook cuts.
std::size_t needless_cuts(const std::vector<FlatFace>& faces) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = i + 1; j < faces.size(); ++j) {
      const FlatFace &p = faces[i], &q = faces[j];
      n += !q.all_behind(p) && !p.all_before(q) && !p.all_behind(q) && !q.all_before(p);
    }
  return n;
}

void convex_solids(Trial& t) {
  for (std::size_t n = t.samples(200, 5000); n-- > 0;) {
    // A slanted box whose corners are sums of three sides on the grid, exact in float: its sides are plane.
    // Half of them have corners one ulp off.
    std::array<vec3, 4> v;
    for (std::size_t k = 0; k < 4; ++k)
      for (glm::length_t i = 0; i < 3; ++i)
        v[k][i] =
            static_cast<float>(std::floor(t.random.uniform(-12, 12) * 256) / 256 * (i == 2 ? 0x1p-7 : 1));
    v[3] = vec3(24, 24, 0.5F) - (v[0] + v[1] + v[2]) * 0.5F;
    v[3].x = std::floor(v[3].x * 256) / 256, v[3].y = std::floor(v[3].y * 256) / 256;
    std::array<vec4, 8> corner;
    for (std::size_t k = 0; k < 8; ++k) {
      vec3 p = v[3];
      for (std::size_t i = 0; i < 3; ++i)
        if ((k >> i & 1) != 0) p += v[i];
      if (n % 2 == 0 && t.random.below(2) == 0)
        p.z = std::nextafter(p.z, t.random.below(2) == 0 ? 0.0F : 1.0F);
      corner[k] = vec4(p, 1);
    }
    constexpr std::array<std::array<std::size_t, 4>, 6> side{
        {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
    ScreenTriangles mesh;
    for (std::uint32_t f = 0; f < 6; ++f) {
      const auto& s = side[f];
      mesh.add(corner[s[0]], corner[s[1]], corner[s[2]], 2 * f);
      mesh.add(corner[s[0]], corner[s[2]], corner[s[3]], 2 * f + 1);
    }
    depth_sort::Counts counts;
    const Picture got = by_depth_sort(mesh.mesh(), edge, edge, &counts);
    t.measure(static_cast<double>(needless_cuts(flat_faces(mesh))), static_cast<double>(counts.splits),
              {v[0].x, v[0].y, v[0].z, v[1].x, v[1].y, v[1].z});
    t.require(same_bits(got, filled(mesh.mesh(), edge, edge)), "the bits of the depth buffer",
              {v[0].x, v[0].y, v[0].z});
  }
}

void equal_depths(Trial& t) {
  ScreenTriangles mesh;
  for (std::uint32_t f = 0; f < 1000; ++f) add_random_face(mesh, t.random, edge, edge, f);
  for (vec4& p : mesh.position) p.z = 0.25F;
  const Picture first = by_depth_sort(mesh.mesh(), edge, edge);
  const auto textbook = [](const ScreenTriangles& m) {  // a stable sort leaves the order of the file
    auto polygons = polygons_of(m);
    std::stable_sort(polygons.begin(), polygons.end(),
                     [](const Polygon& a, const Polygon& b) { return a.corner[0].z > b.corner[0].z; });
    return painted(polygons, edge, edge);
  };
  const Picture naive = textbook(mesh);
  for (std::size_t n = t.samples(3, 50); n-- > 0;) {
    shuffle(mesh, t.random);
    t.tally(!same_bits(textbook(mesh), naive), !same_bits(by_depth_sort(mesh.mesh(), edge, edge), first),
            {static_cast<double>(mesh.origin[0])});
  }
  t.price([&] { keep(textbook(mesh).id[0]); }, [&] { keep(by_depth_sort(mesh.mesh(), edge, edge).id[0]); });
}

}  // namespace

std::vector<HardCase> orders() {
  return {
      {"BSP-03", "a face that crosses z = 0 by up to 1e-12, with two others",
       "a piece's plane from its own corners", "bsp::build, PiecePainter",
       "depth buffer; areas in whole numbers",
       "coverage unchanged; planes of faces only; area of pieces within 1e-12", "wrong px", 0, sliver_pieces},
      {"BSP-04", "one face 20 times, half of them turned over, and four others, shuffled",
       "on the plane: n p + d == 0 in float", "bsp::build, PiecePainter", "depth buffer",
       "no deeper than faces; one tree; one picture", "pictures that differ", 0, coincident_faces},
      {"BSP-06", "random scenes of 8 faces that pierce one another, three ways to divide",
       "tree of polygons with new corners, float", "bsp::build, PiecePainter",
       "rays in 128 bits; depth buffer", "ids equal but for gaps below 2^-14; the bits of the depth buffer",
       "wrong px", 0, tree_and_rays},
      {"DST-01", "pinwheels of 3 and 5 triangles, turned at random", "exchange without marks",
       "depth_sort::Sorter, PiecePainter", "depth buffer; rays in 128 bits",
       "ends; ids equal; cut once or more", "wrong runs", 0, circles},
      {"DST-02", "four depths and two NaN, in all 720 orders", "sorted by > on depths", "depth_sort::Sorter",
       "the sorted list", "one list for every order", "wrong lists", 0, broken_keys},
      {"DST-03", "slanted boxes of 12 triangles, exact or an ulp off",
       "signs of planes multiplied out, float", "depth_sort::Sorter, PiecePainter",
       "a convex solid has an order", "no splits; the bits of the depth buffer", "splits", 0, convex_solids},
      {"DST-05", "1000 faces of equal depth, shuffled", "sorted by depth alone",
       "depth_sort::Sorter, PiecePainter", "comparison of bits", "one picture", "pictures that differ", 0,
       equal_depths},
  };
}

}  // namespace frustum::hard
