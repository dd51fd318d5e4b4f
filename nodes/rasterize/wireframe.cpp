#include "nodes/rasterize/wireframe.h"

#include "nodes/kernels/join_points.h"
#include "nodes/kernels/mesh_edges.h"
#include "nodes/kernels/predicates.h"
#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <numbers>

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Tiled<Visibility>> hits;
  std::optional<Ref<Mesh>> seen;
  std::optional<Tiled<Image>> under;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  double width = 1;
  Color color{glm::dvec3{0}};
  double hidden = 0;
  std::optional<double> crease;
  std::optional<Color> paper;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  Precision precision;
  Params look;
  kernels::DepthRange depth;
  wireframe::LineBins bins;
  Ref<SamplePattern> pattern;
  Ref<Mesh> seen;
  Ref<Column> screen;  // of `seen`
  int id = -1;
  RealPlane z;
  std::array<RealPlane, 4> under{};
};

// ----- the edges that are drawn

// Whether the sides of two faces that the camera sees differ; faces seen edge-on differ from all.
template <class R>
bool is_outline(std::span<const glm::uvec3> triangle, std::span<const glm::vec<4, R>> clip,
                const kernels::MeshEdge& e) {
  const auto side = [&](std::uint32_t f) {
    const glm::uvec3& t = triangle[f];
    const auto row = [&](std::uint32_t v) { return glm::vec<3, R>(clip[v].x, clip[v].y, clip[v].w); };
    return kernels::determinant_sign(row(t.x), row(t.y), row(t.z));
  };
  return side(e.face[0]) * side(e.face[1]) <= 0;
}

template <class R>
std::vector<kernels::MeshEdge> edges_of(const Mesh& mesh, std::span<const glm::vec<4, R>> clip,
                                        const std::optional<double>& crease) {
  // Without world positions vertices are one where they are one in the mesh.
  std::vector<std::uint32_t> place(mesh.vertices());
  for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
  Ref<Column> world;
  if (mesh.find("world") != nullptr) {
    world = mesh.real<R>("world");
    place = kernels::equal_points<R>(world->template values<glm::vec<3, R>>());
  }
  if (!crease)
    return kernels::mesh_edges(mesh.triangles(), place, [](const kernels::MeshEdge&) { return true; });
  if (!world)
    throw NodeError("missing_column", "creases need world positions: the mesh has not passed project.view");
  const auto p = world->template values<glm::vec<3, R>>();
  const double largest = *crease * std::numbers::pi / 180;
  const auto triangle = mesh.triangles();
  const auto normal = [&](std::uint32_t f) {
    const glm::uvec3& t = triangle[f];
    const glm::dvec3 a(p[t.x]);
    return kernels::cross(glm::dvec3(p[t.y]) - a, glm::dvec3(p[t.z]) - a);
  };
  return kernels::mesh_edges(triangle, place, [&](const kernels::MeshEdge& e) {
    if (e.faces != 2 || !e.turned) return true;
    return kernels::angle_between(normal(e.face[0]), normal(e.face[1])) > largest ||
           is_outline<R>(triangle, clip, e);
  });
}

const Camera& camera_of(const Mesh& mesh) {
  if (!mesh.camera)
    throw NodeError("no_camera", "the mesh has passed no projection, so its picture has no resolution");
  constexpr int limit = 65536;
  const glm::ivec2 size = mesh.camera->resolution;
  if (size.x < 1 || size.y < 1 || size.x > limit || size.y > limit)
    throw NodeError("too_large", fmt::format("the picture is {} x {} pixels; 1 to {} can be drawn each way",
                                             size.x, size.y, limit));
  return *mesh.camera;
}

wireframe::LineBins lines_of(const Inputs& in, const Params& p, Context& ctx) {
  const Mesh& mesh = *in.mesh;
  const Camera& camera = camera_of(mesh);
  const double reach = p.width / 2 + 1;
  const auto planes = wireframe::planes_around(camera.resolution, clip_space(&camera), reach);
  const kernels::Viewport viewport = viewport_of(camera);
  std::vector<wireframe::Line> lines;
  ctx.real([&]<class R>() {
    const auto position = mesh.real<R>("position");
    const auto clip = position->template values<glm::vec<4, R>>();
    const auto edges = edges_of<R>(mesh, clip, p.crease);
    ctx.count("edges", edges.size());
    for (const kernels::MeshEdge& e : edges)
      if (const auto line =
              wireframe::line_of(glm::dvec4(clip[e.a]), glm::dvec4(clip[e.b]), planes, viewport))
        lines.push_back(*line);
  });
  ctx.count("lines", lines.size());
  return {std::move(lines), camera.resolution, reach};
}

// ----- the frame

bool same_pattern(const Ref<SamplePattern>& a, const Ref<SamplePattern>& b) {
  if (a == b) return true;
  return a && b && a->samples == b->samples && a->period == b->period && a->x == b->x && a->y == b->y;
}

// The shape of what is drawn: that of the pixels it is drawn over, which all have to agree.
Frame frame_of(const Inputs& in, const Camera& camera, Precision precision) {
  const Rect whole{0, 0, camera.resolution.x, camera.resolution.y};
  const PlaneKind kind = real_kind(precision);
  Frame out{.window = whole,
            .pattern = in.pattern.value_or(nullptr),
            .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
            .color_space = std::string(linear_rec709),
            .alpha = Alpha::premultiplied};
  bool first = !in.pattern;
  const auto agree = [&](const Frame& f, std::string_view input) {
    if (f.window != whole)
      throw NodeError("frames_differ", fmt::format("'{}' is not a picture of the mesh's camera: its size is "
                                                   "{} x {}",
                                                   input, f.window.width(), f.window.height()));
    if (first) out.pattern = f.pattern, first = false;
    if (!same_pattern(out.pattern, f.pattern))
      throw NodeError("frames_differ", fmt::format("'{}' has other samples than the other inputs", input));
  };
  if (in.hits) agree(in.hits->frame(), "hits");
  if (in.under) agree(in.under->frame(), "under");
  return out;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  Frame frame = frame_of(in, camera_of(*in.mesh), ctx.precision);
  State s{.precision = ctx.precision,
          .look = p,
          .depth = clip_space(in.mesh->camera.get()).depth,
          .bins = lines_of(in, p, ctx),
          .pattern = frame.pattern,
          .seen = {},
          .screen = {},
          .id = -1,
          .z = {}};
  if (in.hits && p.hidden < 1) {
    if (!in.seen)
      throw NodeError("missing_mesh", "hidden lines need the mesh that the hits are of: link it to 'seen'");
    s.seen = *in.seen;
    s.screen = ctx.real([&]<class R>() { return s.seen->real<R>("position"); });
    s.id = in.hits->read("id");
    s.z = read_real(*in.hits, "Z", ctx.precision);
  }
  if (in.under)
    for (std::size_t k = 0; k < 4; ++k)
      s.under[k] = read_real(*in.under, std::array{"R", "G", "B", "A"}[k], ctx.precision);
  return {std::move(s), {std::move(frame)}};
}

// ----- drawing

template <class R>
class Drawing {
 public:
  Drawing(const State& s, const Tile& hits, const Tile& under, const Tile& out, Arena& arena)
      : s_(s),
        hits_(hits),
        under_(under),
        out_(out),
        rect_(out.rect()),
        width_(static_cast<std::size_t>(rect_.width())),
        ink_(arena.take<double>(width_ * static_cast<std::size_t>(rect_.height() * out.samples()))),
        scratch_(arena.take<R>(4 * width_)) {}

  void draw() {
    std::fill(ink_.begin(), ink_.end(), 0.0);
    constexpr int cell = wireframe::LineBins::cell;
    for (int row = rect_.y0 / cell; row * cell < rect_.y1; ++row)
      for (int column = rect_.x0 / cell; column * cell < rect_.x1; ++column) {
        const Rect part =
            intersection(rect_, {column * cell, row * cell, (column + 1) * cell, (row + 1) * cell});
        for (const std::uint32_t i : s_.bins.of(column, row)) draw_line(s_.bins.line(i), part);
      }
    for (int k = 0; k < out_.samples(); ++k)
      for (int y = rect_.y0; y < rect_.y1; ++y) composite(k, y);
  }

 private:
  double& ink(int sample, int y, int x) {
    const auto row = static_cast<std::size_t>(sample * rect_.height() + y - rect_.y0);
    return ink_[row * width_ + static_cast<std::size_t>(x - rect_.x0)];
  }

  void draw_line(const wireframe::Line& line, const Rect& part) {
    const double reach = s_.bins.reach();
    const double low = std::min(line.a.y, line.b.y) - reach, high = std::max(line.a.y, line.b.y) + reach;
    const int y0 = low > part.y0 ? static_cast<int>(low) : part.y0;
    const int y1 = high < part.y1 ? static_cast<int>(std::ceil(high)) : part.y1;
    for (int y = y0; y < y1; ++y) {
      const auto [left, right] = s_.bins.x_between(line, y, y + 1);
      if (left > right || right < part.x0 || left > part.x1) continue;
      const int x0 = left > part.x0 ? static_cast<int>(left) : part.x0;
      const int x1 = right < part.x1 ? static_cast<int>(std::ceil(right)) : part.x1;
      for (int x = x0; x < x1; ++x)
        for (int k = 0; k < out_.samples(); ++k) draw_sample(line, k, x, y);
    }
  }

  // The darkest of all lines counts, so that their order does not.
  void draw_sample(const wireframe::Line& line, int k, int x, int y) {
    double& most = ink(k, y, x);
    glm::dvec2 p(x + 0.5, y + 0.5);
    if (s_.pattern) {
      const std::size_t i = s_.pattern->index(k, x, y);
      p = {x + s_.pattern->x[i] * 0x1p-12, y + s_.pattern->y[i] * 0x1p-12};
    }
    const wireframe::Nearest near = wireframe::nearest(line, p);
    double amount = wireframe::coverage(near.distance, s_.look.width, out_.samples() > 1);
    if (amount <= most) return;
    if (s_.id >= 0 && is_hidden(near, k, x, y)) amount *= s_.look.hidden;
    most = std::max(most, amount);
  }

  bool is_hidden(const wireframe::Nearest& near, int k, int x, int y) const {
    const auto at = static_cast<std::size_t>(x - rect_.x0);
    const std::uint32_t face = hits_.row<const std::uint32_t>(s_.id, k, y)[at];
    if (face == no_face) return false;
    const auto triangles = s_.seen->triangles();
    if (face >= triangles.size())
      throw NodeError(
          "wrong_mesh",
          fmt::format("face {} is seen, but the mesh 'seen' has {} faces", face, triangles.size()),
          at_input("seen"));
    const glm::uvec3& t = triangles[face];
    const auto p = s_.screen->template values<glm::vec<4, R>>();
    const double slope = wireframe::depth_slope(p[t.x], p[t.y], p[t.z]);
    return wireframe::is_behind(near.z, depth(k, x, y), slope, near.distance, s_.depth);
  }

  double depth(int k, int x, int y) const {
    const auto at = static_cast<std::size_t>(x - rect_.x0);
    return s_.z.kind == PlaneKind::f32 ? static_cast<double>(hits_.row<const float>(s_.z.index, k, y)[at])
                                       : hits_.row<const double>(s_.z.index, k, y)[at];
  }

  void composite(int k, int y) {
    const glm::dvec3 line = s_.look.color.rgb;
    const glm::dvec4 paper = s_.look.paper ? glm::dvec4(s_.look.paper->rgb, 1) : glm::dvec4(0);
    for (int c = 0; c < 4; ++c) {
      R* to = out_row<R>(out_, c, k, y);
      if (to == nullptr) continue;
      const auto plane = static_cast<std::size_t>(c);
      const R* below = real_row<R>(under_, s_.under[plane], k, y, scratch_.subspan(plane * width_, width_));
      const double ink_color = c < 3 ? line[c] : 1;
      for (std::size_t x = 0; x < width_; ++x) {
        const double amount =
            ink_[(static_cast<std::size_t>(k * rect_.height() + y - rect_.y0)) * width_ + x];
        const double base = below != nullptr ? static_cast<double>(below[x]) : paper[c];
        to[x] = static_cast<R>(base * (1 - amount) + ink_color * amount);
      }
    }
  }

  const State& s_;
  const Tile hits_, under_;
  const Tile& out_;
  const Rect rect_;
  const std::size_t width_;
  const std::span<double> ink_;  // sample x row x column
  const std::span<R> scratch_;
};

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& image = out[&Outputs::image];
  const auto part = [&](const Tile& t) { return t.empty() ? t : t.part(image.rect()); };
  const Tile hits = part(in[&Inputs::hits]), under = part(in[&Inputs::under]);
  if (s.precision == Precision::single)
    Drawing<float>(s, hits, under, image, arena).draw();
  else
    Drawing<double>(s, hits, under, image, arena).draw();
}

}  // namespace

NodeType nodes::rasterize_wireframe() {
  return pixel_node("rasterize.wireframe", prepare, tile)
      .doc("Draws the edges of a mesh as smooth lines: clipped, divided, then measured at every sample.")
      .cite("Liang & Barsky 1984, A new concept and method for line clipping, doi:10.1145/357332.357333")
      .cite("Baerentzen et al. 2006, Single-pass wireframe rendering (distances instead of steps)")
      .covers(23)
      .input("mesh", &Inputs::mesh, "The mesh before it is clipped, so that cuts add no edges.",
             {.space = Space::clip})
      .input("hits", &Inputs::hits, "What is seen; without it all edges are, front and back.")
      .input("seen", &Inputs::seen, "The mesh that the hits are of.", {.space = Space::screen})
      .input("under", &Inputs::under, "Colour that the lines are drawn over, instead of paper.")
      .input("pattern", &Inputs::pattern, "Where samples lie when neither hits nor colour say it.")
      .param("width", &Params::width, "Of a line on the screen; raising it makes lines bolder.",
             {.unit = "px", .range = between(0.01, 64)})
      .param("color", &Params::color, "Of the lines.", {.range = at_least(0)})
      .param("hidden", &Params::hidden,
             "How strong hidden edges are: 0 leaves them out, 1 sees through; raising it shows them more.",
             {.range = between(0, 1)})
      .param("crease", &Params::crease,
             "Draws only outlines, borders and edges bent by more; 0 leaves out flat ones, null draws all.",
             {.unit = "degrees", .range = between(0, 180)})
      .param("paper", &Params::paper, "Colour behind the lines; null is transparent.", {.range = at_least(0)})
      .output("image", &Outputs::image,
              "Lines at every sample, linear Rec.709, premultiplied; where several meet, the strongest.");
}

}  // namespace frustum
