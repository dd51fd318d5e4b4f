#include "nodes/rasterize/style.h"

#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/lit_scene.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

#include <optional>

namespace frustum {
namespace style {
enum class Style : std::uint8_t { blocked, wireframe, shaded };
constexpr auto choices(Style) {
  return std::array{std::pair{Style::blocked, "blocked"}, std::pair{Style::wireframe, "wireframe"},
                    std::pair{Style::shaded, "shaded"}};
}
}  // namespace style
namespace {

using style::Style;

struct Inputs {
  Tiled<Visibility> hits;
  Ref<Mesh> mesh;
  std::optional<Tiled<Image>> shaded;
};
struct Params {
  Style style = Style::blocked;
  double width = 1;
  Color color{glm::dvec3{0}};
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  Params params;
  Ref<Mesh> mesh;
  Ref<Column> screen;             // f64
  std::vector<glm::dvec3> color;  // of materials
  int id;
  std::array<RealPlane, 4> shaded{};
};

std::vector<glm::dvec3> block_colors(const Mesh& mesh) {
  std::vector<glm::dvec3> colors;
  for (const Ref<Material>& m : materials_of(mesh)) colors.push_back(m->diffuse);
  if (const Column* of = mesh.find("material"))
    for (const std::uint32_t m : of->values<std::uint32_t>())
      if (m >= colors.size() && colors.size() > 1)
        throw NodeError("bad_material", "a face has a material that the mesh does not have",
                        at_input("mesh"));
  return colors;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& hits = in.hits.frame();
  State s{p, in.mesh, in.mesh->real<double>("position"), block_colors(*in.mesh), in.hits.read("id")};
  if (p.style == Style::shaded) {
    if (!in.shaded)
      throw NodeError("missing_plane", "the style shaded needs the colours that shade.surface makes",
                      at_param("style"));
    const Frame& f = in.shaded->frame();
    if (f.window != hits.window || f.samples() != hits.samples())
      throw NodeError("different_frames", "hits and shaded have different windows or samples",
                      at_input("shaded"));
    for (std::size_t k = 0; k < 4; ++k)
      s.shaded[k] = read_real(*in.shaded, std::array{"R", "G", "B", "A"}[k], ctx.precision);
  }
  const PlaneKind kind = real_kind(ctx.precision);
  Frame image{.window = hits.window,
              .pattern = hits.pattern,
              .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
              .color_space = std::string(linear_rec709),
              .alpha = Alpha::premultiplied};
  return {std::move(s), {std::move(image)}};
}

template <class R>
class Drawing {
 public:
  Drawing(const State& s, const Tile& hits, const Tile& shaded, const Tile& out, Arena& arena)
      : s_(s), hits_(hits), shaded_(shaded), out_(out), n_(static_cast<std::size_t>(out.rect().width())) {
    for (auto& row : scratch_) row = arena.take<R>(n_);
  }
  void draw() {
    for (int k = 0; k < out_.samples(); ++k)
      for (int y = out_.rect().y0; y < out_.rect().y1; ++y) draw_row(k, y);
  }

 private:
  void draw_row(int k, int y) {
    const std::uint32_t* id = hits_.row<const std::uint32_t>(s_.id, k, y);
    std::array<R*, 4> to{};
    std::array<const R*, 4> from{};
    for (std::size_t c = 0; c < 4; ++c) {
      to[c] = out_row<R>(out_, static_cast<int>(c), k, y);
      if (s_.shaded[c]) from[c] = real_row<R>(shaded_, s_.shaded[c], k, y, scratch_[c]);
    }
    for (std::size_t x = 0; x < n_; ++x) {
      const bool seen = id[x] < s_.mesh->faces();
      const glm::dvec4 color =
          seen && from[0] == nullptr ? color_of(id[x], k, static_cast<int>(x), y) : glm::dvec4(0);
      for (std::size_t c = 0; c < 4; ++c)
        if (to[c] != nullptr)
          to[c][x] =
              from[c] != nullptr && seen ? from[c][x] : static_cast<R>(color[static_cast<glm::length_t>(c)]);
    }
  }

  glm::dvec4 color_of(std::uint32_t face, int k, int column, int y) {
    if (s_.params.style == Style::blocked) {
      const Column* of = s_.color.size() > 1 ? s_.mesh->find("material") : nullptr;
      return {s_.color[of != nullptr ? of->values<std::uint32_t>()[face] : 0], 1};
    }
    if (face != current_) {
      current_ = face;
      const auto p = s_.screen->values<glm::dvec4>();
      const glm::uvec3& t = s_.mesh->triangles()[face];
      sides_.emplace(glm::dvec2(p[t.x].x, p[t.x].y), glm::dvec2(p[t.y].x, p[t.y].y),
                     glm::dvec2(p[t.z].x, p[t.z].y));
    }
    const int x = out_.rect().x0 + column;
    glm::dvec2 at(x + 0.5, y + 0.5);
    if (const SamplePattern* pattern = out_.frame().pattern.get()) {
      const std::size_t i = pattern->index(k, x, y);
      at = {x + pattern->x[i] * 0x1p-12, y + pattern->y[i] * 0x1p-12};
    }
    return sides_->at(at) <= s_.params.width / 2 ? glm::dvec4(s_.params.color.rgb, 1) : glm::dvec4(0);
  }

  const State& s_;
  const Tile &hits_, &shaded_, &out_;
  std::size_t n_;
  std::array<std::span<R>, 4> scratch_;
  std::uint32_t current_ = no_face;
  std::optional<style::SideDistance> sides_;
};

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& image = out[&Outputs::image];
  const auto part = [&](const Tile& t) { return t.empty() ? t : t.part(image.rect()); };
  const Tile hits = part(in[&Inputs::hits]), shaded = part(in[&Inputs::shaded]);
  if (image.frame().planes[0].kind == PlaneKind::f32)
    Drawing<float>(s, hits, shaded, image, arena).draw();
  else
    Drawing<double>(s, hits, shaded, image, arena).draw();
}

}  // namespace

NodeType nodes::rasterize_style() {
  return pixel_node("rasterize.style", prepare, tile)
      .doc("Draws what is seen as blocks of colour, as the wires of its faces, or shaded.")
      .cite("Baerentzen et al. 2006, Single-pass wireframe rendering, doi:10.1145/1179849.1180035")
      .covers(48)
      .input("hits", &Inputs::hits, "What is seen: no style draws beyond it, and hidden lines are not there.")
      .input("mesh", &Inputs::mesh, "The mesh that the hits are of.", {.space = Space::screen})
      .input("shaded", &Inputs::shaded, "Colours for the style shaded, such as shade.surface makes.")
      .param(
          "style", &Params::style,
          "blocked: each face in its material's colour, unlit; wireframe: its sides alone; shaded: as given.")
      .param("width", &Params::width, "Of wires on the screen; raising it makes them bolder.",
             {.unit = "px", .range = between(0.01, 64)})
      .param("color", &Params::color, "Of wires, linear Rec.709.", {.range = at_least(0)})
      .output("image", &Outputs::image, "Linear Rec.709, premultiplied; transparent where nothing is drawn.");
}

}  // namespace frustum
