#include "tests/support/run_node.h"

#include <nlohmann/json.hpp>

#include <stdexcept>

namespace frustum::test {
namespace {

std::shared_ptr<void> read_params(const NodeType& type, const Json& json, const std::string& folder) {
  std::shared_ptr<void> params = type.default_params();
  Diagnostics problems;
  ParamReader reader(problems, "/params", folder);
  read_record(type.params, json, params.get(), reader);
  if (!problems.empty()) throw std::runtime_error(to_text(problems));
  return params;
}

std::vector<Buffer> run_pixels(const NodeType& type, const void* params, const NodeInputs& inputs,
                               Context& ctx, int edge) {
  std::vector<PreparedInput> prepared;
  std::vector<Tile> in;
  for (std::size_t i = 0; i < type.inputs.size(); ++i) {
    PreparedInput p;
    Tile tile;
    if (i < inputs.size() && !inputs[i].empty()) {
      if (type.inputs[i].tiled) {
        const Buffer& b = inputs[i].at(0);
        const Raster& raster = b.type().raster(b.data());
        p.tiled.frame = std::make_shared<const Frame>(raster.frame());
        p.tiled.planes_read = std::make_shared<std::vector<bool>>(raster.frame().planes.size(), false);
        tile = raster.view();
      } else {
        p.buffers = inputs[i];
      }
    }
    prepared.push_back(std::move(p));
    in.push_back(tile);
  }
  const PreparedNode node = type.prepare(prepared, params, ctx);
  std::vector<Raster> rasters;
  for (const auto& frame : node.frames) rasters.emplace_back(*frame);
  const Rect window = rasters.at(0).frame().window;
  const int w = edge > 0 ? edge : std::max(1, window.width()),
            h = edge > 0 ? edge : std::max(1, window.height());
  Arena arena;
  for (int y = window.y0; y < window.y1; y += h)
    for (int x = window.x0; x < window.x1; x += w) {
      const Rect rect = intersection(window, {x, y, x + w, y + h});
      std::vector<Tile> out, part;
      for (const Raster& r : rasters) out.push_back(r.view(rect));
      for (std::size_t i = 0; i < in.size(); ++i) {
        const Rect reads =
            in[i].empty() ? Rect{} : intersection(in[i].rect(), type.reads(node.state.get(), i, rect));
        part.push_back(in[i].empty() || reads.empty() ? in[i] : in[i].part(reads));
      }
      type.tile(node.state.get(), part, out, arena);
      arena.reset();
    }
  std::vector<Buffer> buffers;
  for (std::size_t i = 0; i < rasters.size(); ++i)
    buffers.push_back(type.outputs[i].types.at(0)->from_raster(rasters[i]));
  return buffers;
}

}  // namespace

std::vector<Buffer> run_node(const NodeType& type, const Json& params, const NodeInputs& inputs, Context* ctx,
                             const std::string& folder, int tile_edge) {
  Context own;
  Context& context = ctx != nullptr ? *ctx : own;
  const std::shared_ptr<void> p = read_params(type, params, folder);
  if (type.is_pixel()) return run_pixels(type, p.get(), inputs, context, tile_edge);
  NodeInputs all = inputs;
  all.resize(type.inputs.size());
  return type.run(all, p.get(), context);
}

std::pair<std::string, std::string> run_error(const NodeType& type, const Json& params,
                                              const NodeInputs& inputs, const std::string& folder) {
  try {
    run_node(type, params, inputs, nullptr, folder);
  } catch (const NodeError& e) {
    return {e.code, e.what()};
  } catch (const WorldError& e) {
    return {e.code, e.what()};
  }
  return {};
}

}  // namespace frustum::test
