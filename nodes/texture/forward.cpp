#include "nodes/texture/forward.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/quad.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Image> image;
  Ref<Points> corners;
  std::optional<Ref<Matrix>> matrix;
};
struct Params {
  kernels::QuadMapKind map = kernels::QuadMapKind::projective;
  int density = 1;
  std::optional<Color> hole;
  glm::ivec2 resolution{64, 64};
};
struct Outputs {
  Ref<Image> image, hits;
  Ref<Table> counts;
};

void check(const Params& p) {
  constexpr int limit = 65536;
  if (p.resolution.x > limit || p.resolution.y > limit)
    throw NodeError("too_large",
                    fmt::format("the picture is {} x {} pixels; at most {} can be filled each way",
                                p.resolution.x, p.resolution.y, limit),
                    at_param("resolution"));
}

// The planes of colour, and A where there is one.
std::vector<int> color_planes(const Frame& f) {
  std::vector<int> planes;
  for (const char* name : {"R", "G", "B"}) {
    const auto i = f.find(name);
    if (!i)
      throw NodeError("missing_plane", fmt::format("the image has no plane {}", name), at_input("image"));
    planes.push_back(*i);
  }
  if (const auto a = f.find("A")) planes.push_back(*a);
  if (f.samples() != 1)
    throw NodeError("sampled_image", fmt::format("{} values a pixel: resolve them first", f.samples()),
                    at_input("image"));
  return planes;
}

Table table_of(const texture::Landing& l, double evenness) {
  Table t;
  t.columns = {{.name = "what"}, {.name = "count"}};
  const auto add = [&](const char* what, double count) {
    t.columns[0].texts.emplace_back(what);
    t.columns[1].numbers.push_back(count);
  };
  add("points sent", static_cast<double>(l.points));
  add("points beside the picture", static_cast<double>(l.outside));
  add("points that overwrote another", static_cast<double>(l.overwrites));
  add("pixels of the quadrilateral", static_cast<double>(l.pixels));
  add("holes among them", static_cast<double>(l.holes));
  add("least over greatest corner area", evenness);
  return t;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::QuadMap map = quad_map(*in.corners, in.matrix ? in.matrix->get() : nullptr, p.map);
  const Raster& source = in.image->raster;
  const std::vector<int> planes = color_planes(source.frame());
  const Rect from = source.frame().window;
  const auto pixels = static_cast<std::uint64_t>(p.resolution.x) * static_cast<std::uint64_t>(p.resolution.y);
  const PlaneKind kind = real_kind(ctx.precision);
  ctx.claim(pixels * (sizeof(std::uint32_t) + 5 * bytes_of(kind)));
  const Rect window{0, 0, p.resolution.x, p.resolution.y};
  Raster image(Frame{.window = window,
                     .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
                     .color_space = source.frame().color_space,
                     .alpha = planes.size() == 4 ? source.frame().alpha : Alpha::premultiplied});
  Raster counts(Frame{.window = window, .planes = {{"hits", kind}}});
  std::vector<std::uint32_t> hits(pixels, 0);
  texture::Landing landing;
  ctx.real([&]<class R>() {
    const auto width = static_cast<std::size_t>(p.resolution.x);
    const auto put = [&](int c, std::size_t pixel, double value) {
      image.view().row<R>(c, 0, static_cast<int>(pixel / width))[pixel % width] = static_cast<R>(value);
    };
    landing =
        texture::land(map, {from.width(), from.height()}, p.density, p.resolution, hits,
                      [&](std::size_t pixel, int x, int y) {
                        for (std::size_t c = 0; c < 4; ++c)
                          put(static_cast<int>(c), pixel,
                              c < planes.size() ? source.value(planes[c], 0, from.x0 + x, from.y0 + y) : 1);
                      });
    ctx.poll();
    texture::count_holes(map, p.resolution, hits, landing, [&](std::size_t pixel) {
      if (!p.hole) return;
      for (int c = 0; c < 3; ++c) put(c, pixel, p.hole->rgb[c]);
      put(3, pixel, 1);
    });
    for (std::size_t i = 0; i < hits.size(); ++i)
      counts.view().row<R>(0, 0, static_cast<int>(i / width))[i % width] = static_cast<R>(hits[i]);
  });
  ctx.count("holes", landing.holes);
  ctx.count("overwrites", landing.overwrites);
  return {std::make_shared<Image>(Image{std::move(image)}), std::make_shared<Image>(Image{std::move(counts)}),
          std::make_shared<Table>(table_of(landing, map.evenness()))};
}

}  // namespace

NodeType nodes::texture_forward() {
  return node("texture.forward", run)
      .doc("Sends every texel to the screen: (x, y) = T_ws(T_tw(s, t)); pixels that none reaches stay holes.")
      .cite(
          "Heckbert 1989, Fundamentals of Texture Mapping and Image Warping, section 2; Catmull & Smith 1980")
      .covers(28)
      .input("image", &Inputs::image, "The texture; its top row is v = 1.")
      .input("corners", &Inputs::corners,
             "Where (u, v) = (0, 0), (1, 0), (1, 1) and (0, 1) lie, in pixels, y down.")
      .input(
          "matrix", &Inputs::matrix,
          "T_ws: takes corners in the world to pixels, before the divide by w, as project.mvp's matrix does.")
      .param("map", &Params::map,
             "T_tw: projective keeps straight lines straight, bilinear keeps steps along sides even.")
      .param("density", &Params::density,
             "Points a texel, each way; raising it closes holes, and overwrites more.",
             {.range = between(1, 64)})
      .knob({"1", "2", "4", "8"}, "Holes are gone where the greatest magnification is below the density.")
      .param("hole", &Params::hole,
             "Colour of holes, in the image's own space; null leaves them transparent.",
             {.range = at_least(0)})
      .param("resolution", &Params::resolution, "Width and height of the picture; raising them shows more.",
             {.unit = "px", .range = at_least(1)})
      .check(check)
      .output("image", &Outputs::image, "The texels where they fell; of several the last one stays.")
      .output("hits", &Outputs::hits, "How many points fell into each pixel.")
      .output("counts", &Outputs::counts,
              "Points sent, overwritten and lost; pixels owned, and holes among them.");
}

}  // namespace frustum
