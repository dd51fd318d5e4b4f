#include "nodes/io/load_image.h"

#include "nodes/io.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color.h"
#include "runtime/io/image_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  FilePath file;
  int subimage = 0;
  std::string layer;
  std::string space;
};
struct Outputs {
  Ref<Image> image;
};

Raster layer_of_file(const Raster& pixels, const Params& p) {
  if (auto layer = take_layer(pixels, p.layer)) return *layer;
  const std::vector<std::string> known = layer_names(pixels.frame().planes);
  const auto near = nearest_names(p.layer, known);
  std::vector<std::string> quoted;
  for (const std::string& name : known) quoted.push_back(fmt::format("'{}'", name));
  throw NodeError(
      "unknown_layer",
      fmt::format("{}: there is no layer '{}', only {}{}", p.file.written, p.layer, fmt::join(quoted, ", "),
                  near.empty() ? "" : fmt::format("; did you mean '{}'?", near.front())),
      at_param("layer"));
}

void check(const Params& p) {
  if (p.file.empty()) throw NodeError("no_file", "no file is named", at_param("file"));
  try {
    if (!p.space.empty()) ColorConfig::open({})->resolve(p.space);
  } catch (const NodeError& e) {
    throw NodeError(e.code, e.what(), at_param("space"));
  }
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const std::string space = p.space.empty() ? p.space : ColorConfig::open({})->resolve(p.space);
  Raster pixels = read_image(p.file.resolved, p.file.written, p.subimage).raster;
  if (!p.layer.empty()) pixels = layer_of_file(pixels, p);
  if (!space.empty() && space != pixels.frame().color_space) pixels = relabelled(pixels, space);
  ctx.count("pixels", static_cast<std::uint64_t>(pixels.frame().window.area()));
  return {std::make_shared<Image>(Image{std::move(pixels)})};
}

}  // namespace

NodeType nodes::io_load_image() {
  NodeType type =
      node("io.load_image", run)
          .doc("Reads a picture: PNG, JPEG, EXR, HDR, TIFF and whatever else OpenImageIO knows.")
          .param("file", &Params::file,
                 "A picture file; its channels become planes, colours stay in the file's space.")
          .param("subimage", &Params::subimage, "Which part of a file that holds several pictures, from 0.",
                 {.range = at_least(0)})
          .param("layer", &Params::layer,
                 "A layer of an EXR file by its name: its colours become R G B A; empty: all planes.")
          .param("space", &Params::space,
                 "Colour space to take the file's colours as, instead of what the file says.")
          .check(check)
          .output("image", &Outputs::image,
                  "One value a pixel: R G B with premultiplied A, and the file's other channels.");
  depend_on_color_environment(type);
  return type;
}

}  // namespace frustum
