#include "nodes/shade/surface.h"

#include "nodes/kernels/any_seen.h"
#include "nodes/kernels/parallel.h"
#include "nodes/shade.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/lit_faces.h"
#include "runtime/buffers/lit_scene.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/buffers/shading_scene.h"
#include "runtime/buffers/transparency.h"
#include "runtime/buffers/visible_lights.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>
#include <algorithm>

namespace frustum {
namespace {

using namespace shading;

enum class Interpolation : std::uint8_t { flat, gouraud, phong };
constexpr auto choices(Interpolation) {
  return std::array{std::pair{Interpolation::flat, "flat"}, std::pair{Interpolation::gouraud, "gouraud"},
                    std::pair{Interpolation::phong, "phong"}};
}
enum class Rate : std::uint8_t { sample, pixel };
constexpr auto choices(Rate) {
  return std::array{std::pair{Rate::sample, "sample"}, std::pair{Rate::pixel, "pixel"}};
}

struct Inputs {
  Tiled<Image> points;
  Ref<Mesh> mesh;
  std::optional<Tiled<Image>> albedo, visibility;
  std::optional<Ref<Material>> material;
  std::vector<Ref<LightSet>> lights;
  std::optional<Ref<Camera>> camera;
};
struct Params {
  Interpolation interpolation = Interpolation::phong;
  Rate rate = Rate::sample;
  bool two_sided = false;
};
struct Outputs {
  Tiled<Image> color;
};

constexpr std::string_view highlights_name = "highlights", ambient_name = "ambient_light",
                           attenuation_name = "attenuation", sides_name = "two_sided_lighting",
                           shadows_name = "shadows", supersampling_name = "supersampling";

// What a pixel needs in the precision of the node.
template <class R>
struct Shader {
  Scene<R> scene;
  std::vector<LitFaces<R>> lit;  // flat and Gouraud: all light, or by source where some may be hidden
};

struct State {
  std::variant<Shader<float>, Shader<double>> shader;
  Interpolation interpolation;
  bool once_a_pixel;
  bool once_a_face = false;  // pixels all of whose samples show one face are lit at their first sample
  Ref<Mesh> mesh;
  int id = -1;
  std::array<RealPlane, 3> normal{}, position{}, albedo{};
  std::vector<RealPlane> reach{};  // by source; empty: no light is hidden from anything
  RealPlane alpha{};               // of the albedo; unset: opaque
  bool straight_albedo = false;    // its colours are not multiplied by it
};

LitScene lit_scene(const Inputs& in) {
  return {*in.mesh, in.material ? std::vector{*in.material} : materials_of(*in.mesh), in.lights};
}
const Camera* camera_of(const Inputs& in) { return in.camera ? in.camera->get() : in.mesh->camera.get(); }

ShadingEffects effects_asked(const Inputs& in, const Params& p, const Context& ctx) {
  const bool places = p.interpolation != Interpolation::phong || in.points.frame().find("P.x");
  return {.highlights = ctx.simulates(highlights_name),
          .ambient = ctx.simulates(ambient_name),
          .attenuation = ctx.simulates(attenuation_name),
          .sides = ctx.simulates(sides_name),
          .all_highlights = ctx.forces(highlights_name) && places,
          .all_attenuation = ctx.forces(attenuation_name),
          .all_sides = ctx.forces(sides_name)};
}

bool some_hidden(const Inputs& in, const Context& ctx) {
  return in.visibility && !in.visibility->frame().planes.empty() && ctx.simulates(shadows_name);
}

// A mesh without faces has nothing that needs normals.
Interpolation interpolation_of(const Inputs& in, const Params& p) {
  return in.mesh->faces() == 0 ? Interpolation::flat : p.interpolation;
}

template <class R>
Shader<R> make_shader(const Inputs& in, const Params& p, const Context& ctx) {
  const ShadingEffects asked = effects_asked(in, p, ctx);
  Shader<R> shader{make_shading_scene<R>(lit_scene(in), camera_of(in), p.two_sided, asked), {}};
  Scene<R>& s = shader.scene;
  if (in.mesh->faces() == 0) {
    shader.lit.emplace_back();
    return shader;
  }
  s.opacity = opacities_of<R>(*in.mesh);
  if (asked.all_sides) s.side.assign(in.mesh->faces(), R(1));
  if (std::any_of(s.surfaces.begin(), s.surfaces.end(), [](const auto& of) { return of.two_sided; }))
    s.side = sides_of_faces(s, *in.mesh, ctx);
  if (p.interpolation != Interpolation::phong)
    shader.lit =
        light_by_source(s, *in.mesh, p.interpolation == Interpolation::flat, some_hidden(in, ctx), ctx);
  return shader;
}

// The points that are lit, were every pixel to show one face.
std::uint64_t points_of(const Inputs& in, const Params& p) {
  const Frame& f = in.points.frame();
  return static_cast<std::uint64_t>(f.window.area()) *
         static_cast<std::uint64_t>(p.rate == Rate::pixel ? 1 : f.samples());
}

Verdict highlights(const Inputs& in, const Params& p, const Context&) {
  return needs_highlights(lit_scene(in), points_of(in, p));
}
Verdict ambient_light(const Inputs& in, const Params& p, const Context&) {
  return needs_ambient(lit_scene(in), points_of(in, p));
}
Verdict attenuation(const Inputs& in, const Params& p, const Context&) {
  return needs_attenuation(lit_scene(in), points_of(in, p));
}

Verdict two_sided_lighting(const Inputs& in, const Params& p, const Context& ctx) {
  return needs_sides(lit_scene(in), p.two_sided, camera_of(in), points_of(in, p), ctx);
}

// What is lit depends on the face alone: its light was found once, before the pixels, and nothing scales it by place.
Verdict supersampling(const Inputs& in, const Params& p, const Context&) {
  const std::uint64_t points = points_of(in, p);
  if (in.points.frame().samples() == 1) return off_exact("one sample a pixel");
  if (p.rate == Rate::pixel) return off_user("the graph asks for light once a pixel and face");
  if (p.interpolation != Interpolation::flat) return on("light changes over a face", points);
  if (in.albedo && !in.albedo->frame().white.holds) return on("the albedo changes over a face", points);
  if (in.visibility && !in.visibility->frame().planes.empty())
    return on("shadows change over a face", points);
  return off_exact("a face has one colour: so has a pixel whose samples all show it", points);
}

Verdict shadows(const Inputs& in, const Params& p, const Context&) {
  if (in.visibility) {
    const std::uint64_t points = points_of(in, p);
    const PlaneList& planes = in.visibility->frame().planes;
    if (planes.empty()) return off_exact("'visibility' hides no light from anything", points);
    return on(fmt::format("'visibility' may hide {} sources of light", planes.size()), points);
  }
  return needs_shadows(lit_scene(in));
}

// A raster that goes with the points, pixel by pixel.
void require_same_shape(const Frame& points, const Frame& other, std::string_view input) {
  if (other.window != points.window || other.samples() != points.samples())
    throw NodeError("different_frames", fmt::format("{} and points have different windows or samples", input),
                    at_input(input));
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  State s{.shader = {}, .interpolation = interpolation_of(in, p), .once_a_pixel = false, .mesh = in.mesh};
  ctx.real([&]<class R>() { s.shader = make_shader<R>(in, p, ctx); });
  const Frame& from = in.points.frame();
  s.once_a_pixel = p.rate == Rate::pixel && from.samples() > 1;
  s.once_a_face = !s.once_a_pixel && from.samples() > 1 && !ctx.simulates(supersampling_name);
  s.id = in.points.read("id");
  if (s.interpolation == Interpolation::phong) {
    if (!from.find("N.x"))
      throw NodeError("missing_normals",
                      "the points have no normals: give the mesh some, or use interpolation \"flat\"",
                      at_input("points"));
    s.normal = {read_real(in.points, "N.x", ctx.precision), read_real(in.points, "N.y", ctx.precision),
                read_real(in.points, "N.z", ctx.precision)};
    if (std::visit([](const auto& sh) { return sh.scene.needs_positions(); }, s.shader))
      s.position = {read_real(in.points, "P.x", ctx.precision), read_real(in.points, "P.y", ctx.precision),
                    read_real(in.points, "P.z", ctx.precision)};
  }
  if (in.albedo && !in.albedo->frame().white.holds) {
    require_same_shape(from, in.albedo->frame(), "albedo");
    s.albedo = {read_real(*in.albedo, "R", ctx.precision), read_real(*in.albedo, "G", ctx.precision),
                read_real(*in.albedo, "B", ctx.precision)};
    const Frame& a = in.albedo->frame();
    if (a.find("A")) s.alpha = read_real(*in.albedo, "A", ctx.precision);
    s.straight_albedo = a.alpha == Alpha::straight;
  }
  if (some_hidden(in, ctx)) {
    require_same_shape(from, in.visibility->frame(), "visibility");
    const auto sources = std::visit([](const auto& sh) { return sh.scene.lights.size(); }, s.shader);
    s.reach = read_visible_lights(*in.visibility, sources, ctx.precision);
  }
  const PlaneKind kind = real_kind(ctx.precision);
  Frame color{.window = from.window,
              .pattern = from.pattern,
              .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
              .color_space = std::string(linear_rec709),
              .alpha = Alpha::premultiplied};
  return {std::move(s), {std::move(color)}};
}

bool has_highlights(const State& s) {
  return std::visit([](const auto& shader) { return shader.scene.highlights; }, s.shader);
}

// Numbers come in threes: what is lit (normal and, where needed, position; or diffuse and, where a surface has a
// highlight, specular light), then albedo and its opacity; at last, for points that are lit here, one for each light that may be hidden.
//   reach  by source; keeps what the row points to
template <class R>
PointRow<R> point_row(const State& s, const std::uint32_t* id, const auto& number,
                      std::vector<const R*>& reach) {
  std::size_t at = 0;
  const auto three = [&] {
    at += 3;
    return std::array<const R*, 3>{number(at - 3), number(at - 2), number(at - 1)};
  };
  PointRow<R> row{.id = id};
  if (s.interpolation == Interpolation::phong) {
    row.normal = three();
    if (s.position[0]) row.position = three();
  } else {
    row.received.diffuse = three();
    if (has_highlights(s)) row.received.specular = three();
  }
  if (s.albedo[0]) row.albedo = three();
  if (s.alpha) ++at;
  if (s.interpolation != Interpolation::phong) return row;
  reach.assign(s.reach.size(), nullptr);
  for (std::size_t i = 0; i < reach.size(); ++i)
    if (s.reach[i]) reach[i] = number(at++);
  row.reach = reach;
  return row;
}

template <class R>
class Filler {
 public:
  Filler(const State& s, const Tile& points, const Tile& albedo, const Tile& visibility, const Tile& out,
         Arena& arena)
      : s_(s),
        shader_(std::get<Shader<R>>(s.shader)),
        points_(points),
        albedo_(albedo),
        visibility_(visibility),
        out_(out),
        arena_(arena),
        positions_(sample_positions(points.frame().pattern.get())),
        n_(static_cast<std::size_t>(out.rect().width())),
        samples_(static_cast<std::size_t>(out.samples())) {
    const bool highlights = shader_.scene.highlights;
    for (std::size_t k = 0; k < 3; ++k) {
      scratch_.light.diffuse[k] = row();
      if (highlights) scratch_.light.specular[k] = row();
    }
    scratch_.side = row();
    scratch_.opacity = row();
    scratch_.tag = arena.take<std::uint32_t>(n_).data();
    scratch_.present = &present_;
    const bool phong = s.interpolation == Interpolation::phong;
    lit_numbers_ = (phong ? static_cast<bool>(s.position[0]) : highlights) ? 6 : 3;
    alpha_ = lit_numbers_ + (s.albedo[0] ? 3u : 0u);
    numbers_ = alpha_ + (s.alpha ? 1u : 0u);
    for (auto& plane : straight_)
      if (s.alpha) plane = row();
    for (const LitFaces<R>& lit : shader_.lit) faces_.push_back(lit.view(*s.mesh));
    if (phong)
      for (const RealPlane& plane : s.reach) numbers_ += plane ? 1 : 0;
    else if (!s.reach.empty())
      for (auto& part : part_) part = row();
    if (sizeof(R) == 8 || !phong) copies_ = arena.take<R>(numbers_ * samples_ * n_);
    row_.resize(numbers_ * samples_);
    id_.resize(samples_);
    if (s.once_a_face) differs_ = arena.take<std::uint32_t>(n_);
    if (!s.once_a_pixel) return;
    left_ = arena.take<std::uint32_t>(samples_ * n_);
    face_ = arena.take<std::uint32_t>(n_);
    for (std::size_t i = 0; i < numbers_; ++i) mean_.push_back(row());
    for (auto& plane : color_.plane) plane = row();
  }

  void fill() {
    for (int y = out_.rect().y0; y < out_.rect().y1; ++y) {
      if (!find_ids(y)) {
        clear(y);
        continue;
      }
      find_rows(y);
      if (s_.once_a_pixel)
        shade_faces(y);
      else
        shade_samples(y);
    }
  }

 private:
  R* row() { return arena_.take<R>(n_).data(); }
  std::span<R> copy(std::size_t number, std::size_t sample) {
    return copies_.empty() ? copies_ : copies_.subspan((number * samples_ + sample) * n_, n_);
  }

  // The faces of one y; returns whether there are any.
  bool find_ids(int y) {
    for (std::size_t k = 0; k < samples_; ++k)
      id_[k] = points_.row<const std::uint32_t>(s_.id, static_cast<int>(k), y);
    return std::any_of(id_.begin(), id_.end(), [&](const auto* id) { return kernels::any_seen(id, n_); });
  }

  void clear(int y) const {
    for (std::size_t k = 0; k < samples_; ++k) clear_row(n_, out_rows(k, y));
  }

  // The rows of one y that lighting starts from: number i of sample k at row_[i samples_ + k].
  void find_rows(int y) {
    if (s_.once_a_face) find_mixed(id_, n_, differs_, mixed_);
    std::size_t number = 0;
    const auto add = [&](const Tile& tile, std::span<const RealPlane> planes) {
      for (const RealPlane plane : planes) {
        if (!plane) continue;
        for (std::size_t k = 0; k < samples_; ++k)
          row_[number * samples_ + k] = real_row<R>(tile, plane, static_cast<int>(k), y, copy(number, k));
        ++number;
      }
    };
    if (s_.interpolation == Interpolation::phong) {
      add(points_, s_.normal);
      if (s_.position[0]) add(points_, s_.position);
    } else {
      for (std::size_t k = 0; k < samples_; ++k) {
        std::array<R*, 6> out{};
        for (std::size_t i = 0; i < lit_numbers_; ++i) row_[i * samples_ + k] = out[i] = copy(i, k).data();
        for (const Run& run : runs_of(k)) find_face_light(static_cast<int>(k), y, run, out);
      }
      number = lit_numbers_;
    }
    if (s_.albedo[0]) add(albedo_, s_.albedo);
    if (s_.alpha) add(albedo_, std::span(&s_.alpha, 1));
    if (s_.interpolation == Interpolation::phong) add(visibility_, s_.reach);
  }

  const R* alpha_row(std::size_t sample) const { return row_[alpha_ * samples_ + sample]; }

  // Flat and Gouraud: what the faces received; of each light that may be hidden, as much as reaches the point.
  void find_face_light(int k, int y, const Run& run, const std::array<R*, 6>& out) {
    const auto find = [&](const kernels::FaceLight<R>& light, std::array<R*, 6> to) {
      for (R*& row : to)
        if (row != nullptr) row += run.first;
      kernels::face_light_row(light, positions_, id_[static_cast<std::size_t>(k)] + run.first, k,
                              points_.rect().x0 + static_cast<int>(run.first), y, run.second - run.first, to);
    };
    if (s_.reach.empty()) return find(faces_[0], out);
    for (R* to : out)
      if (to != nullptr) std::fill(to + run.first, to + run.second, R(0));
    std::array<R*, 6> part{};
    std::copy_n(part_.begin(), lit_numbers_, part.begin());
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      find(faces_[i], part);
      const R* reach = real_row<R>(visibility_, s_.reach[i], k, y, std::span(part_[6], n_));
      for (std::size_t c = 0; c < lit_numbers_; ++c) add_row(part[c], reach, run, out[c]);
    }
  }

  // The pixels at which a sample is lit.
  std::span<const Run> runs_of(std::size_t sample) const {
    if (sample > 0 && s_.once_a_face) return mixed_;
    return {&whole_, 1};
  }

  kernels::ColorRows<R> out_rows(std::size_t sample, int y, std::size_t x = 0) const {
    kernels::ColorRows<R> rows;
    for (std::size_t k = 0; k < 4; ++k)
      if (R* row = out_row<R>(out_, static_cast<int>(k), static_cast<int>(sample), y))
        rows.plane[k] = row + x;
    return rows;
  }

  void shade_samples(int y) {
    for (std::size_t k = 0; k < samples_; ++k) {
      if (k > 0 && s_.once_a_face) copy_row(out_rows(0, y), n_, out_rows(k, y));
      for (const auto& [begin, end] : runs_of(k)) {
        const auto number = [&, first = begin](std::size_t i) { return row_[i * samples_ + k] + first; };
        const kernels::ColorRows<R> out = out_rows(k, y, begin);
        PointRow<R> points = point_row<R>(s_, id_[k] + begin, number, reach_);
        const std::size_t n = end - begin;
        const R* alpha = s_.alpha ? alpha_row(k) + begin : nullptr;
        const bool clear = any_clear(points.id, alpha, n);
        if (clear && !s_.straight_albedo) straighten_row(alpha, n, straight_, points.albedo);
        shade_row(shader_.scene, points, n, scratch_, out);
        if (clear) cover_row(points.id, alpha, n, out);
      }
    }
  }

  // Once for each face a pixel sees, at the mean of its samples there; all of them get that colour, each with its own
  // opacity. Samples that are not there have no share in the albedo.
  void shade_faces(int y) {
    clear(y);
    for (std::size_t k = 0; k < samples_; ++k) std::copy_n(id_[k], n_, left_.data() + k * n_);
    while (take_face_row<R>(left_.data(), samples_, n_, row_, face_.data(), mean_)) {
      PointRow<R> means = point_row<R>(
          s_, face_.data(), [&](std::size_t i) { return mean_[i]; }, reach_);
      const R* alpha = s_.alpha ? mean_[alpha_] : nullptr;
      if (!s_.straight_albedo && any_clear(means.id, alpha, n_))
        straighten_row(alpha, n_, straight_, means.albedo);
      shade_row(shader_.scene, means, n_, scratch_, color_);
      for (std::size_t k = 0; k < samples_; ++k)
        put_face_row(id_[k], face_.data(), n_, color_, out_rows(k, y));
    }
    for (std::size_t k = 0; k < samples_ && s_.alpha; ++k)
      if (any_clear(id_[k], alpha_row(k), n_)) cover_row(id_[k], alpha_row(k), n_, out_rows(k, y));
  }

  const State& s_;
  const Shader<R>& shader_;
  const Tile &points_, &albedo_, &visibility_, &out_;
  Arena& arena_;
  std::vector<kernels::FaceLight<R>> faces_;  // as Shader::lit
  std::array<R*, 7> part_{};                  // rows of one light alone, and of how much of it reaches
  std::vector<const R*> reach_;
  kernels::SamplePositions positions_;
  std::size_t n_, samples_;
  std::size_t lit_numbers_, alpha_, numbers_;  // alpha_: the number that is the albedo's opacity
  std::vector<const R*> row_;
  std::vector<const std::uint32_t*> id_;  // by sample
  RowScratch<R> scratch_;
  std::vector<std::uint8_t> present_;
  std::span<R> copies_;
  std::span<std::uint32_t> left_, face_, differs_;
  const Run whole_{0, n_};
  std::vector<Run> mixed_;
  std::vector<R*> mean_;
  kernels::ColorRows<R> color_;
  std::array<R*, 3> straight_{};
};

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& color = out[&Outputs::color];
  const Tile points = in[&Inputs::points].part(color.rect());
  const auto part = [&](const Tile& given) { return given.empty() ? given : given.part(color.rect()); };
  const Tile albedo = part(in[&Inputs::albedo]);
  const Tile visibility = s.reach.empty() ? Tile() : part(in[&Inputs::visibility]);
  if (std::holds_alternative<Shader<float>>(s.shader))
    Filler<float>(s, points, albedo, visibility, color, arena).fill();
  else
    Filler<double>(s, points, albedo, visibility, color, arena).fill();
}

}  // namespace

NodeType nodes::shade_surface() {
  return pixel_node("shade.surface", prepare, tile)
      .doc("Lights visible points: Lambert, Phong or Blinn, interpolated flat, by Gouraud or by Phong.")
      .cite("Gouraud 1971, doi:10.1109/T-C.1971.223313; Phong 1975, doi:10.1145/360825.360839; Blinn 1977")
      .covers(50, 51, 52, 53, 54, 55, 56, 57, 58, 59)
      .input("points", &Inputs::points,
             "Visible points: id, and for phong N and (with highlights or point lights) P.")
      .input("mesh", &Inputs::mesh,
             "The mesh the points were seen on; flat and gouraud light its faces and vertices.")
      .input("albedo", &Inputs::albedo,
             "Colour that scales the diffuse and ambient light, such as a texture's; its alpha is that of "
             "the point.")
      .input("visibility", &Inputs::visibility,
             "How much of each light reaches each point; left out, nothing hides a light.")
      .input("material", &Inputs::material, "One material for everything, instead of the mesh's own.")
      .input("lights", &Inputs::lights, "Lights; without any, the picture is black.")
      .input("camera", &Inputs::camera, "Where highlights are seen from; left out, the camera of the mesh.")
      .param("interpolation", &Params::interpolation,
             "What is lit: each face once, each vertex (gouraud), or each point with its own normal (phong).")
      .knob({"flat", "gouraud", "phong"},
            "On a smooth surface cut to edges h, flat is off by O(h), gouraud by O(h^2).")
      .param("rate", &Params::rate,
             "Light every sample, or once a pixel and face, at the mean of that face's samples.")
      .knob({"pixel", "sample"}, "Light varies little within a pixel, except in highlights smaller than one.")
      .param("two_sided", &Params::two_sided,
             "Whether all faces, not just those of two-sided materials, are lit as if turned to the camera.")
      .effect(highlights_name, highlights, "Mirrored light is found for every point, and added.",
              {"point", 1})  // tests/bench/effects_bench.cpp, one thread: 0.8 to 2.4
      .effect(ambient_name, ambient_light, "Light from everywhere is added.", {"point", 1})     // 0.5 to 1.5
      .effect(attenuation_name, attenuation, "Light fades with the distance.", {"point", 0.5})  // 0.2 to 1.6
      .effect(sides_name, two_sided_lighting, "Normals of back faces are turned.", {"point", 0.7})
      .effect(supersampling_name, supersampling,
              "Light is found for every sample, also where a pixel shows one face of one colour.",
              {"sample", 2.4})  // of large faces
      .effect(shadows_name, shadows, "Light does not reach what something else stands in front of.")
      .output("color", &Outputs::color,
              "Linear Rec.709, premultiplied; alpha is the opacity of face and albedo where a point is seen, "
              "else 0.")
      .blank_where(&Inputs::points);
}

}  // namespace frustum
