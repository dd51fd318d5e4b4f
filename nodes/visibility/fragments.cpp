#include "nodes/visibility/fragments.h"

#include "nodes/visibility.h"
#include "runtime/buffers/fragments.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Visibility> layers;
  std::optional<Ref<Image>> color;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {};
struct Outputs {
  Ref<Fragments> fragments;
};

listing::Shape shape_of(const Inputs& in) {
  const Frame& f = in.layers->raster.frame();
  const int samples = in.pattern ? (*in.pattern)->samples : 1;
  if (f.samples() % samples != 0)
    throw NodeError("wrong_pattern",
                    fmt::format("the {} samples of a pixel are no layers of {}: link the pattern that "
                                "visibility.abuffer has",
                                f.samples(), samples),
                    at_input("pattern"));
  return {f.window.width(), f.window.height(), samples, f.samples() / samples};
}

void check_color(const Frame& layers, const Frame& color) {
  if (color.window != layers.window || color.samples() != layers.samples())
    throw NodeError("different_frames",
                    fmt::format("the layers are {} x {} with {} samples a pixel, the colours {} x {} with {}",
                                layers.window.width(), layers.window.height(), layers.samples(),
                                color.window.width(), color.window.height(), color.samples()),
                    at_input("color"));
}

template <class T>
kernels::PlaneView<const T> view(const Raster& r, int plane) {
  const Tile t = r.view();
  if (t.rect().empty()) return {};
  return {t.row<const T>(plane, 0, t.rect().y0), t.row_stride(), t.sample_stride()};
}

template <class T>
Ref<Column> gathered(const listing::Shape& shape, const Fragments& lists, const Raster& from, int plane,
                     const std::string& name) {
  const auto column = Column::make<T>(name, Domain::vertex, lists.count());
  listing::gather<T>(shape, lists.first, view<T>(from, plane), column->template values<T>().data());
  return column;
}

void add_channels(const listing::Shape& shape, const Raster& from, Fragments& to, Context& ctx) {
  const PlaneList& planes = from.frame().planes;
  for (int p = 0; p < static_cast<int>(planes.size()); ++p) {
    const auto& [name, kind] = planes[static_cast<std::size_t>(p)];
    if (to.find(name) != nullptr) continue;  // the id of points is that of the layers
    ctx.poll();
    switch (kind) {
      case PlaneKind::f32: to.channels.push_back(gathered<float>(shape, to, from, p, name)); break;
      case PlaneKind::f64: to.channels.push_back(gathered<double>(shape, to, from, p, name)); break;
      case PlaneKind::u32: to.channels.push_back(gathered<std::uint32_t>(shape, to, from, p, name)); break;
    }
  }
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  const Raster& layers = in.layers->raster;
  const listing::Shape shape = shape_of(in);
  if (in.color) check_color(layers.frame(), (*in.color)->raster.frame());
  Fragments out{.window = layers.frame().window, .pattern = in.pattern.value_or(nullptr)};
  const int id = layers.frame().find("id").value();
  ctx.claim((static_cast<std::uint64_t>(out.window.area()) * static_cast<std::uint64_t>(shape.samples) + 1) *
            sizeof(std::uint64_t));
  out.first = listing::places_of_lists(shape, view<std::uint32_t>(layers, id));
  ctx.count("fragments", out.count());
  add_channels(shape, layers, out, ctx);
  if (in.color) {
    add_channels(shape, (*in.color)->raster, out, ctx);
    out.color_space = (*in.color)->raster.frame().color_space;
  }
  return {std::make_shared<const Fragments>(std::move(out))};
}

}  // namespace

NodeType nodes::visibility_fragments() {
  return node("visibility.fragments", run)
      .doc(
          "Makes the layers of an A-buffer lists of fragments, to look into and to save as deep EXR, CSV or "
          "JSON.")
      .cite("Carpenter 1984, The A-buffer, an antialiased hidden surface method, doi:10.1145/800031.808585")
      .covers(42)
      .input("layers", &Inputs::layers, "Face and depth by layer, from visibility.abuffer.")
      .input("color", &Inputs::color,
             "What was computed of the same layers: colours, or points with their attributes.")
      .input("pattern", &Inputs::pattern,
             "The pattern that visibility.abuffer has; left out: one sample a pixel.")
      .output("fragments", &Outputs::fragments,
              "Of every sample its fragments from the front to the back: id, Z, colour.");
}

}  // namespace frustum
