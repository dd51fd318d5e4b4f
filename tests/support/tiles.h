// A pixel node without the executor: runs its tile() over any rectangles, and holds it to the law of tiles.
#pragma once

#include "runtime/core/node_type.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace frustum::test {

/// Buffers for the inputs of a node, by port; a list port takes several.
using NodeInputs = std::map<std::string, std::vector<Buffer>>;

/// Reads parameters from JSON text, which must be right.
std::shared_ptr<void> params_of(const NodeType& type, std::string_view json);

/// Runs a geometry node and gives its outputs in declared order.
std::vector<Buffer> run_geometry(const NodeType& type, std::string_view params, const NodeInputs& inputs,
                                 Precision precision = Precision::single, Context* used = nullptr);

/// A prepared pixel node. Its tiled inputs are whole rasters here; each tile sees a copy of exactly the
/// rectangle it asked for, without the planes it did not name.
class PixelRun {
 public:
  PixelRun(NodeType type, std::string_view params, NodeInputs inputs,
           Precision precision = Precision::single);

  const Frame& frame(std::size_t output = 0) const { return *prepared_.frames[output]; }
  /// The whole window by one call of tile().
  Raster whole(std::size_t output = 0) const;
  /// The window as the union of rectangles, each by its own call; what they do not cover stays zero.
  Raster pieced(std::span<const Rect> rects, std::size_t output = 0) const;

 private:
  void fill(Rect rect, std::vector<Raster>& outputs) const;
  std::vector<Raster> outputs() const;

  NodeType type_;
  NodeInputs inputs_;
  std::shared_ptr<void> params_;
  PreparedNode prepared_;
  std::vector<std::shared_ptr<const Frame>> frames_;  // of tiled inputs
  std::vector<std::shared_ptr<std::vector<bool>>> planes_read_;
};

/// "" where both hold the same bytes, or the first plane, sample and pixel that differ.
std::string first_difference(const Raster& a, const Raster& b);

/// Compares the whole against tiles of 1x1, 7x5 and 16x16 px, and against random rectangles in random order.
/// "" where all have the same bytes.
std::string break_of_tile_law(const PixelRun& run, std::uint32_t seed = 1);

/// Runs `body` once for each SIMD target that this processor has, with that target alone enabled.
void for_each_simd_target(const std::function<void(const char* name)>& body);

}  // namespace frustum::test
